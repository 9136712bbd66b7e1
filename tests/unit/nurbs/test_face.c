/* Repeats the second experiment of W.-H. Chen's paper (face.h). Compares the shortest path between
 * two holes of a face with a solution of the geodesic equation. */
#include "tests/unit/nurbs/face.h"

#include "gd/geodesic_like.h"
#include "tests/support/test.h"
#include "tests/unit/nurbs/shooting.h"

static const double promise = 1e-10; /* permitted relative error of a length (1e-8 %) */
static const double right = 1e-8;    /* permitted error of a right angle at an end */

struct scene {
    struct gd_parametric *surface;
    struct gd_tessellation *tessellation;
    struct gd_domain_curve *eyes[2];
};

static struct scene open_scene(void)
{
    struct scene scene;
    struct gd_detail detail = {0};
    check_ok(face_create(&scene.surface, &detail), &detail);
    check_ok(gd_tessellation_build(scene.surface, NULL, NULL, &scene.tessellation, &detail),
             &detail);
    for (int k = 0; k < 2; k++) check_ok(face_eye(scene.surface, k, &scene.eyes[k]), NULL);
    return scene;
}

static void close_scene(struct scene *scene)
{
    for (int k = 0; k < 2; k++) gd_domain_curve_release(scene->eyes[k]);
    gd_tessellation_release(scene->tessellation);
    gd_parametric_release(scene->surface);
}

static struct gd_geodesics solve(const struct scene *scene,
                                 const struct gd_geodesic_options *options)
{
    struct gd_geodesics found;
    struct gd_detail detail = {0};
    check_ok(gd_geodesic_solve(scene->tessellation,
                               &(struct gd_geodesic_request){.from = scene->eyes[0],
                                                             .to = scene->eyes[1],
                                                             .options = options},
                               NULL, &found, &detail),
             &detail);
    return found;
}

/* Returns the length of the geodesic that shooting finds. The initial values are the values of the
 * path, changed by `off`. */
static double shot_length(const struct scene *scene, const struct gd_geodesic *path, double off)
{
    double places[257][2];
    check_ok(gd_geodesic_sample(scene->surface, path, 257, places, NULL), NULL);
    struct shot shot = {path->from_parameter + off, path->to_parameter - off,
                        path->length * (1 + off), 0};
    shot.side = shooting_side(scene->eyes[0], path->from_parameter, places[1]);
    assert_true(shoot_between(scene->eyes[0], scene->eyes[1], &shot));
    return shot.length;
}

static void the_path_equals_the_shot_geodesic(void **state)
{
    (void)state;
    struct scene scene = open_scene();
    struct gd_geodesics found = solve(&scene, NULL);
    const struct gd_geodesic *path = &found.items[0];
    assert_true(path->is_minimum && !path->warnings);
    assert_true(fabs(path->from_angle - M_PI_2) <= right && fabs(path->to_angle - M_PI_2) <= right);
    check_close(path->length, shot_length(&scene, path, 0), promise);
    check_close(path->length, shot_length(&scene, path, 1e-3), promise);
    gd_geodesics_free(&found);
    close_scene(&scene);
}

/* A single spline is longer than the geodesic. The more control points it has, the smaller the
 * difference is. A spline of few points is returned without a warning about convergence. */
static void the_papers_table(void **state)
{
    (void)state;
    static const uint32_t counts[] = {3,  4,  5,  6,  7,  8,  9,  10, 11,
                                      12, 13, 14, 15, 16, 17, 20, 30, 60};
    /* largest errors with 20, 30 and 60 points */
    static const double most[2][3] = {{1e-4, 1e-5, 1e-6}, {1e-4, 2e-6, 2e-8}};
    struct scene scene = open_scene();
    struct gd_geodesics found = solve(&scene, NULL);
    double exact = shot_length(&scene, &found.items[0], 0);
    gd_geodesics_free(&found);
    for (uint32_t degree = 2; degree <= 3; degree++) {
        for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
            uint32_t points = counts[i];
            if (points <= degree) continue;
            found = solve(
                &scene, &(struct gd_geodesic_options){.degree = degree, .control_points = points});
            double error = found.items[0].length / exact - 1;
            assert_int_equal(found.items[0].pieces[0].count, points);
            assert_true(error > -promise && error < 0.1 &&
                        !(found.items[0].warnings & GD_GEODESIC_NOT_CONVERGED));
            if (points >= 20)
                assert_true(error < most[degree - 2][i - (sizeof counts / sizeof *counts - 3)]);
            gd_geodesics_free(&found);
        }
    }
    close_scene(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_path_equals_the_shot_geodesic),
        cmocka_unit_test(the_papers_table),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
