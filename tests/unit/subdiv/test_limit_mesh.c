#include "tests/unit/subdiv/surfaces.h"

#include "gd/discretization.h"
#include "gd/limit_mesh.h"
#include "gd/limit_place.h"

static struct gd_limit_mesh *fine_of(const struct gd_subdivision *surface, uint32_t level)
{
    struct gd_limit_mesh *fine = NULL;
    struct gd_detail detail = {0};
    check_ok(gd_limit_mesh_build(surface, &(struct gd_limit_mesh_options){.level = level}, NULL,
                                 &fine, &detail),
             &detail);
    return fine;
}

/* Checks that vertices and normals are those of the discretization, bit for bit, and that vertices
 * convert to parameters and back. */
static void check_vertices(const struct gd_subdivision *surface, const struct gd_limit_mesh *fine)
{
    struct gd_discretization made;
    const struct gd_mesh *mesh = gd_limit_mesh_mesh(fine);
    const struct gd_discretize_options options = {.level = gd_limit_mesh_level(fine)};
    check_ok(gd_discretize(surface, &options, NULL, &made, NULL), NULL);
    assert_int_equal(made.polygons.position_count, gd_mesh_summary(mesh)->index_count);
    for (uint32_t i = 0; i < made.polygons.position_count; i++) {
        struct gd_point point, back;
        struct gd_vec3 normal = gd_limit_mesh_normals(fine)[i];
        check_near(normal, made.normals[i].x, made.normals[i].y, made.normals[i].z, 0);
        check_ok(gd_limit_mesh_point(fine, &made.places[i], &point, NULL), NULL);
        check_ok(gd_point_at_vertex(mesh, (struct gd_vertex){i}, &back, NULL), NULL);
        assert_true(gd_point_equal(&point, &back));
        struct gd_limit_point place = gd_limit_mesh_place(fine, &back);
        struct gd_limit_jet jet = jet_at(surface, place.face, place.corner, place.u, place.v);
        const double *position = made.polygons.positions[i];
        check_near(jet.position, position[0], position[1], position[2], 1e-13);
    }
    gd_discretization_free(&made);
}

/* Converts random parameters to points of the mesh and back, including points on lines between
 * cells. */
static void check_places(const struct gd_limit_mesh *fine, uint32_t faces, uint32_t corners,
                         bool triangles)
{
    struct rng rng = {5};
    for (int n = 0; n < 2000; n++) {
        struct gd_limit_point place = {rng_below(&rng, faces), rng_below(&rng, corners),
                                       rng_between(&rng, 0, 1), rng_between(&rng, 0, 1)};
        if (n % 3 == 0) place.u = rng_below(&rng, 9) / 8.0;
        if (n % 4 == 0) place.v = rng_below(&rng, 17) / 16.0;
        if (triangles && place.u + place.v > 1) place.u = 1 - place.u, place.v = 1 - place.v;
        struct gd_point point, again;
        check_ok(gd_limit_mesh_point(fine, &place, &point, NULL), NULL);
        struct gd_limit_point back = gd_limit_mesh_place(fine, &point);
        if (point.kind == GD_POINT_FACE) {
            assert_int_equal(back.face, place.face);
            assert_int_equal(back.corner, place.corner);
            assert_true(fabs(back.u - place.u) < 1e-13 && fabs(back.v - place.v) < 1e-13);
        }
        check_ok(gd_limit_mesh_point(fine, &back, &again, NULL), NULL);
        struct gd_vec3 a = gd_point_position(gd_limit_mesh_mesh(fine), &point);
        check_near(gd_point_position(gd_limit_mesh_mesh(fine), &again), a.x, a.y, a.z, 1e-13);
    }
}

static void check(const char *text, enum gd_scheme scheme, uint32_t faces, uint32_t corners)
{
    struct gd_subdivision *surface = surface_from(text, scheme);
    for (uint32_t level = gd_limit_mesh_least_level(surface); level <= 4; level++) {
        struct gd_limit_mesh *fine = fine_of(surface, level);
        assert_true(gd_limit_mesh_memsize(fine) <= gd_limit_mesh_cost(surface, level));
        check_vertices(surface, fine);
        check_places(fine, faces, corners, scheme == GD_SCHEME_LOOP);
        gd_limit_mesh_free(fine);
    }
    gd_subdivision_release(surface);
}

