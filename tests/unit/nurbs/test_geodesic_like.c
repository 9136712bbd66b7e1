/* Compares shortest paths on surfaces with closed forms, with lengths by Clairaut's relation and by
 * shooting, and with laws. */
#include "gd/query.h"
#include "tests/unit/nurbs/scene.h"

#include "tests/unit/nurbs/shooting.h"

static const double right = 1e-8; /* permitted error of a right angle at an end */

/* Checks the laws of every result, frees it, and returns the length of the shortest path. */
static double length_of(struct gd_geodesics *found)
{
    const struct gd_geodesic *best = &found->items[0];
    assert_true(best->is_minimum);
    assert_int_equal(best->warnings & (GD_GEODESIC_NOT_CONVERGED | GD_GEODESIC_NOT_MINIMAL), 0);
    if (!(best->warnings & (GD_GEODESIC_CURVE_CORNER | GD_GEODESIC_BOUNDARY_CONTACT))) {
        assert_true(fabs(best->from_angle - M_PI_2) <= right);
        assert_true(fabs(best->to_angle - M_PI_2) <= right);
    }
    double length = best->length;
    gd_geodesics_free(found);
    return length;
}

static double between(const struct scene *scene, double u0, double v0, double u1, double v1)
{
    struct gd_geodesics found =
        solve(scene, point_at(scene->surface, u0, v0), point_at(scene->surface, u1, v1), NULL);
    return length_of(&found);
}

static void torus_lengths_by_clairauts_relation(void **state)
{
    (void)state;
    struct scene smooth = open_scene(torus(2, 1)), rational = open_scene(nurbs_torus(2, 1, 1, 0));
    const double places[2][5] = {{0, 0, M_PI_2, M_PI_2, 4.0618928974654},
                                 {0.3, 2.0, 2.1, 4.0, 2.8552575338283}};
    for (int i = 0; i < 2; i++) {
        const double *p = places[i];
        check_close(between(&smooth, p[0], p[1], p[2], p[3]), p[4], promise);
        check_close(between(&rational, circle_parameter(p[0]), circle_parameter(p[1]),
                            circle_parameter(p[2]), circle_parameter(p[3])),
                    p[4], promise);
        check_close(between(&smooth, p[2], p[3], p[0], p[1]), p[4], promise);
    }
    close_scene(&smooth);
    close_scene(&rational);
}

/* Relative lengths do not depend on the surface's scale and position. */
static void scale_and_place_do_not_matter(void **state)
{
    (void)state;
    const double scales[] = {1e-6, 1e6, 1}, shifts[] = {0, 0, 1e6};
    for (int i = 0; i < 3; i++) {
        struct scene scene = open_scene(nurbs_torus(2, 1, scales[i], shifts[i]));
        double length = between(&scene, circle_parameter(0.3), circle_parameter(2.0),
                                circle_parameter(2.1), circle_parameter(4.0));
        check_close(length, scales[i] * 2.8552575338283, promise);
        close_scene(&scene);
    }
}

/* A square of this size in the plane, whose lines of parameters are perspective: the weights of two
 * opposite sides differ by a factor of 20. The domain is a square, too. */
static enum gd_status perspective_square(double size, double width, struct gd_parametric **out,
                                         struct gd_detail *detail)
{
    const double points[4][3] = {{0, 0, 0}, {0, size, 0}, {size, 0, 0}, {size, size, 0}},
                 knots[4] = {0, 0, width, width}, weights[4] = {1, 20, 20, 400};
    return gd_nurbs_create(&(struct gd_nurbs_data){.degree_u = 1,
                                                   .degree_v = 1,
                                                   .count_u = 2,
                                                   .count_v = 2,
                                                   .knots_u = knots,
                                                   .knots_v = knots,
                                                   .knot_count_u = 4,
                                                   .knot_count_v = 4,
                                                   .points = points,
                                                   .weights = weights},
                           out, detail);
}

