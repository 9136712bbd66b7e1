/* Tests of NURBS and other surfaces: values that other programs compute, derivatives compared with
 * differences, known curvatures, recognised and refused input, nearest points. */
#include "tests/unit/nurbs/surfaces.h"

#include <string.h>

static void check_vector(struct gd_vec3 actual, double x, double y, double z, double within)
{
    assert_true(gd_vec3_distance(actual, (struct gd_vec3){x, y, z}) <= within);
}

static struct gd_jet jet_at(const struct gd_parametric *surface, double u, double v)
{
    struct gd_jet jet;
    check_ok(gd_parametric_evaluate(surface, u, v, &jet), NULL);
    return jet;
}

/* The npm packages verb-nurbs and three compute these values. */
static void values_equal_those_of_other_programs(void **state)
{
    (void)state;
    struct gd_parametric *torus_ = nurbs_torus(2, 1, 1, 0), *sphere = nurbs_sphere();
    struct gd_jet jet = jet_at(torus_, 0.3, 0.7);
    check_vector(jet.x, -0.501298420681, 1.630882459688, -0.955863246107, 2e-12);
    check_vector(jet.u, -10.179771947727, -3.129044383289, 0, 2e-12);
    check_vector(jet.v, -1.752994636132, 5.703046500942, -1.833938738906, 2e-12);
    check_vector(jet.uv, -35.597729586211, -10.941981450229, 0, 2e-12);
    check_vector(jet_at(sphere, 0.3, 0.7).x, -0.239111804612, 0.777906396586, 0.581108581115,
                 2e-12);
    gd_parametric_release(torus_);
    gd_parametric_release(sphere);
}

static void check_differences(const struct gd_parametric *surface, double u, double v)
{
    const double h = 1e-6;
    struct gd_jet jet = jet_at(surface, u, v), right = jet_at(surface, u + h, v),
                  left = jet_at(surface, u - h, v), up = jet_at(surface, u, v + h),
                  down = jet_at(surface, u, v - h);
    double scale = gd_vec3_length(jet.u) + gd_vec3_length(jet.v) + gd_vec3_length(jet.uu) +
                   gd_vec3_length(jet.vv);
    const struct gd_vec3 pairs[5][3] = {{right.x, left.x, jet.u},
                                        {up.x, down.x, jet.v},
                                        {right.u, left.u, jet.uu},
                                        {up.u, down.u, jet.uv},
                                        {up.v, down.v, jet.vv}};
    for (int i = 0; i < 5; i++) {
        struct gd_vec3 slope = gd_vec3_scale(gd_vec3_sub(pairs[i][0], pairs[i][1]), 0.5 / h);
        assert_true(gd_vec3_distance(slope, pairs[i][2]) <= 1e-7 * scale);
    }
}

static void derivatives_agree_with_differences(void **state)
{
    (void)state;
    struct gd_parametric *surfaces[] = {nurbs_torus(2, 1, 1, 0),
                                        nurbs_sphere(),
                                        nurbs_bumps(8, 4, 1, 3),
                                        torus(2, 1),
                                        helicoid(),
                                        bilinear(),
                                        vase(),
                                        nurbs_ruled(2, 0, 0.5, 3)};
    struct rng rng = {2};
    for (size_t i = 0; i < sizeof surfaces / sizeof *surfaces; i++) {
        const struct gd_axis *u = gd_parametric_axis_u(surfaces[i]),
                             *v = gd_parametric_axis_v(surfaces[i]);
        for (int k = 0; k < 50; k++)
            check_differences(surfaces[i], rng_between(&rng, u->low + 1e-3, u->high - 1e-3),
                              rng_between(&rng, v->low + 1e-3, v->high - 1e-3));
        gd_parametric_release(surfaces[i]);
    }
}

static void known_curvatures(void **state)
{
    (void)state;
    struct gd_parametric *sphere = nurbs_sphere(), *smooth = torus(2, 1),
                         *cylinder = nurbs_ruled(2, 0, 2, 1), *screw = helicoid();
    struct rng rng = {5};
    for (int i = 0; i < 50; i++) {
        double u = rng_unit(&rng), v = rng_between(&rng, 0.05, 0.95);
        struct gd_jet jet = jet_at(sphere, u, v);
        struct gd_curvature c = gd_jet_curvature(&jet);
        check_close(c.gaussian, 1, 1e-11);
        check_close(fabs(c.mean), 1, 1e-11);
        check_close(gd_vec3_length(c.normal), 1, 1e-14);
        double angle = 2 * M_PI * v;
        jet = jet_at(smooth, 6 * u, angle);
        c = gd_jet_curvature(&jet);
        assert_true(fabs(c.gaussian - cos(angle) / (2 + cos(angle))) <= 1e-14);
        assert_true(fabs(c.mean + (2 + 2 * cos(angle)) / (2 * (2 + cos(angle)))) <= 1e-13);
        jet = jet_at(cylinder, u, v);
        c = gd_jet_curvature(&jet);
        assert_true(fabs(c.gaussian) <= 1e-12 && fabs(fabs(c.mean) - 0.25) <= 1e-12);
        jet = jet_at(screw, u, v);
        c = gd_jet_curvature(&jet);
        assert_true(fabs(c.mean) <= 1e-14);
        check_close(c.gaussian, -0.25 / pow(v * v + 0.25, 2), 1e-12);
    }
    struct gd_jet pole = jet_at(sphere, 0.3, 0);
    assert_false(gd_jet_curvature(&pole).regular);
    gd_parametric_release(sphere);
    gd_parametric_release(smooth);
    gd_parametric_release(cylinder);
    gd_parametric_release(screw);
}

