#include "lines.h"

#include "transport/straight.h"

enum { STEPS = 4000 };

static struct gd_vec3 heading(const struct gd_mesh *mesh, struct gd_point point, double turn)
{
    return gd__turn_direction(mesh, &point, gd__turn_reduce(mesh, &point, turn)).xyz;
}

/* Searches the directions at the vertex that lie in the plane with the normal `across`. Returns the
 * turn of the direction nearest to `ahead`, or NAN if no such direction leads forward. */
static double search(const struct gd_mesh *mesh, struct gd_point point, struct gd_vec3 across,
                     struct gd_vec3 ahead)
{
    double total = gd__turn_total(mesh, &point), best = 0, found = NAN;
    for (int i = 0; i < STEPS; i++) {
        double low = total * i / STEPS, high = total * (i + 1) / STEPS;
        double at_low = gd_vec3_dot(heading(mesh, point, low), across),
               at_high = gd_vec3_dot(heading(mesh, point, high), across);
        if ((at_low < 0) == (at_high < 0)) continue;
        for (int k = 0; k < 60; k++) {
            double middle = (low + high) / 2;
            bool is_low = (gd_vec3_dot(heading(mesh, point, middle), across) < 0) == (at_low < 0);
            *(is_low ? &low : &high) = middle;
        }
        double cosine = gd_vec3_dot(heading(mesh, point, low), ahead);
        if (cosine <= best) continue;
        best = cosine;
        found = low;
    }
    return found;
}

static void least_turn_in_the_plane(void **state)
{
    (void)state;
    struct surface saddle = surface_of("saddle", (double[SAMPLE_PARAMETERS]){1, 1.2, 6, 2});
    struct gd_point apex = nearest(saddle.mesh, 0, 0, 0);
    struct gd_vec3 *normals = calloc(saddle.polygons.position_count, sizeof *normals);
    struct rng rng = {5};
    uint32_t found = 0;
    for (int i = 0; i < 60; i++) {
        struct gd_vec3 normal = {rng_between(&rng, -1, 1), rng_between(&rng, -1, 1),
                                 rng_between(&rng, 0.1, 1)};
        for (uint32_t k = 0; k < saddle.polygons.position_count; k++) normals[k] = normal;
        double back = rng_between(&rng, 0, gd__turn_total(saddle.mesh, &apex)), out;
        struct gd_vec3 v = heading(saddle.mesh, apex, back),
                       n = gd_vec3_scale(normal, 1 / gd_vec3_length(normal));
        struct gd_vec3 ahead = gd_vec3_sub(gd_vec3_scale(n, gd_vec3_dot(v, n)), v);
        double expected = search(saddle.mesh, apex, gd_vec3_cross(v, n), ahead);
        const struct gd_trace_options options = {.vertex_rule = GD_VERTEX_RULE_NORMAL,
                                                 .normals = normals};
        assert_true(gd__straight_on(saddle.mesh, apex.element, back, &options, &out));
        /* no direction in the plane leads forward, so the expected direction halves the vertex'
           total angle */
        if (isnan(expected)) {
            expected =
                gd__turn_reduce(saddle.mesh, &apex, back + gd__turn_total(saddle.mesh, &apex) / 2);
        } else {
            found++;
        }
        expect_near(remainder(out - expected, gd__turn_total(saddle.mesh, &apex)), 0, 1e-9);
    }
    assert_true(found > 30);
    free(normals);
    surface_free(&saddle);
}

/* A line slides along the boundary of a regular hexagon in both senses of rotation. */
static void slides_round_a_hexagon(void **state)
{
    (void)state;
    double positions[7][3] = {{0}};
    uint32_t corners[18];
    for (uint32_t i = 0; i < 6; i++) {
        positions[i][0] = cos(M_PI * i / 3);
        positions[i][1] = sin(M_PI * i / 3);
        corners[3 * i] = 6;
        corners[3 * i + 1] = i;
        corners[3 * i + 2] = (i + 1) % 6;
    }
    struct gd_polygons polygons = {
        .positions = positions, .position_count = 7, .polygon_count = 6, .corners = corners};
    struct gd_mesh *mesh = test_mesh(&polygons);
    const struct gd_trace_options slide = {.boundary_rule = GD_BOUNDARY_RULE_SLIDE};
    struct gd_point start = nearest(mesh, 0, sqrt(0.75), 0); /* the middle of a side */
    for (int sense = -1; sense <= 1; sense += 2) {
        struct gd_trace once = follow(mesh, start, along(mesh, start, sense, 0, 0), 6, &slide);
        struct gd_point home = end_of(&once);
        expect_place(gd_point_position(mesh, &home), 0, sqrt(0.75), 0, exact);
        assert_int_equal(once.end, GD_TRACE_END_LENGTH);
        struct gd_trace next = follow(mesh, start, along(mesh, start, sense, 0, 0), 1, &slide);
        struct gd_point beside = end_of(&next);
        expect_place(gd_point_position(mesh, &beside), 0.75 * sense, sqrt(0.75) / 2, 0, exact);
        gd_trace_free(&next);
        gd_trace_free(&once);
    }
    gd_mesh_release(mesh);
}

/* A line along a straight side of the boundary passes over vertices, in both directions. */
static void runs_along_a_straight_side(void **state)
{
    (void)state;
    struct surface grid = surface_of("grid", (double[SAMPLE_PARAMETERS]){7, 5, 1, 1});
    for (int sense = -1; sense <= 1; sense += 2) {
        struct gd_point start = nearest(grid.mesh, 0.5 - 0.45 * sense, 0, 0);
        struct gd_trace trace =
            follow(grid.mesh, start, along(grid.mesh, start, sense, 0, 0), 0.9, NULL);
        struct gd_point end = end_of(&trace);
        assert_int_equal(trace.end, GD_TRACE_END_LENGTH);
        expect_place(gd_point_position(grid.mesh, &end), 0.5 + 0.45 * sense, 0, 0, exact);
        gd_trace_free(&trace);
    }
    surface_free(&grid);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(least_turn_in_the_plane),
                                       cmocka_unit_test(slides_round_a_hexagon),
                                       cmocka_unit_test(runs_along_a_straight_side)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