/* Sizes and domains are computed with or rejected, but never give a wrong length. Returns true if
 * they are computed with. */
static bool extent_is_exact(double size, double width)
{
    struct gd_detail detail = {0};
    struct gd_parametric *surface = NULL;
    enum gd_status status = perspective_square(size, width, &surface, &detail);
    if (status) {
        assert_int_equal(status, GD_INVALID_ARGUMENT);
        assert_non_null(strstr(detail.text, "must be 1e-60 to 1e+60"));
        return false;
    }
    struct scene scene = open_scene(surface);
    /* places of the points (0.1, 0.9) and (0.9, 0.2) of the unit square */
    const double p = 0.1 / (20 - 19 * 0.1), q = 0.9 / (20 - 19 * 0.9), r = 0.2 / (20 - 19 * 0.2);
    double length = between(&scene, p * width, q * width, q * width, r * width);
    check_close(length / size, hypot(0.8, 0.7), promise);
    close_scene(&scene);
    return true;
}

static void extreme_extents_are_exact_or_rejected(void **state)
{
    (void)state;
    const double good[] = {1e-59, 1e-29, 1, 1e29, 1e59}, bad[] = {1e-70, 1e-66, 1e66, 1e70};
    for (int i = 0; i < 5; i++) {
        assert_true(extent_is_exact(good[i], 1));
        assert_true(extent_is_exact(1, good[i]));
        assert_true(extent_is_exact(good[i], good[i]));
        assert_int_equal(extent_is_exact(good[i], 1 / good[i]), i > 0 && i < 4);
    }
    for (int i = 0; i < 4; i++) {
        assert_false(extent_is_exact(bad[i], 1));
        assert_false(extent_is_exact(1, bad[i]));
        assert_false(extent_is_exact(bad[i], bad[i]));
    }
}

static void the_bilinear_diagonal(void **state)
{
    (void)state;
    struct scene scene = open_scene(bilinear());
    check_close(between(&scene, 0, 0, 1, 1), 1.797852788781883, 1e-13);
    close_scene(&scene);
}

static double great_circle(double u0, double v0, double u1, double v1)
{
    return acos(sin(v0) * sin(v1) + cos(v0) * cos(v1) * cos(u1 - u0));
}

static double latitude_parameter(double v)
{
    return 2 * circle_parameter(v + M_PI_2);
}

static void sphere_away_from_its_poles_and_through_one(void **state)
{
    (void)state;
    struct scene scene = open_scene(nurbs_sphere());
    const double places[][4] = {
        {0.2, -0.3, 1.7, 0.4}, {0.2, 0.9, 2.9, 1.0},   {0.1, 1.2, 0.1 + M_PI, 1.0},
        {1, -1.3, 4, -1.2},    {6.2, 0.1, 0.3, -0.2},  {0.5, 1.1, 0.5 + M_PI - 1e-3, 1.2},
        {0.4, 0.2, 0.4, 1.4},  {0.3, -M_PI_2, 2, 0.3}, {1, -M_PI_2, 1, M_PI_2 - 0.5}};
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        const double *p = places[i];
        double length = between(&scene, circle_parameter(p[0]), latitude_parameter(p[1]),
                                circle_parameter(p[2]), latitude_parameter(p[3]));
        check_close(length, great_circle(p[0], p[1], p[2], p[3]), promise);
    }
    close_scene(&scene);
}