/* An asymmetric mesh uses both diagonals of quads. */
static void quads(void **state)
{
    (void)state;
    check(SKEW_CUBE, GD_SCHEME_CATMULL_CLARK, 6, 1);
    check("v 0 0 0\nv 2 0 .3\nv 2 1 0\nv 0 1 .5\nf 1 2 3 4\n", GD_SCHEME_CATMULL_CLARK, 1, 1);
}

static void polygons(void **state)
{
    (void)state;
    check("v 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 0\nf 1 2 3\nf 1 3 4\nf 2 1 4\nf 3 2 4\n",
          GD_SCHEME_CATMULL_CLARK, 4, 3);
}

static void triangles(void **state)
{
    (void)state;
    check(OCTAHEDRON, GD_SCHEME_LOOP, 8, 1);
}

/* In a mesh that also has triangles, a quad is one piece with four parts. */
static void mixed(void **state)
{
    (void)state;
    struct gd_subdivision *surface =
        surface_from("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 .5 .2\nf 1 2 3 4\nf 2 5 3\n",
                     GD_SCHEME_CATMULL_CLARK);
    struct gd_limit_mesh *fine = fine_of(surface, 3);
    check_vertices(surface, fine);
    check_places(fine, 1, 1, false);
    struct gd_point point;
    struct gd_detail detail = {0};
    const struct gd_limit_point outside = {1, 3, 0.5, 0.5};
    assert_int_equal(gd_limit_mesh_point(fine, &outside, &point, &detail), GD_OUT_OF_RANGE);
    gd_limit_mesh_free(fine);
    assert_int_equal(gd_limit_mesh_build(surface, &(struct gd_limit_mesh_options){.level = 0}, NULL,
                                         &fine, &detail),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(
        gd_limit_mesh_build(surface, &(struct gd_limit_mesh_options){4, 100}, NULL, &fine, &detail),
        GD_TOO_LARGE);
    assert_int_equal(gd_limit_mesh_build(surface, &(struct gd_limit_mesh_options){.level = 4},
                                         &(struct gd_control){.budget_bytes = 10000}, &fine,
                                         &detail),
                     GD_BUDGET);
    assert_int_equal(gd_limit_mesh_least_level(surface), 1);
    gd_subdivision_release(surface);
}

static void levels(void **state)
{
    (void)state;
    struct gd_subdivision *surface = surface_from(CUBE, GD_SCHEME_CATMULL_CLARK);
    assert_int_equal(gd_limit_mesh_least_level(surface), 0);
    assert_int_equal(gd_limit_mesh_usual_level(surface), 6);
    size_t cost = gd_limit_mesh_cost(surface, 5);
    struct gd_limit_mesh *fine;
    check_ok(gd_limit_mesh_build(surface, &(struct gd_limit_mesh_options){.level = 5},
                                 &(struct gd_control){.budget_bytes = cost}, &fine, NULL),
             NULL);
    gd_limit_mesh_free(fine);
    gd_subdivision_release(surface);
}

/* Angles are counter-clockwise from du. Directions and angles convert into each other. */
static void directions(void **state)
{
    (void)state;
    struct gd_subdivision *surface = surface_from(SKEW_CUBE, GD_SCHEME_CATMULL_CLARK);
    const double places[3][2] = {{0.3, 0.6}, {0, 0}, {1, 0.5}};
    for (int n = 0; n < 3; n++) {
        struct gd_limit_jet jet = jet_at(surface, 2, 0, places[n][0], places[n][1]);
        assert_true(gd_limit_angle(&jet, jet.du) < 1e-15);
        assert_true(gd_limit_angle(&jet, jet.dv) > 0 && gd_limit_angle(&jet, jet.dv) < M_PI);
        for (double angle = 0.1; angle < 6.2; angle += 0.7) {
            struct gd_vec3 direction = gd_limit_direction(&jet, angle);
            check_close(gd_vec3_length(direction), 1, 1e-14);
            check_close(gd_limit_angle(&jet, gd_vec3_along(direction, 0.5, jet.normal)), angle,
                        1e-13);
        }
    }
    struct gd_limit_point beside = {1, 0, 1 + 1e-12, -1e-12};
    check_ok(gd_limit_place_check(surface, &beside, NULL), NULL);
    assert_true(beside.u == 1 && beside.v == 0);
    beside.u = 1.1;
    assert_int_equal(gd_limit_place_check(surface, &beside, NULL), GD_INVALID_ARGUMENT);
    gd_subdivision_release(surface);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(quads),     cmocka_unit_test(polygons),
                                       cmocka_unit_test(triangles), cmocka_unit_test(mixed),
                                       cmocka_unit_test(levels),    cmocka_unit_test(directions)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
