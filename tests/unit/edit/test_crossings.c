#include "edit/crossings.h"
#include "edits.h"

struct example {
    const char *name;
    double positions[6][3];
    uint32_t count, corners[9];
    /* the expected result of gd__find_crossings plus one, or 0 if no crossing is expected */
    uint32_t crossed[3];
};

#define FLAT                                                                                       \
    {0, 0, 0}, {4, 0, 0},                                                                          \
    {                                                                                              \
        0, 4, 0                                                                                    \
    }

static const struct example examples[] = {
    {"an edge of the second passes through the first",
     {FLAT, {1, 1, -1}, {1, 1, 1}, {5, 5, 1}},
     2,
     {0, 1, 2, 3, 4, 5},
     {2, 1}},
    {"apart, but the boxes overlap",
     {FLAT, {3, 3, -1}, {3, 3, 1}, {5, 5, 1}},
     2,
     {0, 1, 2, 3, 4, 5},
     {0, 0}},
    {"a corner of the second lies on the first",
     {FLAT, {1, 1, 0}, {1, 1, 1}, {5, 5, 1}},
     2,
     {0, 1, 2, 3, 4, 5},
     {0, 0}},
    {"the last passes through the first, with which it shares a corner",
     {FLAT, {1, 1, -1}, {1, 1, 1}},
     3,
     {0, 1, 2, 0, 2, 4, 0, 4, 3},
     {3, 0, 1}},
    {"faces around a corner", {FLAT, {-1, 1, 1}}, 2, {0, 1, 2, 0, 2, 3}, {0, 0}},
    {"a common edge, flat", {FLAT, {4, -4, 0}}, 2, {0, 1, 2, 1, 0, 3}, {0, 0}},
    {"a common edge, at 1.4 degrees", {FLAT, {4, 4, 0.1}}, 2, {0, 1, 2, 1, 0, 3}, {2, 1}},
    {"a common edge, at 8.5 degrees", {FLAT, {4, 4, 0.6}}, 2, {0, 1, 2, 1, 0, 3}, {0, 0}},
};

static void small_examples(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof examples / sizeof *examples; i++) {
        struct example example = examples[i];
        uint32_t crossed[3] = {GD_NONE, GD_NONE, GD_NONE};
        const struct gd_polygons polygons = {.positions = example.positions,
                                             .position_count = 6,
                                             .polygon_count = example.count,
                                             .corners = example.corners};
        check_ok(gd__find_crossings(&polygons, NULL, crossed), NULL);
        for (int k = 0; k < 3; k++)
            if (crossed[k] + 1 != example.crossed[k])
                fail_msg("%s: triangle %d crosses %d", example.name, k, (int)crossed[k]);
    }
}

/* Two overlapping spheres cross near the circle in which they meet, and nowhere else. */
static void two_spheres(void **state)
{
    (void)state;
    struct gd_polygons sphere, all = {0};
    gd_mesh_release(test_sample("icosphere", (double[SAMPLE_PARAMETERS]){4, 1}, &sphere));
    uint32_t vertices = sphere.position_count, faces = sphere.polygon_count;
    all = (struct gd_polygons){.positions = malloc(2 * vertices * sizeof *all.positions),
                               .position_count = 2 * vertices,
                               .polygon_count = 2 * faces,
                               .corners = malloc(6 * (size_t)faces * sizeof *all.corners)};
    uint32_t *crossed = malloc(2 * faces * sizeof *crossed);
    assert_true(all.positions && all.corners && crossed);
    for (uint32_t v = 0; v < 2 * vertices; v++) {
        memcpy(all.positions[v], sphere.positions[v % vertices], sizeof *all.positions);
        all.positions[v][0] += v < vertices ? 0 : 1.01;
    }
    for (uint32_t c = 0; c < 6 * faces; c++)
        all.corners[c] = sphere.corners[c % (3 * faces)] + (c < 3 * faces ? 0 : vertices);
    check_ok(gd__find_crossings(&all, NULL, crossed), NULL);
    uint32_t count = 0;
    for (uint32_t f = 0; f < 2 * faces; f++) {
        double x = 0;
        for (int k = 0; k < 3; k++) x += all.positions[all.corners[3 * f + (uint32_t)k]][0] / 3;
        if (crossed[f] == GD_NONE) continue;
        count++;
        assert_true(fabs(x - 0.505) < 0.1);
        assert_true((crossed[f] < faces) == (f >= faces));
    }
    assert_in_range(count, 100, 600);
    free(crossed);
    gd_polygons_free(&sphere);
    gd_polygons_free(&all);
}

static void the_control_stops_it(void **state)
{
    (void)state;
    const struct gd_control late = {.deadline_ns = 1};
    struct gd_polygons sphere;
    gd_mesh_release(test_sample("icosphere", (double[SAMPLE_PARAMETERS]){3, 1}, &sphere));
    uint32_t *crossed = malloc(sphere.polygon_count * sizeof *crossed);
    assert_non_null(crossed);
    assert_int_equal(gd__find_crossings(&sphere, &late, crossed), GD_DEADLINE);
    free(crossed);
    gd_polygons_free(&sphere);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(small_examples),
        cmocka_unit_test(two_spheres),
        cmocka_unit_test(the_control_stops_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