static void cylinder_and_cone_unrolled(void **state)
{
    (void)state;
    struct scene cylinder = open_scene(nurbs_ruled(1, 0, 1, 3)),
                 cone = open_scene(nurbs_ruled(2, 0, 0.5, 3));
    struct rng rng = {7};
    for (int i = 0; i < 12; i++) {
        double a = rng_between(&rng, 0, 2 * M_PI), b = rng_between(&rng, 0, 2 * M_PI),
               s = rng_unit(&rng), t = rng_unit(&rng),
               turn = fabs(a - b) > M_PI ? 2 * M_PI - fabs(a - b) : fabs(a - b);
        check_close(between(&cylinder, circle_parameter(a), s, circle_parameter(b), t),
                    hypot(turn, 3 * (s - t)), promise);
        /* the unrolled cone has the slant sqrt(1.5^2 + 3^2) from radius 2 to 0.5 */
        double slant = hypot(1.5, 3), sine = 1.5 / slant, p = (2 - 1.5 * s) / sine,
               q = (2 - 1.5 * t) / sine;
        double angle = turn * sine, least = 0.5 / sine;
        double flat = sqrt(p * p + q * q - 2 * p * q * cos(angle));
        /* the straight line would leave the cone at its upper edge */
        if (p * q * sin(angle) < least * flat) continue;
        check_close(between(&cone, circle_parameter(a), s, circle_parameter(b), t), flat, promise);
    }
    close_scene(&cylinder);
    close_scene(&cone);
}

/* The two paths around a cylinder differ by less than the mesh's error. The solver must try
 * both. */
/* The parameter u of this cylinder is 25 times as fast at the beginning of its circle as at the
 * end. A path begins close to the seam and crosses it. Its length is exact up to the estimate. */
static void errors_at_a_seam_with_two_speeds_are_estimated(void **state)
{
    (void)state;
    const double fast = 0.2;
    double points[18][3], weights[18], knots_u[12];
    static const double knots_v[4] = {0, 0, 1, 1};
    for (int i = 0; i < 12; i++)
        knots_u[i] = fast * circle_knots[i] / (1 + (fast - 1) * circle_knots[i]);
    for (int i = 0; i < 18; i++) {
        points[i][0] = circle_x[i / 2];
        points[i][1] = circle_y[i / 2];
        points[i][2] = i % 2;
        weights[i] = circle_weight(i / 2);
        for (int k = 1; k <= 2; k++) weights[i] /= 1 + (fast - 1) * circle_knots[i / 2 + k];
    }
    struct scene scene =
        open_scene(surface_of(&(struct gd_nurbs_data){.degree_u = 2,
                                                      .degree_v = 1,
                                                      .count_u = 9,
                                                      .count_v = 2,
                                                      .knots_u = knots_u,
                                                      .knots_v = knots_v,
                                                      .knot_count_u = 12,
                                                      .knot_count_v = 4,
                                                      .points = (const double(*)[3])points,
                                                      .weights = weights}));
    for (int i = 0; i < 6; i++) {
        double from[2] = {pow(10, -6 - i), 0.3}, to[2] = {0.95, 0.6};
        struct gd_jet a, b;
        check_ok(gd_parametric_evaluate(scene.surface, from[0], from[1], &a), NULL);
        check_ok(gd_parametric_evaluate(scene.surface, to[0], to[1], &b), NULL);
        double turn = atan2(a.x.y, a.x.x) - atan2(b.x.y, b.x.x), expected = hypot(turn, 0.3);
        struct gd_geodesics found = solve(&scene, point_at(scene.surface, from[0], from[1]),
                                          point_at(scene.surface, to[0], to[1]), NULL);
        assert_true(fabs(found.items[0].length - expected) <=
                    found.items[0].error + 1e-13 * expected);
        gd_geodesics_free(&found);
    }
    close_scene(&scene);
}

static void nearly_opposite_points(void **state)
{
    (void)state;
    struct scene cylinder = open_scene(nurbs_ruled(1, 0, 1, 3));
    struct rng rng = {9};
    for (int i = 0; i < 10; i++) {
        double a = rng_between(&rng, 0, M_PI - 0.1), b = a + M_PI + (i % 2 ? 1e-6 : -1e-6),
               t = rng_unit(&rng);
        struct gd_geodesics found =
            solve(&cylinder, point_at(cylinder.surface, circle_parameter(a), 0.5),
                  point_at(cylinder.surface, circle_parameter(b), t),
                  &(struct gd_geodesic_options){.all_minima = true});
        assert_true(found.count >= 2);
        check_close(found.items[0].length, hypot(M_PI - 1e-6, 3 * (t - 0.5)), promise);
        check_close(found.items[1].length, hypot(M_PI + 1e-6, 3 * (t - 0.5)), promise);
        gd_geodesics_free(&found);
        check_close(between(&cylinder, circle_parameter(a), 0.5, circle_parameter(b), t),
                    hypot(M_PI - 1e-6, 3 * (t - 0.5)), promise);
    }
    close_scene(&cylinder);
}

