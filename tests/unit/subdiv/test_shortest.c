#include "tests/unit/subdiv/surfaces.h"

#include "gd/limit_shortest.h"
#include "gd/locate.h"
#include "gd/query.h"

static struct gd_limit_mesh *fine_of(const struct gd_subdivision *surface, uint32_t level)
{
    struct gd_limit_mesh *fine = NULL;
    struct gd_detail detail = {0};
    check_ok(gd_limit_mesh_build(surface, &(struct gd_limit_mesh_options){.level = level}, NULL,
                                 &fine, &detail),
             &detail);
    return fine;
}

static struct gd_limit_shortest find(const struct gd_limit_mesh *fine, struct gd_limit_point from,
                                     struct gd_limit_point to)
{
    struct gd_limit_shortest shortest = {0};
    struct gd_detail detail = {0};
    check_ok(
        gd_limit_shortest_find(fine, (struct gd_limit_point[]){from, to}, NULL, &shortest, &detail),
        &detail);
    return shortest;
}

/* In a flat sheet of regular cells distances are Euclidean. */
static void plane(void **state)
{
    (void)state;
    struct gd_control_mesh sheet;
    make_sheet(4, false, &sheet);
    for (uint32_t i = 0; i < sheet.polygons.position_count; i++) {
        double *p = sheet.polygons.positions[i];
        p[0] = i / 5, p[1] = i % 5, p[2] = 0;
    }
    struct gd_subdivision *surface = surface_of(&sheet, GD_SCHEME_CATMULL_CLARK);
    gd_control_mesh_free(&sheet);
    struct gd_limit_mesh *fine = fine_of(surface, 3);
    struct gd_limit_shortest shortest = find(fine, (struct gd_limit_point){5, 0, 0.25, 0.5},
                                             (struct gd_limit_point){10, 0, 0.5, 0.125});
    check_close(shortest.distance, hypot(1.25, 0.625), 1e-12);
    check_close(shortest.mesh_distance, shortest.distance, 1e-12);
    assert_true(shortest.relaxed);
    gd_limit_shortest_free(&shortest);
    gd_limit_mesh_free(fine);
    gd_subdivision_release(surface);
}

/* Tests a quarter of the closed geodesic in the mirror plane y = 0 of the smoothed cube. It leads
 * from the middle of the top to the middle of the side x = 1. Its length is a quarter of the length
 * in test_limit_trace.c. */
static void quarter_of_a_closed_geodesic(void **state)
{
    (void)state;
    struct gd_subdivision *surface = surface_from(CUBE, GD_SCHEME_CATMULL_CLARK);
    double before = 1;
    for (uint32_t level = 2; level <= 5; level++) {
        struct gd_limit_mesh *fine = fine_of(surface, level);
        struct gd_limit_shortest shortest = find(fine, (struct gd_limit_point){0, 0, 0.5, 0.5},
                                                 (struct gd_limit_point){5, 0, 0.5, 0.5});
        check_close(shortest.distance, 5.344803240448 / 4, 1e-11);
        assert_true(shortest.relaxed && shortest.error_estimate < 1e-10);
        check_close(shortest.steps[0].position.z, 68.0 / 81, 1e-12);
        check_close(shortest.steps[shortest.step_count - 1].position.x, 68.0 / 81, 1e-10);
        double off = fabs(shortest.mesh_distance - shortest.distance);
        assert_true(off < 0.3 * before); /* the error converges with second order */
        before = off;
        gd_limit_shortest_free(&shortest);
        gd_limit_mesh_free(fine);
    }
    gd_subdivision_release(surface);
}

