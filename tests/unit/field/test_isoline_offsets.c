/* Compares isolines of segments and curves with closed forms. */
#include "isolines.h"

#include "gd/curve.h"

/* Returns the seeds and the length of a curve. The caller frees the seeds. */
static struct gd_seed *seeds_of(const struct gd_mesh *mesh, const struct gd_curve_request *request,
                                uint32_t *count, double *length)
{
    struct gd_curve curve;
    struct gd_detail detail = {0};
    check_ok(gd_curve_resolve(mesh, request, NULL, &curve, &detail), &detail);
    *count = gd_curve_seed_count(&curve);
    struct gd_seed *seeds = calloc(*count, sizeof *seeds);
    gd_curve_seeds(&curve, 0, seeds);
    *length = gd_curve_length(mesh, &curve);
    gd_curve_free(&curve);
    return seeds;
}

static struct gd_field *field_of_curve(const struct gd_mesh *mesh,
                                       const struct gd_curve_request *request, double *length)
{
    uint32_t count;
    struct gd_seed *seeds = seeds_of(mesh, request, &count, length);
    struct gd_field *field = test_field(mesh, seeds, count, 0);
    free(seeds);
    return field;
}

static double straight_length(const struct gd_isoline *isoline)
{
    double length = 0;
    for (uint32_t i = 0; i < isoline->line_count; i++)
        for (uint32_t k = 0; k < isoline->lines[i].arc_count; k++)
            if (isoline->lines[i].arcs[k].radius == 0)
                length += gd_isoline_arc_length(&isoline->lines[i].arcs[k]);
    return length;
}

/* Checks that the isoline is a single closed line of this length, and that its straight segments
 * have the total length `straight`. A straight segment is followed by an arc, which at first
 * differs from the line only in second order. The total length of straight segments is therefore
 * known only to 1e-6. Returns the relative error of the length. */
static double check_offset(const struct gd_field *field, double level, double length,
                           double straight)
{
    struct gd_isoline isoline = trace(field, level);
    assert_int_equal(isoline.line_count, 1);
    assert_true(isoline.lines[0].closed);
    assert_true(fabs(straight_length(&isoline) - straight) < 1e-6 * (straight + level));
    double error = check_close(total_length(&isoline), length, promise);
    gd_isoline_free(&isoline);
    return error;
}

/* Tests lines of two straight segments and two half circles, at several scales and far from the
 * origin. */
