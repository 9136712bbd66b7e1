/* Tests the ends of traced lines at the boundary and at limits, and several lines that are traced
 * together. test_trace.c tests the lines themselves. */
#include "lines.h"

#include <string.h>

/* --- the boundary ----------------------------------------------------------------------------- */

static void stops_at_the_boundary(void **state)
{
    (void)state;
    struct surface grid = surface_of("grid", (double[SAMPLE_PARAMETERS]){5, 5, 1, 1});
    struct gd_point start = nearest(grid.mesh, 0.5, 0.5, 0);
    struct gd_trace trace = follow(grid.mesh, start, along(grid.mesh, start, 2, 1, 0), 9, NULL);
    struct gd_point end = end_of(&trace);
    assert_int_equal(trace.end, GD_TRACE_END_BOUNDARY);
    check_close(trace.path.length, sqrt(1.25) / 2, exact);
    expect_place(gd_point_position(grid.mesh, &end), 1, 0.75, 0, exact);
    expect_place(trace.direction.xyz, 2 / sqrt(5), 1 / sqrt(5), 0, exact);
    gd_trace_free(&trace);
    /* one line leads into a corner; another line runs along a straight side of the boundary, over
       its vertices */
    trace = follow(grid.mesh, start, along(grid.mesh, start, 1, 1, 0), 9, NULL);
    end = end_of(&trace);
    expect_place(gd_point_position(grid.mesh, &end), 1, 1, 0, exact);
    gd_trace_free(&trace);
    start = nearest(grid.mesh, 0.1, 0, 0);
    trace = follow(grid.mesh, start, along(grid.mesh, start, 1, 0, 0), 0.85, NULL);
    end = end_of(&trace);
    assert_int_equal(trace.end, GD_TRACE_END_LENGTH);
    expect_place(gd_point_position(grid.mesh, &end), 0.95, 0, 0, exact);
    gd_trace_free(&trace);
    surface_free(&grid);
}

/* Builds a square of 3 x 3 cells without the middle cell of the right column: a notch at x in 2..3,
 * y in 1..2. */
static struct gd_mesh *notched_square(void)
{
    enum { TRIANGLES = 16 };
    double positions[16][3];
    uint32_t corners[3 * TRIANGLES], count = 0;
    for (uint32_t i = 0; i < 16; i++) {
        positions[i][0] = i % 4;
        positions[i][1] = i / 4;
        positions[i][2] = 0;
    }
    for (uint32_t cell = 0; cell < 9; cell++) {
        uint32_t a = 4 * (cell / 3) + cell % 3, two[6] = {a, a + 1, a + 5, a, a + 5, a + 4};
        if (cell == 5) continue;
        memcpy(corners + count, two, sizeof two);
        count += 6;
    }
    struct gd_polygons polygons = {.positions = positions,
                                   .position_count = 16,
                                   .polygon_count = TRIANGLES,
                                   .corners = corners};
    return test_mesh(&polygons);
}