/* The triangle inequality holds, and both directions have the same length. */
static void laws(void **state)
{
    (void)state;
    struct gd_subdivision *surface = surface_from(SKEW_CUBE, GD_SCHEME_CATMULL_CLARK);
    struct gd_limit_mesh *fine = fine_of(surface, 5);
    struct rng rng = {3};
    uint32_t relaxed = 0;
    for (int n = 0; n < 40; n += TEST_STRIDE) {
        struct gd_limit_point place[3];
        double distance[3], error = 0;
        for (int i = 0; i < 3; i++)
            place[i] = (struct gd_limit_point){rng_below(&rng, 6), 0, rng_between(&rng, 0, 1),
                                               rng_between(&rng, 0, 1)};
        for (int i = 0; i < 3; i++) {
            struct gd_limit_shortest there = find(fine, place[i], place[(i + 1) % 3]);
            struct gd_limit_shortest back = find(fine, place[(i + 1) % 3], place[i]);
            distance[i] = there.distance;
            error += there.error_estimate;
            relaxed += there.relaxed;
            assert_true(fabs(there.distance - back.distance) <=
                        there.error_estimate + back.error_estimate + 1e-11);
            check_close(there.distance, there.mesh_distance, 2e-3);
            gd_limit_shortest_free(&there);
            gd_limit_shortest_free(&back);
        }
        for (int i = 0; i < 3; i++)
            assert_true(distance[i] <= distance[(i + 1) % 3] + distance[(i + 2) % 3] + error);
    }
    /* the other paths end at conjugate points or pass a vertex of valence 3 */
    assert_true(relaxed * TEST_STRIDE > 110);
    gd_limit_mesh_free(fine);
    gd_subdivision_release(surface);
}

/* Around a corner the path follows the boundary. Its length converges with the level, and the
 * estimate bounds the error. */
static void around_a_corner(void **state)
{
    (void)state;
    struct gd_subdivision *corner =
        surface_from("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nv 0 2 0\nv 1 2 0\n"
                     "f 1 2 5 4\nf 2 3 6 5\nf 4 5 8 7\n",
                     GD_SCHEME_CATMULL_CLARK);
    struct gd_limit_shortest by_level[3];
    for (int i = 0; i < 3; i++) {
        struct gd_limit_mesh *fine = fine_of(corner, 2 + 3 * (uint32_t)i);
        by_level[i] = find(fine, (struct gd_limit_point){1, 0, 0.9, 0.9},
                           (struct gd_limit_point){2, 0, 0.9, 0.9});
        gd_limit_mesh_free(fine);
        assert_false(by_level[i].relaxed);
    }
    for (int i = 0; i < 2; i++) {
        assert_true(fabs(by_level[i].distance - by_level[2].distance) <=
                    by_level[i].error_estimate);
        assert_true(by_level[i + 1].error_estimate < by_level[i].error_estimate / 16);
    }
    for (int i = 0; i < 3; i++) gd_limit_shortest_free(&by_level[i]);
    gd_subdivision_release(corner);
}

/* A cube whose edges are all sharp stays a cube. A path across its edges is as long as on the mesh,
 * whether it is relaxed or not. */
static void sharp_cube(void **state)
{
    (void)state;
    struct gd_subdivision *cube =
        surface_from(CUBE "t crease 5/1/0 0 1 3 2 0 10\nt crease 5/1/0 4 5 7 6 4 10\n"
                          "t crease 2/1/0 0 4 10\nt crease 2/1/0 1 5 10\n"
                          "t crease 2/1/0 2 6 10\nt crease 2/1/0 3 7 10\n",
                     GD_SCHEME_CATMULL_CLARK);
    struct gd_limit_mesh *fine = fine_of(cube, 3);
    struct rng rng = {9};
    for (int i = 0; i < 60; i++) {
        struct gd_limit_point place[2];
        for (int k = 0; k < 2; k++)
            place[k] = (struct gd_limit_point){rng_below(&rng, 6), 0, rng_unit(&rng) * (i % 3 > 0),
                                               rng_unit(&rng) * (i % 2)};
        struct gd_limit_shortest shortest = find(fine, place[0], place[1]);
        assert_true(fabs(shortest.distance - shortest.mesh_distance) <= 1e-11);
        gd_limit_shortest_free(&shortest);
    }
    gd_limit_mesh_free(fine);
    gd_subdivision_release(cube);
}

/* A prism whose edges are all sharp stays a prism, so its distances are known exactly. The cells of
 * its triangles are not parallelograms: at most levels the path on the mesh has displaced ends. The
 * estimate bounds the error. */
