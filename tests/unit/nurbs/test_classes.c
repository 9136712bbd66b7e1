/* Tests paths of a given class: by winding numbers, along an initial curve, trimmed at curves that
 * they cross, and in families of equally long paths. */
#include "tests/unit/nurbs/scene.h"

#include "tests/unit/nurbs/shooting.h"

static struct gd_geodesics solve_request(const struct scene *scene,
                                         const struct gd_geodesic_request *request)
{
    struct gd_geodesics found;
    struct gd_detail detail = {0};
    check_ok(gd_geodesic_solve(scene->tessellation, request, NULL, &found, &detail), &detail);
    return found;
}

/* Compares a path between two points with the geodesic that leaves in the same direction, which
 * shooting computes. In the domain, path and geodesic must end at the second point, shifted by one
 * period for each turn of the path. */
static void check_by_shooting(const struct gd_parametric *surface, const struct gd_geodesic *path,
                              const double to[2])
{
    const struct gd_geodesic_piece *first = &path->pieces[0];
    double target[2], length = path->length,
                      angle = shooting_angle(surface, first->points[0], first->points[1]);
    for (int k = 0; k < 2; k++)
        target[k] = first->points[0][k] - (k ? 0.3 : 0.0) + to[k] + 2 * M_PI * path->turns[k];
    const struct gd_geodesic_piece *last = &path->pieces[path->piece_count - 1];
    for (int k = 0; k < 2; k++)
        assert_true(fabs(last->points[last->count - 1][k] - target[k]) < 1e-9);
    assert_true(shoot_at(surface, first->points[0], target, &angle, &length));
    check_close(path->length, length, promise);
}

/* Each homotopy class of a closed surface has a shortest path (Hilbert, Cartan). */
static void each_class_of_a_torus_has_a_minimum(void **state)
{
    (void)state;
    struct scene scene = open_scene(torus(3, 1.1));
    const double from[2] = {0, 0.3}, to[2] = {1, 0.5};
    struct gd_domain_curve *a = point_at(scene.surface, from[0], from[1]),
                           *b = point_at(scene.surface, to[0], to[1]);
    struct gd_geodesic_options options = {.all_minima = true, .turn_limit = 1};
    struct gd_geodesics found = solve_request(
        &scene, &(struct gd_geodesic_request){.from = a, .to = b, .options = &options});
    double least[3][3];
    for (int m = 0; m < 3; m++)
        for (int n = 0; n < 3; n++) least[m][n] = INFINITY;
    for (uint32_t i = 0; i < found.count; i++) {
        const struct gd_geodesic *path = &found.items[i];
        assert_true(path->is_minimum);
        assert_true(i == 0 || path->length >= found.items[i - 1].length);
        check_by_shooting(scene.surface, path, to);
        if (abs(path->turns[0]) > 1 || abs(path->turns[1]) > 1) continue;
        double *best = &least[path->turns[0] + 1][path->turns[1] + 1];
        *best = fmin(*best, path->length);
    }
    for (int32_t m = -1; m <= 1; m++) {
        for (int32_t n = -1; n <= 1; n++) {
            const int32_t turns[2] = {m, n};
            assert_true(isfinite(least[m + 1][n + 1]));
            struct gd_geodesics one = solve_request(
                &scene, &(struct gd_geodesic_request){.from = a, .to = b, .turns = turns});
            assert_int_equal(one.count, 1);
            assert_true(one.items[0].turns[0] == m && one.items[0].turns[1] == n);
            check_close(one.items[0].length, least[m + 1][n + 1], promise);
            gd_geodesics_free(&one);
        }
    }
    gd_geodesics_free(&found);
    gd_domain_curve_release(a);
    gd_domain_curve_release(b);
    close_scene(&scene);
}

/* On a cylinder the paths of all classes are straight lines of the unrolled plane. */
static void turns_and_initial_curves_on_a_cylinder(void **state)
{
    (void)state;
    struct scene scene = open_scene(nurbs_ruled(1, 0, 1, 3));
    const double places[2][4] = {{0.1, 0.2, 0.35, 0.7}, {0.6, 0.5, 0.6, 0.5}};
    for (int i = 0; i < 2; i++) {
        const double *p = places[i];
        struct gd_domain_curve *a = point_at(scene.surface, p[0], p[1]),
                               *b = point_at(scene.surface, p[2], p[3]);
        /* circle_parameter is not linear, but p[0] and p[2] are read back from the surface */
        struct gd_jet jets[2];
        for (int k = 0; k < 2; k++)
            check_ok(gd_parametric_evaluate(scene.surface, p[2 * k], p[2 * k + 1], &jets[k]), NULL);
        double around = atan2(jets[1].x.y, jets[1].x.x) - atan2(jets[0].x.y, jets[0].x.x),
               up = jets[1].x.z - jets[0].x.z;
        for (int32_t m = -3; m <= 3; m++) {
            if (m == 0 && i) continue;
            const int32_t turns[2] = {m, 0};
            const double corners[3][2] = {
                {p[0], p[1]}, {0.5 * (p[0] + p[2] + m), 0.9}, {p[2] + m, p[3]}};
            struct gd_domain_curve *initial = polyline_of(scene.surface, corners, 3);
            struct gd_geodesics found[2] = {
                solve_request(&scene,
                              &(struct gd_geodesic_request){.from = a, .to = b, .turns = turns}),
                solve_request(
                    &scene, &(struct gd_geodesic_request){.from = a, .to = b, .initial = initial})};
            for (int k = 0; k < 2; k++) {
                assert_true(found[k].items[0].is_minimum);
                assert_int_equal(found[k].items[0].turns[0], m);
                check_close(found[k].items[0].length, hypot(around + 2 * M_PI * m, up), promise);
                gd_geodesics_free(&found[k]);
            }
            gd_domain_curve_release(initial);
        }
        gd_domain_curve_release(a);
        gd_domain_curve_release(b);
    }
    close_scene(&scene);
}