static void offsets_of_a_segment(void **state)
{
    (void)state;
    static const double scales[] = {1e-6, 1, 1e6};
    struct rng rng = {3};
    double worst = 0;
    for (int round = 0; round < 30; round++) {
        double scale = scales[round % 3], away = round % 2 ? 1e3 * scale : 0;
        struct gd_polygons polygons;
        check_ok(sample_grid(9, 7, 3 * scale, 2 * scale, &polygons), NULL);
        for (uint32_t v = 0; v < polygons.position_count; v++) polygons.positions[v][0] += away;
        struct gd_mesh *mesh = test_mesh(&polygons);
        struct gd_point ends[2];
        for (int i = 0; i < 2; i++)
            ends[i] = test_point_near(mesh, away + scale * rng_between(&rng, 0.9, 2.1),
                                      scale * rng_between(&rng, 0.9, 1.1), 0);
        double length;
        struct gd_field *field =
            field_of_curve(mesh, &(struct gd_curve_request){.points = ends, .count = 2}, &length);
        for (double level = 1e-4; level < 0.9; level += 0.0511)
            worst = fmax(worst, check_offset(field, level * scale,
                                             2 * (length + M_PI * level * scale), 2 * length));
        gd_field_release(field);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
    print_message("# offsets of a segment: lengths off by %.1e at most\n", worst);
}

/* Tests segments along edges and parallel to edges. Some levels have lines along edges. */
static void offsets_along_edges(void **state)
{
    (void)state;
    static const double at[][4] = {{3, 5, 6, 5},      {3.25, 5, 6.5, 5},     {3.25, 4.5, 6.5, 4.5},
                                   {3.3, 5, 3.6, 5},  {5, 3, 5, 6},          {3, 3, 6.25, 6.25},
                                   {4, 4.5, 4, 5.75}, {3.1, 4.75, 3.2, 4.75}};
    static const double levels[] = {0.25,      0.5,     1,         1.5,       2,         2.5,
                                    M_SQRT1_2, M_SQRT2, 1 - 1e-13, 1 + 1e-13, 2 - 1e-12, 2 + 1e-12};
    struct gd_polygons polygons;
    check_ok(sample_grid(10, 10, 10, 10, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
        struct gd_point ends[2] = {test_point_near(mesh, at[i][0], at[i][1], 0),
                                   test_point_near(mesh, at[i][2], at[i][3], 0)};
        double length;
        struct gd_field *field =
            field_of_curve(mesh, &(struct gd_curve_request){.points = ends, .count = 2}, &length);
        for (size_t k = 0; k < sizeof levels / sizeof *levels; k++)
            check_offset(field, levels[k], 2 * (length + M_PI * levels[k]), 2 * length);
        gd_field_release(field);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* Outside a convex polygon the line has parallel sides, and arcs that sum to a full turn. Inside,
 * the line is a polygon. */
static void offsets_of_a_polygon(void **state)
{
    (void)state;
    static const double corners[5][2] = {{3, 3}, {6.5, 2.5}, {7.25, 5}, {5, 7}, {3, 6.5}};
    struct gd_polygons polygons;
    check_ok(sample_grid(11, 13, 10, 10, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_point points[5];
    double length, shrinking = 0;
    for (int i = 0; i < 5; i++) {
        const double *a = corners[i], *b = corners[(i + 1) % 5], *c = corners[(i + 4) % 5];
        double turn_at = atan2(a[0] - c[0], a[1] - c[1]) - atan2(b[0] - a[0], b[1] - a[1]);
        points[i] = test_point_near(mesh, a[0], a[1], 0);
        shrinking += 2 * tan(0.5 * remainder(turn_at, 2 * M_PI));
    }
    struct gd_field *field = field_of_curve(
        mesh, &(struct gd_curve_request){.points = points, .count = 5, .closed = true}, &length);
    for (double level = 0.01; level < 1.5; level += 0.0791) {
        struct gd_isoline isoline = trace(field, level);
        double inner = length - level * shrinking;
        assert_int_equal(isoline.line_count, 2);
        check_close(total_length(&isoline), length + 2 * M_PI * level + inner, promise);
        check_close(straight_length(&isoline), length + inner, 1e-7);
        gd_isoline_free(&isoline);
    }
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* Tests lines inside a rectangle's boundary up to the ridge. Some lines run along rows of edges. */
static void offsets_of_a_boundary(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_grid(8, 6, 8, 6, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    double length;
    struct gd_field *field =
        field_of_curve(mesh, &(struct gd_curve_request){.kind = GD_CURVE_BOUNDARY}, &length);
    check_close(length, 28, 1e-14);
    for (double level = 0.0625; level < 3; level += 0.0625)
        check_offset(field, level, 28 - 8 * level, 28 - 8 * level);
    check_offset(field, 1e-5, 28 - 8e-5, 28 - 8e-5);
    struct gd_isoline ridge = trace(field, 3), none = trace(field, 3.001);
    check_close(total_length(&ridge), 4, promise);
    assert_int_equal(none.line_count, 0);
    gd_isoline_free(&ridge);
    gd_isoline_free(&none);
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* Tests isolines on the lateral surface of a prism. If one boundary is the seed, there is a single
 * line around the prism; if both are seeds, there are two lines. Isolines about a geodesic on a
 * prism or a cone have the same lengths as in a plane. */
static void offsets_on_mantles(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    double length, half;
    check_ok(sample_cylinder(1, 4, 7, 8, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_field *field =
        field_of_curve(mesh, &(struct gd_curve_request){.kind = GD_CURVE_BOUNDARY}, &length);
    check_close(length, 14 * sin(M_PI / 7), 1e-14);
    for (double level = 0.125; level < 4; level += 0.125)
        check_offset(field, level, length, length);
    gd_field_release(field);
    uint32_t count, more;
    struct gd_seed seeds[128],
        *low = seeds_of(mesh, &(struct gd_curve_request){.kind = GD_CURVE_BOUNDARY}, &count, &half),
        *high = seeds_of(mesh, &(struct gd_curve_request){.kind = GD_CURVE_BOUNDARY, .boundary = 1},
                         &more, &half);
    for (uint32_t i = 0; i < count + more; i++) seeds[i] = i < count ? low[i] : high[i - count];
    field = test_field(mesh, seeds, count + more, 0);
    for (double level = 0.125; level < 2; level += 0.125) {
        struct gd_isoline isoline = trace(field, level);
        assert_int_equal(isoline.line_count, 2);
        check_close(total_length(&isoline), 2 * length, promise);
        gd_isoline_free(&isoline);
    }
    gd_field_release(field);
    free(low);
    free(high);
    struct gd_point ends[2] = {
        test_point(mesh, (struct test_place){2 * 7 * 3 + 1, {0.2, 0.3, 0.5}}),
        test_point(mesh, (struct test_place){2 * 7 * 4 + 4, {0.6, 0.3, 0.1}})};
    field = field_of_curve(mesh, &(struct gd_curve_request){.points = ends, .count = 2}, &length);
    for (double level = 0.01; level < 1; level += 0.0713)
        check_offset(field, level, 2 * (length + M_PI * level), 2 * length);
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
    check_ok(sample_cone(2, 1, 9, 12, &polygons), NULL);
    mesh = test_mesh(&polygons);
    for (int i = 0; i < 2; i++) ends[i] = test_point_near(mesh, 0.9 + 0.1 * i, i ? 0.4 : -0.3, 0);
    field = field_of_curve(mesh, &(struct gd_curve_request){.points = ends, .count = 2}, &length);
    for (double level = 0.01; level < 0.6; level += 0.0713)
        check_offset(field, level, 2 * (length + M_PI * level), 2 * length);
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(offsets_of_a_segment), cmocka_unit_test(offsets_along_edges),
        cmocka_unit_test(offsets_of_a_polygon), cmocka_unit_test(offsets_of_a_boundary),
        cmocka_unit_test(offsets_on_mantles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