/* The end of the path is close to a knot line. The coarse path may end on either side of this
 * line. */
static void path_ends_near_a_knot_line(void **state)
{
    (void)state;
    struct scene scene = open_scene(nurbs_torus(2, 1, 1, 0));
    for (double off = 1e-2; off > 1e-10; off /= 10) {
        for (int side = -1; side <= 1; side += 2) {
            double u = circle_parameter(M_PI_2 + side * off), v = circle_parameter(M_PI - 1.5);
            struct gd_geodesics found = solve(&scene, point_at(scene.surface, u, v),
                                              iso_at(scene.surface, GD_ISO_V, 0.5), NULL);
            assert_true(fabs(found.items[0].to_parameter - u) < 1e-9);
            check_close(length_of(&found), 1.5, promise);
        }
    }
    close_scene(&scene);
}

/* A straight line in the domain is given in two ways: by two points, and by two hundred collinear
 * corners. The paths are equal. */
static void collinear_corners_do_not_matter(void **state)
{
    (void)state;
    enum { CORNERS = 200 };
    struct scene scene = open_scene(nurbs_bumps(6, 6, 1.2, 8));
    double corners[CORNERS + 1][2];
    for (int i = 0; i <= CORNERS; i++) {
        corners[i][0] = 0.05 + 0.9 * i / CORNERS;
        corners[i][1] = 0.9 - 0.1 * i / CORNERS;
    }
    const double ends[2][2] = {{0.05, 0.9}, {0.95, 0.8}};
    for (int i = 1; i < 8; i += TEST_STRIDE) {
        struct gd_domain_curve *plain = polyline_of(scene.surface, ends, 2),
                               *broken = polyline_of(scene.surface, (const double(*)[2])corners,
                                                     CORNERS + 1);
        struct gd_geodesics one =
            solve(&scene, point_at(scene.surface, 0.12 * i, 0.1), plain, NULL);
        struct gd_geodesics other =
            solve(&scene, point_at(scene.surface, 0.12 * i, 0.1), broken, NULL);
        assert_true(fabs(one.items[0].to_parameter * CORNERS - other.items[0].to_parameter) < 1e-4);
        check_close(length_of(&one), length_of(&other), promise);
    }
    close_scene(&scene);
}

/* The straight line would cross the cone's upper edge. The path is a tangent, an arc and a
 * tangent. */
static void a_path_can_follow_the_border(void **state)
{
    (void)state;
    struct scene cone = open_scene(nurbs_ruled(2, 0, 1.5, 0.1));
    double slant = hypot(0.5, 0.1), sine = 0.5 / slant, inner = 1.5 / sine, outer = 2 / sine,
           turn = 2.5;
    double arc = turn * sine - 2 * acos(inner / outer);
    double expected = 2 * sqrt(outer * outer - inner * inner) + inner * arc;
    struct gd_geodesics found = solve(&cone, point_at(cone.surface, circle_parameter(0.1), 0),
                                      point_at(cone.surface, circle_parameter(2.6), 0), NULL);
    assert_true(found.items[0].warnings & GD_GEODESIC_BOUNDARY_CONTACT);
    check_close(found.items[0].length, expected, 1e-7);
    gd_geodesics_free(&found);
    close_scene(&cone);
}