static void sharp_prism(void **state)
{
    (void)state;
    double positions[6][3] = {{0, 0, 0}, {1, 0, 0}, {0.3, 0.9, 0},
                              {0, 0, 1}, {1, 0, 1}, {0.3, 0.9, 1}};
    uint32_t corners[24] = {2, 1, 0, 3, 4, 5, 0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4, 2, 0, 3, 2, 3, 5};
    struct gd_mesh *mesh = test_mesh(&(struct gd_polygons){
        .positions = positions, .position_count = 6, .polygon_count = 8, .corners = corners});
    struct gd_subdivision *prism =
        surface_from("v 0 0 0\nv 1 0 0\nv 0.3 0.9 0\nv 0 0 1\nv 1 0 1\nv 0.3 0.9 1\n"
                     "f 3 2 1\nf 4 5 6\nf 1 2 5 4\nf 2 3 6 5\nf 3 1 4 6\n"
                     "t crease 4/1/0 0 1 2 0 10\nt crease 4/1/0 3 4 5 3 10\n"
                     "t crease 2/1/0 0 3 10\nt crease 2/1/0 1 4 10\nt crease 2/1/0 2 5 10\n",
                     GD_SCHEME_CATMULL_CLARK);
    struct gd_limit_mesh *fine = fine_of(prism, 3);
    struct rng rng = {17};
    uint32_t projected = 0;
    for (int i = 0; i < 100; i++) {
        struct gd_limit_point place[2];
        struct gd_point point[2];
        for (int k = 0; k < 2; k++) {
            struct gd_limit_jet jet;
            place[k] = (struct gd_limit_point){(uint32_t)k, rng_below(&rng, 3), rng_unit(&rng),
                                               rng_unit(&rng)};
            check_ok(gd_limit_evaluate(prism, &place[k], &jet, NULL), NULL);
            check_ok(gd_locate_nearest(mesh, jet.position, -1, &point[k], NULL), NULL);
        }
        struct gd_pair_answer exact = {0};
        check_ok(gd_pair_solve(mesh, &(struct gd_pair_request){.from = &point[0], .to = &point[1]},
                               NULL, &exact, NULL),
                 NULL);
        struct gd_limit_shortest found = find(fine, place[0], place[1]);
        assert_true(found.distance >= exact.distance - found.error_estimate - 1e-12);
        /* a geodesic may be another one than the shortest */
        if (!found.relaxed)
            assert_true(found.distance <= exact.distance + found.error_estimate + 1e-12);
        projected += !found.relaxed;
        gd_limit_shortest_free(&found);
    }
    assert_true(projected > 10);
    gd_limit_mesh_free(fine);
    gd_subdivision_release(prism);
    gd_mesh_release(mesh);
}

static void edge_cases(void **state)
{
    (void)state;
    struct gd_subdivision *surface =
        surface_from("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 6 1 0\nv 5 1 0\n"
                     "f 1 2 3 4\nf 5 6 7 8\n",
                     GD_SCHEME_CATMULL_CLARK);
    struct gd_limit_mesh *fine = fine_of(surface, 3);
    const struct gd_limit_point here = {0, 0, 0.3, 0.4}, there = {1, 0, 0.5, 0.5},
                                nowhere = {2, 0, 0, 0};
    struct gd_limit_shortest shortest = find(fine, here, there);
    assert_true(isinf(shortest.distance) && shortest.step_count == 0);
    gd_limit_shortest_free(&shortest);
    shortest = find(fine, here, here);
    assert_true(shortest.distance == 0 && shortest.step_count >= 1);
    gd_limit_shortest_free(&shortest);
    shortest = find(fine, here, (struct gd_limit_point){0, 0, 0.3, 0.4 + 1e-13});
    assert_true(shortest.distance < 1e-12);
    gd_limit_shortest_free(&shortest);
    assert_int_equal(gd_limit_shortest_find(fine, (struct gd_limit_point[]){here, nowhere}, NULL,
                                            &shortest, NULL),
                     GD_OUT_OF_RANGE);
    assert_int_equal(gd_limit_shortest_find(fine, (struct gd_limit_point[]){here, here},
                                            &(struct gd_control){.deadline_ns = 1}, &shortest,
                                            NULL),
                     GD_DEADLINE);
    gd_limit_mesh_free(fine);
    gd_subdivision_release(surface);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plane),      cmocka_unit_test(quarter_of_a_closed_geodesic),
        cmocka_unit_test(laws),       cmocka_unit_test(around_a_corner),
        cmocka_unit_test(sharp_cube), cmocka_unit_test(sharp_prism),
        cmocka_unit_test(edge_cases)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