/* A path to the far side of a closed curve crosses the near side of the curve, and is trimmed at
 * the crossing. */
static void paths_that_cross_a_curve_are_trimmed(void **state)
{
    (void)state;
    struct scene scene = open_scene(plane(6));
    const double square[5][2] = {{0, -1}, {2, -1}, {2, 3}, {0, 3}, {0, -1}},
                 far_side[3][2] = {{5, 1}, {3, 1.5}, {0, 1.25}};
    struct gd_geodesics found =
        solve(&scene, point_at(scene.surface, 5, 1), polyline_of(scene.surface, square, 5),
              &(struct gd_geodesic_options){.all_minima = true});
    assert_int_equal(found.count, 1);
    check_close(found.items[0].length, 3, 1e-12);
    gd_geodesics_free(&found);
    struct gd_domain_curve *a = point_at(scene.surface, 5, 1),
                           *b = polyline_of(scene.surface, square, 5),
                           *initial = polyline_of(scene.surface, far_side, 3);
    found = solve_request(&scene,
                          &(struct gd_geodesic_request){.from = a, .to = b, .initial = initial});
    check_close(found.items[0].length, 3, 1e-12);
    gd_geodesics_free(&found);
    gd_domain_curve_release(a);
    gd_domain_curve_release(b);
    gd_domain_curve_release(initial);
    close_scene(&scene);
}

/* Between the sides of two squares around one centre there are four families of paths. */
static void each_family_of_paths_is_listed_once(void **state)
{
    (void)state;
    struct scene scene = open_scene(plane(3));
    const double inner[5][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {-1, -1}},
                 outer[5][2] = {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}, {-2, -2}},
                 low[2][2] = {{-1, 0}, {1, 0}}, high[2][2] = {{-2, 1.5}, {1.5, 1.5}};
    const struct gd_geodesic_options options = {.all_minima = true};
    struct gd_geodesics found = solve(&scene, polyline_of(scene.surface, inner, 5),
                                      polyline_of(scene.surface, outer, 5), &options);
    assert_int_equal(found.count, 4);
    for (uint32_t i = 0; i < found.count; i++) {
        check_close(found.items[i].length, 1, 1e-12);
        assert_true(found.items[i].warnings & GD_GEODESIC_FAMILY);
    }
    gd_geodesics_free(&found);
    found = solve(&scene, polyline_of(scene.surface, low, 2), polyline_of(scene.surface, high, 2),
                  &options);
    assert_int_equal(found.count, 1);
    check_close(found.items[0].length, 1.5, 1e-12);
    assert_true(found.items[0].warnings & GD_GEODESIC_FAMILY);
    gd_geodesics_free(&found);
    close_scene(&scene);
}

static void expect_refused(const struct scene *scene, const struct gd_geodesic_request *request)
{
    struct gd_geodesics found;
    struct gd_detail detail;
    assert_int_equal(gd_geodesic_solve(scene->tessellation, request, NULL, &found, &detail),
                     GD_INVALID_ARGUMENT);
}

static void classes_that_do_not_exist_are_refused(void **state)
{
    (void)state;
    struct scene scene = open_scene(nurbs_ruled(1, 0, 1, 3));
    struct gd_domain_curve *a = point_at(scene.surface, 0.1, 0.2),
                           *b = point_at(scene.surface, 0.4, 0.2);
    const double elsewhere[2][2] = {{0.1, 0.2}, {0.6, 0.9}};
    struct gd_domain_curve *line = polyline_of(scene.surface, elsewhere, 2);
    const struct gd_geodesic_options all = {.all_minima = true}, many = {.turn_limit = 5};
    const int32_t up[2] = {0, 1}, often[2] = {17, 0}, once[2] = {1, 0};
    const struct gd_geodesic_request wrong[] = {
        {.from = a, .to = b, .turns = up},
        {.from = a, .to = b, .turns = often},
        {.from = a, .to = b, .turns = once, .options = &all},
        {.from = a, .to = b, .turns = once, .initial = line},
        {.from = a, .to = b, .initial = line},
        {.from = a, .to = b, .initial = a},
        {.from = a, .to = b, .options = &many}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) expect_refused(&scene, &wrong[i]);
    gd_domain_curve_release(a);
    gd_domain_curve_release(b);
    gd_domain_curve_release(line);
    close_scene(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_class_of_a_torus_has_a_minimum),
        cmocka_unit_test(turns_and_initial_curves_on_a_cylinder),
        cmocka_unit_test(paths_that_cross_a_curve_are_trimmed),
        cmocka_unit_test(each_family_of_paths_is_listed_once),
        cmocka_unit_test(classes_that_do_not_exist_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