static void meridians_of_a_torus(void **state)
{
    (void)state;
    struct scene scenes[2] = {open_scene(torus(2, 1)), open_scene(nurbs_torus(2, 1, 1, 0))};
    const double meridian[2] = {M_PI_2, 0.25}, inner[2] = {M_PI, 0.5};
    for (int i = 0; i < 2; i++) {
        struct gd_geodesics found = solve(&scenes[i], iso_at(scenes[i].surface, GD_ISO_U, 0),
                                          iso_at(scenes[i].surface, GD_ISO_U, meridian[i]),
                                          &(struct gd_geodesic_options){.all_minima = true});
        /* the longer path along the inner equator is a minimum, too; a path along the outer equator
         * is not */
        assert_int_equal(found.count, 2);
        for (uint32_t k = 0; k < 2; k++) {
            assert_true(found.items[k].is_minimum);
            assert_true(fabs(found.items[k].from_parameter - inner[i]) < 1e-6);
            check_close(found.items[k].length, k ? 3 * M_PI_2 : M_PI_2, promise);
        }
        gd_geodesics_free(&found);
        close_scene(&scenes[i]);
    }
}

/* From a point inside a circle, the nearest and the farthest point of the circle are both
 * critical. */
static void the_farthest_point_of_a_circle_is_never_returned(void **state)
{
    (void)state;
    struct scene scene = open_scene(plane(3));
    struct rng rng = {3};
    for (int i = 0; i < 20; i++) {
        double angle = rng_between(&rng, 0, 2 * M_PI), off = rng_between(&rng, 0.05, 2);
        double u = off * cos(angle), v = off * sin(angle);
        struct gd_domain_curve *circle = loop_at(scene.surface, 0, 0, 1, 1);
        double low, high, nearest = INFINITY, at[2];
        gd_domain_curve_range(circle, &low, &high);
        for (int k = 0; k < 100000; k++) {
            gd_domain_curve_at(circle, low + (high - low) * k / 100000, at);
            nearest = fmin(nearest, hypot(at[0] - u, at[1] - v));
        }
        struct gd_geodesics found = solve(&scene, point_at(scene.surface, u, v), circle, NULL);
        double length = length_of(&found);
        assert_true(length <= nearest + 1e-12 && length >= nearest - 1e-8);
    }
    close_scene(&scene);
}

static void circles_of_latitude(void **state)
{
    (void)state;
    struct scene scene = open_scene(nurbs_sphere());
    struct gd_geodesics found =
        solve(&scene, iso_at(scene.surface, GD_ISO_V, latitude_parameter(-0.4)),
              iso_at(scene.surface, GD_ISO_V, latitude_parameter(0.9)), NULL);
    check_close(length_of(&found), 1.3, promise);
    found = solve(&scene, point_at(scene.surface, 0.1, latitude_parameter(-1.2)),
                  iso_at(scene.surface, GD_ISO_V, latitude_parameter(0.9)), NULL);
    check_close(length_of(&found), 2.1, promise);
    close_scene(&scene);
}

static void curves_that_meet_have_the_distance_0(void **state)
{
    (void)state;
    struct scene scene = open_scene(nurbs_torus(2, 1, 1, 0));
    struct gd_geodesics found = solve(&scene, iso_at(scene.surface, GD_ISO_U, 0.3),
                                      iso_at(scene.surface, GD_ISO_V, 0.7), NULL);
    assert_true(found.items[0].length == 0 && found.items[0].piece_count == 0);
    assert_true(fabs(found.items[0].meeting[0] - 0.3) < 1e-12 &&
                fabs(found.items[0].from_parameter - 0.7) < 1e-12);
    gd_geodesics_free(&found);
    /* the path crosses the seam; another path starts at a point on the curve */
    found =
        solve(&scene, point_at(scene.surface, 1, 0.4), iso_at(scene.surface, GD_ISO_U, 0), NULL);
    assert_true(found.items[0].length == 0);
    gd_geodesics_free(&found);
    found = solve(&scene, loop_at(scene.surface, 0.3, 0.3, 0.1, 0.1),
                  loop_at(scene.surface, 0.4, 0.3, 0.1, 0.1), NULL);
    assert_true(found.items[0].length == 0);
    gd_geodesics_free(&found);
    close_scene(&scene);
}