static void slides_along_the_boundary(void **state)
{
    (void)state;
    const struct gd_trace_options slide = {.boundary_rule = GD_BOUNDARY_RULE_SLIDE};
    struct surface grid = surface_of("grid", (double[SAMPLE_PARAMETERS]){5, 5, 1, 1});
    struct gd_point start = nearest(grid.mesh, 0.5, 0.5, 0);
    struct gd_trace trace =
        follow(grid.mesh, start, along(grid.mesh, start, 2, 1, 0), sqrt(1.25) / 2 + 0.1, &slide);
    struct gd_point end = end_of(&trace);
    assert_int_equal(trace.end, GD_TRACE_END_LENGTH);
    expect_place(gd_point_position(grid.mesh, &end), 1, 0.85, 0, exact);
    expect_place(trace.direction.xyz, 0, 1, 0, exact);
    gd_trace_free(&trace);
    /* the boundary turns by a right angle at the corner */
    trace = follow(grid.mesh, start, along(grid.mesh, start, 2, 1, 0), 9, &slide);
    end = end_of(&trace);
    assert_int_equal(trace.end, GD_TRACE_END_BOUNDARY);
    expect_place(gd_point_position(grid.mesh, &end), 1, 1, 0, exact);
    gd_trace_free(&trace);
    /* the line meets the boundary at a right angle, so it slides to neither side */
    trace = follow(grid.mesh, start, along(grid.mesh, start, 1, 0, 0), 9, &slide);
    check_close(trace.path.length, 0.5, exact);
    gd_trace_free(&trace);
    surface_free(&grid);
    /* the line runs along the notch's side, and continues straight where the boundary turns away */
    struct gd_mesh *mesh = notched_square();
    start = nearest(mesh, 1.25, 1.5, 0);
    trace = follow(mesh, start, along(mesh, start, 3, 1, 0), 1.5, &slide);
    end = end_of(&trace);
    assert_int_equal(trace.end, GD_TRACE_END_LENGTH);
    expect_place(gd_point_position(mesh, &end), 2, 1.75 + 1.5 - hypot(0.75, 0.25), 0, exact);
    gd_trace_free(&trace);
    gd_mesh_release(mesh);
}

/* --- limits ----------------------------------------------------------------------------------- */

static bool cancel(void *user, double fraction)
{
    (void)user;
    return fraction < 0.5;
}

static void limits(void **state)
{
    (void)state;
    struct surface torus = surface_of("torus", (double[SAMPLE_PARAMETERS]){40, 20, 2, 1});
    struct gd_point start = nearest(torus.mesh, 3, 0.1, 0.1);
    struct gd_direction ahead = along(torus.mesh, start, 0, 2, 1);
    const struct gd_trace_options few = {.step_limit = 10};
    struct gd_trace trace = follow(torus.mesh, start, ahead, 1e3, &few), again;
    assert_int_equal(trace.end, GD_TRACE_END_STEP_LIMIT);
    assert_int_equal(trace.path.count, 11);
    struct gd_point end = end_of(&trace); /* the line can be continued */
    again = follow(torus.mesh, end, trace.direction, 1, NULL);
    struct gd_trace whole = follow(torus.mesh, start, ahead, trace.path.length + 1, NULL);
    struct gd_point p = end_of(&again), q = end_of(&whole);
    assert_true(gd_vec3_distance(gd_point_position(torus.mesh, &p),
                                 gd_point_position(torus.mesh, &q)) < 1e-12);
    gd_trace_free(&trace);
    gd_trace_free(&again);
    gd_trace_free(&whole);
    const struct gd_trace_options many = {.step_limit = 400000};
    trace = follow(torus.mesh, start, ahead, 1e4, &many);
    check_close(trace.path.length, 1e4, 1e-15);
    gd_trace_free(&trace);
    struct gd_control control = {.budget_bytes = 4096};
    assert_int_equal(
        gd_trace_follow(torus.mesh,
                        &(struct gd_trace_request){
                            .start = &start, .ahead = &ahead, .length = 1e4, .options = &many},
                        &control, &trace, NULL),
        GD_BUDGET);
    control = (struct gd_control){.progress = cancel};
    assert_int_equal(
        gd_trace_follow(torus.mesh,
                        &(struct gd_trace_request){
                            .start = &start, .ahead = &ahead, .length = 1e4, .options = &many},
                        &control, &trace, NULL),
        GD_CANCELLED);
    control = (struct gd_control){.deadline_ns = 1};
    assert_int_equal(
        gd_trace_follow(torus.mesh,
                        &(struct gd_trace_request){
                            .start = &start, .ahead = &ahead, .length = 1e4, .options = &many},
                        &control, &trace, NULL),
        GD_DEADLINE);
    static const double lengths[] = {-1, NAN, INFINITY};
    struct gd_detail detail;
    for (uint32_t i = 0; i < COUNT(lengths); i++)
        assert_int_equal(
            gd_trace_follow(
                torus.mesh,
                &(struct gd_trace_request){.start = &start, .ahead = &ahead, .length = lengths[i]},
                NULL, &trace, &detail),
            GD_INVALID_ARGUMENT);
    trace = follow(torus.mesh, start, ahead, 0, NULL);
    assert_int_equal(trace.path.count, 1);
    assert_true(trace.direction.angle == ahead.angle);
    gd_trace_free(&trace);
    surface_free(&torus);
}

