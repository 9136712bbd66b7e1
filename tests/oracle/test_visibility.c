#include "tests/oracle/visibility.h"

#include <math.h>
#include <stdlib.h>

#include "tests/oracle/unfold.h"
#include "tests/samples/samples.h"
#include "tests/support/test.h"

static double distance(const struct visibility_scene *scene, double x0, double y0, double x1,
                       double y1)
{
    struct visibility *visibility = visibility_create(scene, (double[2]){x0, y0});
    assert_non_null(visibility);
    double answer = visibility_distance(visibility, (double[2]){x1, y1});
    visibility_free(visibility);
    return answer;
}

static void test_no_obstacle(void **state)
{
    (void)state;
    struct visibility_scene scene = {NULL, (uint32_t[1]){0}, 0};
    check_close(distance(&scene, 0, 0, 3, 4), 5, 1e-15);
}

static void test_square(void **state)
{
    (void)state;
    const double square[4][2] = {{1, 1}, {3, 1}, {3, 3}, {1, 3}};
    struct visibility_scene scene = {square, (uint32_t[2]){0, 4}, 1};
    /* the path leads around two corners */
    check_close(distance(&scene, 0, 2, 4, 2), 2 * sqrt(2) + 2, 1e-15);
    /* the path is straight and passes through a corner */
    check_close(distance(&scene, 2, 0, 4, 2), 2 * sqrt(2), 1e-15);
    /* the path connects opposite corners */
    check_close(distance(&scene, 1, 1, 3, 3), 4, 1e-15);
    check_close(distance(&scene, 0, 1, 4, 1), 4, 1e-15);     /* along a side */
    check_close(distance(&scene, 2, 1, 2, 3), 4, 1e-15);     /* from wall to wall */
    check_close(distance(&scene, 1.5, 1, 2.5, 1), 1, 1e-15); /* along one wall */
}

static void test_concave(void **state)
{
    (void)state;
    /* a cup that opens upwards */
    const double cup[8][2] = {{0, 0}, {4, 0}, {4, 4}, {3, 4}, {3, 1}, {1, 1}, {1, 4}, {0, 4}};
    struct visibility_scene scene = {cup, (uint32_t[2]){0, 8}, 1};
    check_close(distance(&scene, 2, 1, 2, 3), 2, 1e-15);
    check_close(distance(&scene, 1, 4, 3, 4), 2, 1e-15);
    check_close(distance(&scene, 2, 1, 5, 1), sqrt(10) + 1 + sqrt(10), 1e-15);
}

/* Solves the same scenes as surfaces by unfolding. The two solvers share no data. The visibility
 * graph gets only the polygons in the plane. The solver by unfolding gets only the surface with its
 * prisms. */
static void test_against_unfolding(void **state)
{
    (void)state;
    double worst = 0;
    for (uint64_t seed = 1; seed <= 12; seed++) {
        struct sample_obstacles scene;
        assert_int_equal(sample_obstacles(1 + seed % 4, 0, seed, &scene), GD_OK);
        const struct gd_polygons *mesh = &scene.mesh;
        struct visibility_scene plan = {(const double(*)[2])scene.corners, scene.first,
                                        scene.count};
        struct visibility *visibility = visibility_create(&plan, mesh->positions[scene.p]);
        struct unfold_mesh *unfold =
            unfold_create((const double(*)[3])mesh->positions, mesh->position_count, mesh->corners,
                          mesh->polygon_count, 0);
        long double *unfolded = calloc(mesh->position_count, sizeof *unfolded);
        assert_true(visibility && unfold && unfolded);
        unfold_distances(unfold, scene.p, unfolded);
        for (uint32_t v = 0; v < mesh->position_count; v++) {
            if (v == scene.p || mesh->positions[v][2] != 0) continue;
            double planar = visibility_distance(visibility, mesh->positions[v]);
            worst = fmax(worst, check_close((double)unfolded[v], planar, 1e-12));
        }
        free(unfolded);
        unfold_free(unfold);
        visibility_free(visibility);
        sample_obstacles_free(&scene);
    }
    print_message("# obstacles, plan against surface: worst error %.2g\n", worst);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_obstacle),
        cmocka_unit_test(test_square),
        cmocka_unit_test(test_concave),
        cmocka_unit_test(test_against_unfolding),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