/* At a corner of the curve the path does not need a right angle. */
static void a_path_can_end_at_a_corner_of_a_polyline(void **state)
{
    (void)state;
    struct scene scene = open_scene(plane(3));
    const double corners[3][2] = {{2, -1}, {1, 0}, {2, 1}};
    struct gd_domain_curve *bent = polyline_of(scene.surface, corners, 3);
    struct gd_geodesics found = solve(&scene, point_at(scene.surface, -1, 0.125), bent, NULL);
    assert_true(found.items[0].warnings & GD_GEODESIC_CURVE_CORNER);
    check_close(found.items[0].to_parameter, 1, 1e-12);
    check_close(found.items[0].length, hypot(2, 0.125), 1e-12);
    gd_geodesics_free(&found);
    close_scene(&scene);
}

static void exchanging_the_ends_changes_nothing(void **state)
{
    (void)state;
    struct scene scene = open_scene(nurbs_bumps(8, 6, 0.8, 5));
    for (int i = 0; i < 2; i++) {
        struct gd_geodesics found[2];
        for (int side = 0; side < 2; side++) {
            struct gd_domain_curve *a = loop_at(scene.surface, 0.25, 0.3, 0.12, 0.15);
            struct gd_domain_curve *b =
                i ? point_at(scene.surface, 0.8, 0.7) : loop_at(scene.surface, 0.75, 0.7, 0.1, 0.2);
            found[side] = side ? solve(&scene, b, a, NULL) : solve(&scene, a, b, NULL);
        }
        assert_true(fabs(found[0].items[0].from_parameter - found[1].items[0].to_parameter) < 1e-6);
        double there = length_of(&found[0]), back = length_of(&found[1]);
        check_close(there, back, promise);
    }
    close_scene(&scene);
}

/* Tests the curves of W.-H. Chen's paper (face.h), which are quadratic and cubic splines of n
 * control points. Their errors fall about as h^4 and h^6, where h is the spacing of the control
 * points. */
static void the_papers_curves_converge(void **state)
{
    (void)state;
    struct scene scene = open_scene(torus(2, 1));
    const double exact = 4.0618928974654;
    double before[2] = {1, 1};
    for (uint32_t n = 8; n <= 64; n *= 2) {
        for (uint32_t degree = 2; degree <= 3; degree++) {
            struct gd_geodesics found = solve(
                &scene, point_at(scene.surface, 0, 0), point_at(scene.surface, M_PI_2, M_PI_2),
                &(struct gd_geodesic_options){.degree = degree, .control_points = n});
            assert_int_equal(found.items[0].pieces[0].count, n);
            double error = (found.items[0].length - exact) / exact;
            assert_true(error > -1e-13 &&
                        error < before[degree - 2] / (degree == 2 ? 8 : 20) + 1e-12);
            before[degree - 2] = error;
            gd_geodesics_free(&found);
        }
    }
    close_scene(&scene);
}

/* If the shortest path ends in a corner of the other curve, the error of the paper's curves also
 * falls with their order. The expected length is that of the geodesic to the corner, which shooting
 * computes. */
static void the_papers_curves_converge_at_a_corner(void **state)
{
    (void)state;
    struct scene scene = open_scene(torus(3, 1.1));
    const double from[2] = {0.5, 0.5}, corners[3][2] = {{2.5, 0.2}, {2, 0.6}, {2.4, 1.2}};
    double angle = shooting_angle(scene.surface, from, corners[1]), exact = 5.5;
    assert_true(shoot_at(scene.surface, from, corners[1], &angle, &exact));
    for (uint32_t degree = 2; degree <= 3; degree++) {
        double before = 1;
        for (uint32_t n = 10; n <= 160; n *= 2) {
            struct gd_domain_curve *bent = polyline_of(scene.surface, corners, 3);
            struct gd_geodesics found =
                solve(&scene, point_at(scene.surface, from[0], from[1]), bent,
                      &(struct gd_geodesic_options){.degree = degree, .control_points = n});
            const struct gd_geodesic *path = &found.items[0];
            assert_int_equal(path->warnings, GD_GEODESIC_CURVE_CORNER);
            assert_true(path->is_minimum && path->iterations > 0);
            check_close(path->to_parameter, 1, 1e-12);
            double error = (path->length - exact) / exact;
            assert_true(error > -1e-13 && error < before / (degree == 2 ? 8 : 20) + 1e-12);
            before = error;
            gd_geodesics_free(&found);
        }
    }
    close_scene(&scene);
}