/* Creates a unit sphere like nurbs_sphere. A projective map t -> a t / (1 + (a - 1) t) of both
 * parameters changes knots and weights, but not the shape. */
static struct gd_parametric *uneven_sphere(double a)
{
    static const double radius[5] = {0, 1, 1, 1, 0}, height[5] = {-1, -1, 0, 1, 1};
    double points[45][3], weights[45], u[12], v[8];
    for (int i = 0; i < 12; i++) u[i] = a * circle_knots[i] / (1 + (a - 1) * circle_knots[i]);
    for (int j = 0; j < 8; j++) v[j] = a * half_knots[j] / (1 + (a - 1) * half_knots[j]);
    for (int i = 0; i < 9; i++) {
        for (int j = 0; j < 5; j++) {
            double *p = points[5 * i + j], factor = 1;
            p[0] = radius[j] * circle_x[i], p[1] = radius[j] * circle_y[i], p[2] = height[j];
            for (int k = 1; k < 3; k++)
                factor *= (1 + (a - 1) * circle_knots[i + k]) * (1 + (a - 1) * half_knots[j + k]);
            weights[5 * i + j] = circle_weight(i) * circle_weight(j) / factor;
        }
    }
    return surface_of(&(struct gd_nurbs_data){.degree_u = 2,
                                              .degree_v = 2,
                                              .count_u = 9,
                                              .count_v = 5,
                                              .knots_u = u,
                                              .knots_v = v,
                                              .knot_count_u = 12,
                                              .knot_count_v = 8,
                                              .points = (const double(*)[3])points,
                                              .weights = weights});
}

/* With very uneven weights, rounding in the derivative along a pole is as large as the area that
 * GD_TOL_REGULAR allows. */
static void poles_have_no_normal(void **state)
{
    (void)state;
    struct rng rng = {3};
    for (double a = 1e-4; a < 2e4; a *= 10) {
        struct gd_parametric *sphere = uneven_sphere(a);
        const struct gd_axis *u = gd_parametric_axis_u(sphere), *v = gd_parametric_axis_v(sphere);
        for (int i = 0; i < 100; i++) {
            struct gd_jet jet =
                jet_at(sphere, rng_between(&rng, u->low, u->high), i % 2 ? v->low : v->high);
            assert_false(gd_jet_curvature(&jet).regular);
            check_vector(jet.x, 0, 0, i % 2 ? -1 : 1, 1e-14);
        }
        gd_parametric_release(sphere);
    }
}

static void closed_directions_and_poles_are_recognised(void **state)
{
    (void)state;
    struct gd_parametric *both = nurbs_torus(2, 1, 1e-6, 1), *sphere = nurbs_sphere(),
                         *open = nurbs_bumps(8, 4, 1, 3), *cone = nurbs_ruled(1, 0, 0, 1);
    assert_true(gd_parametric_axis_u(both)->closed && gd_parametric_axis_v(both)->closed);
    assert_int_equal(gd_parametric_axis_u(both)->line_count, 3);
    assert_true(gd_parametric_axis_u(sphere)->closed && !gd_parametric_axis_v(sphere)->closed);
    assert_true(gd_parametric_axis_v(sphere)->pole_low && gd_parametric_axis_v(sphere)->pole_high);
    assert_true(!gd_parametric_axis_u(open)->closed && !gd_parametric_axis_v(open)->pole_low);
    assert_true(!gd_parametric_axis_v(cone)->pole_low && gd_parametric_axis_v(cone)->pole_high);
    /* a closed direction wraps its parameters; other directions refuse parameters outside the
     * domain */
    struct gd_jet a = jet_at(both, 0.3, 0.7), b = jet_at(both, 1.3, -2.3), c;
    assert_true(gd_vec3_distance(a.x, b.x) <= 1e-15);
    assert_int_equal(gd_parametric_evaluate(open, 1.1, 0.5, &c), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_parametric_evaluate(open, 0.5, NAN, &c), GD_INVALID_ARGUMENT);
    gd_parametric_release(both);
    gd_parametric_release(sphere);
    gd_parametric_release(open);
    gd_parametric_release(cone);
}