/* The edges of an octahedron continue each other straight, so a line along an edge passes only
 * vertices. If the step limit ends a line at a vertex, the line can be continued in its
 * direction. */
static void the_limit_at_a_vertex(void **state)
{
    (void)state;
    double positions[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    uint32_t corners[] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    struct gd_polygons polygons = {
        .positions = positions, .position_count = 6, .polygon_count = 8, .corners = corners};
    struct gd_mesh *mesh = test_mesh(&polygons);
    for (int from = 0; from < 6; from++)
        for (int to = 0; to < 6; to++) {
            if (from / 2 == to / 2) continue;
            const double *a = positions[from], *b = positions[to];
            struct gd_point start = nearest(mesh, a[0], a[1], a[2]);
            struct gd_direction ahead = along(mesh, start, b[0] - a[0], b[1] - a[1], b[2] - a[2]);
            for (uint32_t steps = 1; steps < 4; steps++) {
                const struct gd_trace_options few = {.step_limit = steps};
                struct gd_trace trace = follow(mesh, start, ahead, 9, &few);
                struct gd_point end = end_of(&trace);
                assert_int_equal(trace.end, GD_TRACE_END_STEP_LIMIT);
                assert_int_equal(end.kind, GD_POINT_VERTEX);
                struct gd_trace rest = follow(mesh, end, trace.direction, 0.5, NULL),
                                whole = follow(mesh, start, ahead, steps * sqrt(2) + 0.5, NULL);
                struct gd_point p = end_of(&rest), q = end_of(&whole);
                assert_true(gd_vec3_distance(gd_point_position(mesh, &p),
                                             gd_point_position(mesh, &q)) < 1e-12);
                gd_trace_free(&trace);
                gd_trace_free(&rest);
                gd_trace_free(&whole);
            }
        }
    gd_mesh_release(mesh);
}

static void fans(void **state)
{
    (void)state;
    struct surface grid = surface_of("grid", (double[SAMPLE_PARAMETERS]){2, 2, 2, 2});
    struct gd_point inside = nearest(grid.mesh, 1.3, 1.4, 0), middle = nearest(grid.mesh, 1, 1, 0),
                    corner = nearest(grid.mesh, 0, 0, 0), rim = nearest(grid.mesh, 2, 0.5, 0);
    const struct gd_point closed[] = {inside, middle};
    for (uint32_t p = 0; p < COUNT(closed); p++)
        for (uint32_t i = 0; i < 8; i++)
            expect_near(gd_trace_fan(grid.mesh, &closed[p], 8, i).angle, M_PI * i / 4, exact);
    for (uint32_t i = 0; i < 5; i++) {
        struct gd_direction direction = gd_trace_fan(grid.mesh, &corner, 5, i);
        expect_place(direction.xyz, cos(M_PI * i / 8), sin(M_PI * i / 8), 0, exact);
        direction = gd_trace_fan(grid.mesh, &rim, 5, i);
        assert_true(direction.xyz.x <= exact);
        struct gd_trace trace = follow(grid.mesh, rim, direction, 0.25, NULL);
        assert_int_equal(trace.end, GD_TRACE_END_LENGTH);
        gd_trace_free(&trace);
    }
    assert_true(gd_trace_fan(grid.mesh, &corner, 1, 0).angle == 0);
    surface_free(&grid);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stops_at_the_boundary),
        cmocka_unit_test(slides_along_the_boundary),
        cmocka_unit_test(limits),
        cmocka_unit_test(the_limit_at_a_vertex),
        cmocka_unit_test(fans),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