static void invalid_requests_are_refused(void **state)
{
    (void)state;
    struct scene scene = open_scene(plane(1)), other = open_scene(plane(1));
    struct gd_domain_curve *a = point_at(scene.surface, 0, 0), *b = point_at(scene.surface, 1, 1),
                           *c = point_at(other.surface, 1, 1);
    const struct gd_geodesic_options wrong[] = {
        {.degree = 1}, {.degree = 6}, {.control_points = 3}, {.tolerance = -1}, {.tolerance = NAN}};
    struct gd_geodesics found;
    struct gd_detail detail;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        assert_int_equal(gd_geodesic_solve(scene.tessellation,
                                           &(struct gd_geodesic_request){
                                               .from = a, .to = b, .options = &wrong[i]},
                                           NULL, &found, &detail),
                         GD_INVALID_ARGUMENT);
    assert_int_equal(gd_geodesic_solve(scene.tessellation,
                                       &(struct gd_geodesic_request){.from = a, .to = c}, NULL,
                                       &found, &detail),
                     GD_INVALID_ARGUMENT);
    struct gd_control late = {.deadline_ns = 1}, poor = {.budget_bytes = 1000};
    assert_int_equal(gd_geodesic_solve(scene.tessellation,
                                       &(struct gd_geodesic_request){.from = a, .to = b}, &late,
                                       &found, &detail),
                     GD_DEADLINE);
    assert_int_equal(gd_geodesic_solve(scene.tessellation,
                                       &(struct gd_geodesic_request){.from = a, .to = b}, &poor,
                                       &found, &detail),
                     GD_BUDGET);
    gd_domain_curve_release(a);
    gd_domain_curve_release(b);
    gd_domain_curve_release(c);
    close_scene(&scene);
    close_scene(&other);
}

/* Creates a sheet over the unit square with creases at u = 1/2 and v = 1/2. In each quarter it is
 * bilinear. */
static struct gd_parametric *creased_sheet(const double heights[3][3])
{
    static const double knots[5] = {0, 0, 0.5, 1, 1};
    double points[9][3];
    for (int i = 0; i < 9; i++)
        memcpy(points[i], (double[3]){i / 3 / 2.0, i % 3 / 2.0, heights[i / 3][i % 3]},
               sizeof *points);
    return surface_of(&(struct gd_nurbs_data){.degree_u = 1,
                                              .degree_v = 1,
                                              .count_u = 3,
                                              .count_v = 3,
                                              .knots_u = knots,
                                              .knots_v = knots,
                                              .knot_count_u = 5,
                                              .knot_count_v = 5,
                                              .points = (const double(*)[3])points});
}

/* Returns the exact distance on a fine tessellation. */
static double distance_on_mesh(const struct gd_parametric *surface, const double from[2],
                               const double to[2])
{
    struct gd_tessellation *fine;
    struct gd_point ends[2];
    struct gd_pair_answer pair = {0};
    check_ok(gd_tessellation_build(surface, &(struct gd_tessellation_options){.faces = 20000}, NULL,
                                   &fine, NULL),
             NULL);
    check_ok(gd_tessellation_point(fine, from[0], from[1], &ends[0], NULL), NULL);
    check_ok(gd_tessellation_point(fine, to[0], to[1], &ends[1], NULL), NULL);
    check_ok(gd_pair_solve(gd_tessellation_mesh(fine),
                           &(struct gd_pair_request){.from = &ends[0], .to = &ends[1]}, NULL, &pair,
                           NULL),
             NULL);
    double distance = pair.distance;
    gd_pair_answer_free(&pair);
    gd_tessellation_release(fine);
    return distance;
}