/* The same quarter of a cylinder, given in each program's convention, is the same surface. */
static void conventions_are_one_surface(void **state)
{
    (void)state;
    const double knots[6] = {0, 0, 0, 1, 1, 1}, line[4] = {0, 0, 1, 1}, h = M_SQRT1_2;
    double plain[6][3] = {{1, 0, 0}, {1, 0, 1}, {1, 1, 0}, {1, 1, 1}, {0, 1, 0}, {0, 1, 1}},
           multiplied[6][3];
    const double weights[6] = {1, 1, h, h, 1, 1};
    for (int i = 0; i < 6; i++)
        for (int k = 0; k < 3; k++) multiplied[i][k] = plain[i][k] * weights[i];
    for (int convention = GD_NURBS_CANONICAL; convention <= GD_NURBS_RHINO; convention++) {
        bool is_short = convention == GD_NURBS_RHINO,
             times = is_short || convention == GD_NURBS_VERB;
        struct gd_nurbs_data data = {.convention = (enum gd_nurbs_convention)convention,
                                     .degree_u = 2,
                                     .degree_v = 1,
                                     .count_u = 3,
                                     .count_v = 2,
                                     .knots_u = knots + is_short,
                                     .knots_v = line + is_short,
                                     .knot_count_u = is_short ? 4 : 6,
                                     .knot_count_v = is_short ? 2 : 4,
                                     .points = (const double(*)[3])(times ? multiplied : plain),
                                     .weights = weights};
        struct gd_parametric *surface = surface_of(&data);
        struct gd_jet jet = jet_at(surface, 0.4, 0.25);
        check_close(hypot(jet.x.x, jet.x.y), 1, 1e-15);
        check_close(jet.x.z, 0.25, 1e-15);
        gd_parametric_release(surface);
    }
}

static void flaws_are_refused_with_an_error(void **state)
{
    (void)state;
    const double good[6] = {0, 0, 0, 1, 1, 1}, falling[6] = {0, 0, 1, 0, 1, 1},
                 nan_knot[6] = {0, 0, 0, NAN, 1, 1}, empty[6] = {0, 0, 1, 1, 2, 2},
                 torn[9] = {0, 0, 0, 1, 1, 1, 2, 2, 2};
    double points[18][3] = {{0}}, broken[9][3] = {{NAN}}, far[9][3] = {{1e80}},
           weights[9] = {1, 1, 1, 1, 0, 1, 1, 1, 1};
    for (int i = 0; i < 18; i++) points[i][0] = i / 3, points[i][1] = i % 3;
    const struct gd_nurbs_data sound = {.degree_u = 2,
                                        .degree_v = 2,
                                        .count_u = 3,
                                        .count_v = 3,
                                        .knots_u = good,
                                        .knots_v = good,
                                        .knot_count_u = 6,
                                        .knot_count_v = 6,
                                        .points = (const double(*)[3])points};
    struct gd_nurbs_data data[10];
    for (int i = 0; i < 10; i++) data[i] = sound;
    data[0].degree_u = 0;
    data[1].count_v = 2;
    data[2].knot_count_u = 5;
    data[3].knots_v = nan_knot;
    data[4].knots_u = falling;
    data[5].knots_u = torn, data[5].count_u = 6, data[5].knot_count_u = 9;
    data[6].knots_u = empty;
    data[7].weights = weights;
    data[8].points = (const double(*)[3])far;
    data[9].points = (const double(*)[3])broken;
    const char *names[10] = {"degree",           "control_count",     "knot_count",   "non_finite",
                             "decreasing_knots", "knot_multiplicity", "empty_domain", "weight",
                             "extent",           "non_finite"};
    assert_int_equal(gd_nurbs_inspect(&sound, NULL), GD_NURBS_FLAW_NONE);
    for (int i = 0; i < 10; i++) {
        struct gd_detail detail = {0};
        struct gd_parametric *surface = NULL;
        assert_string_equal(gd_nurbs_flaw_name(gd_nurbs_inspect(&data[i], &detail)), names[i]);
        assert_true(strlen(detail.text) > 20);
        assert_int_equal(gd_nurbs_create(&data[i], &surface, &detail), GD_INVALID_ARGUMENT);
        assert_null(surface);
    }
}

static void wrong_shapes_are_refused(void **state)
{
    (void)state;
    struct gd_parametric *surface = NULL;
    struct gd_detail detail;
    const double range[2] = {0, 1}, back[2] = {1, 0}, bad[1] = {INFINITY};
    assert_int_equal(gd_parametric_torus(1, 1, &surface, &detail), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_parametric_torus(1, NAN, &surface, &detail), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_parametric_helicoid(0, range, range, &surface, &detail),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(gd_parametric_helicoid(1, back, range, &surface, &detail),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(
        gd_parametric_graph(&(struct gd_graph){17, 0, bad, range, range}, &surface, &detail),
        GD_INVALID_ARGUMENT);
    assert_int_equal(
        gd_parametric_graph(&(struct gd_graph){0, 0, bad, range, range}, &surface, &detail),
        GD_INVALID_ARGUMENT);
    const double points[3][2] = {{1, 0}, {-1, 1}, {1, 2}}, knots[6] = {0, 0, 0, 1, 1, 1};
    struct gd_profile profile = {2, 3, knots, points, NULL};
    assert_int_equal(gd_parametric_revolution(&profile, &surface, &detail), GD_INVALID_ARGUMENT);
    assert_null(surface);
}

/* On a torus the nearest point is known. On a free-form surface no point of a dense grid is nearer
 * than the result. */
static void nearest_points_are_global(void **state)
{
    (void)state;
    struct gd_parametric *ring = nurbs_torus(2, 1, 1, 0), *free_form = nurbs_bumps(10, 8, 1.5, 9);
    struct rng rng = {4};
    for (int i = 0; i < 20; i++) {
        struct gd_vec3 x = {rng_between(&rng, -4, 4), rng_between(&rng, -4, 4),
                            rng_between(&rng, -2, 2)};
        struct gd_parametric_closest foot;
        check_ok(gd_parametric_nearest(ring, x, NULL, &foot, NULL), NULL);
        check_close(foot.distance, fabs(hypot(hypot(x.x, x.y) - 2, x.z) - 1), 1e-11);
        check_vector(jet_at(ring, foot.u, foot.v).x, foot.xyz.x, foot.xyz.y, foot.xyz.z, 1e-15);
        x = (struct gd_vec3){rng_between(&rng, -1, 10), rng_between(&rng, -1, 8),
                             rng_between(&rng, -3, 3)};
        check_ok(gd_parametric_nearest(free_form, x, NULL, &foot, NULL), NULL);
        for (int k = 0; k < 90000; k++)
            assert_true(gd_vec3_distance(jet_at(free_form, (k / 300) / 299.0, (k % 300) / 299.0).x,
                                         x) >= foot.distance - 1e-13);
    }
    struct gd_parametric_closest foot;
    assert_int_equal(gd_parametric_nearest(ring, (struct gd_vec3){NAN, 0, 0}, NULL, &foot, NULL),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(gd_parametric_nearest(ring, (struct gd_vec3){1e155, 0, 0}, NULL, &foot, NULL),
                     GD_INVALID_ARGUMENT);
    gd_parametric_release(ring);
    gd_parametric_release(free_form);
}

/* --- the control net -------------------------------------------------------------------------- */

/* The control points equal those of the data, up to rounding. This also holds for points with
 * weights and far from the origin. */
static void control_points_are_those_of_the_data(void **state)
{
    (void)state;
    const double points[4][3] = {{1e6, 0, 0}, {1e6, 1, 2}, {1e6 + 1, 0, 3}, {1e6 + 1, 1, 5}},
                 weights[4] = {1, 0.5, 2, 3}, knots[4] = {0, 0, 1, 1};
    struct gd_parametric *surface = surface_of(&(struct gd_nurbs_data){.degree_u = 1,
                                                                       .degree_v = 1,
                                                                       .count_u = 2,
                                                                       .count_v = 2,
                                                                       .knots_u = knots,
                                                                       .knots_v = knots,
                                                                       .knot_count_u = 4,
                                                                       .knot_count_v = 4,
                                                                       .points = points,
                                                                       .weights = weights});
    uint32_t counts[2];
    assert_true(gd_nurbs_counts(surface, counts));
    assert_true(counts[0] == 2 && counts[1] == 2);
    for (uint32_t i = 0; i < 4; i++)
        check_vector(gd_nurbs_control_point(surface, i / 2, i % 2), points[i][0], points[i][1],
                     points[i][2], 1e-9);
    gd_parametric_release(surface);
    surface = torus(2, 1);
    assert_false(gd_nurbs_counts(surface, counts));
    gd_parametric_release(surface);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_equal_those_of_other_programs),
        cmocka_unit_test(derivatives_agree_with_differences),
        cmocka_unit_test(known_curvatures),
        cmocka_unit_test(poles_have_no_normal),
        cmocka_unit_test(closed_directions_and_poles_are_recognised),
        cmocka_unit_test(conventions_are_one_surface),
        cmocka_unit_test(flaws_are_refused_with_an_error),
        cmocka_unit_test(wrong_shapes_are_refused),
        cmocka_unit_test(nearest_points_are_global),
        cmocka_unit_test(control_points_are_those_of_the_data),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