/* The curve that passes the corner of two creases on one side shrinks into the corner. The shortest
 * path passes on the other side. */
static void a_path_passes_the_right_side_of_a_corner_of_creases(void **state)
{
    (void)state;
    static const double heights[3][3] = {{0.3, 0.8, 0.3}, {0.8, 0.3, 0.2}, {-0.5, -0.3, 0.4}};
    const double from[2] = {0.083, 0.445}, to[2] = {0.948, 0.569};
    struct scene scene = open_scene(creased_sheet(heights));
    struct gd_geodesics found = solve(&scene, point_at(scene.surface, from[0], from[1]),
                                      point_at(scene.surface, to[0], to[1]), NULL);
    assert_int_equal(found.items[0].warnings, 0);
    assert_true(found.items[0].is_minimum);
    check_close(found.items[0].length, distance_on_mesh(scene.surface, from, to), 2e-5);
    gd_geodesics_free(&found);
    close_scene(&scene);
}

/* The quarters of this sheet are flat. The shortest path goes through the corner, where it bends.
 * No geodesic of the quarters reaches it, but the result is a curve on the surface, and its error
 * is true. */
static void a_path_through_a_corner_of_creases_has_a_true_error(void **state)
{
    (void)state;
    static const double heights[3][3] = {
        {0, -0.11, 0.27}, {0.49, 0.38, 0.76}, {-0.38, -0.49, -0.11}};
    const double from[2] = {0.12, 0.445}, to[2] = {0.715, 0.544};
    struct scene scene = open_scene(creased_sheet(heights));
    struct gd_geodesics found = solve(&scene, point_at(scene.surface, from[0], from[1]),
                                      point_at(scene.surface, to[0], to[1]), NULL);
    const struct gd_geodesic *path = &found.items[0];
    double exact = distance_on_mesh(scene.surface, from, to);
    assert_true(path->warnings & GD_GEODESIC_NOT_CONVERGED);
    assert_true(path->length >= exact && path->length < 1.001 * exact);
    assert_true(path->error >= path->length - exact && path->error < path->length);
    gd_geodesics_free(&found);
    close_scene(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(torus_lengths_by_clairauts_relation),
        cmocka_unit_test(scale_and_place_do_not_matter),
        cmocka_unit_test(extreme_extents_are_exact_or_rejected),
        cmocka_unit_test(the_bilinear_diagonal),
        cmocka_unit_test(sphere_away_from_its_poles_and_through_one),
        cmocka_unit_test(cylinder_and_cone_unrolled),
        cmocka_unit_test(errors_at_a_seam_with_two_speeds_are_estimated),
        cmocka_unit_test(nearly_opposite_points),
        cmocka_unit_test(path_ends_near_a_knot_line),
        cmocka_unit_test(a_path_passes_the_right_side_of_a_corner_of_creases),
        cmocka_unit_test(a_path_through_a_corner_of_creases_has_a_true_error),
        cmocka_unit_test(collinear_corners_do_not_matter),
        cmocka_unit_test(a_path_can_follow_the_border),
        cmocka_unit_test(meridians_of_a_torus),
        cmocka_unit_test(the_farthest_point_of_a_circle_is_never_returned),
        cmocka_unit_test(circles_of_latitude),
        cmocka_unit_test(curves_that_meet_have_the_distance_0),
        cmocka_unit_test(a_path_can_end_at_a_corner_of_a_polyline),
        cmocka_unit_test(exchanging_the_ends_changes_nothing),
        cmocka_unit_test(the_papers_curves_converge),
        cmocka_unit_test(the_papers_curves_converge_at_a_corner),
        cmocka_unit_test(invalid_requests_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
