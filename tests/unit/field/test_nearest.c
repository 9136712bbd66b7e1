#include "tests/support/test.h"

#include <math.h>

#include "gd/field.h"
#include "tests/samples/samples.h"
#include "tests/support/field.h"

enum { SEEDS = 6, POINTS = 400 };

/* The nearest seed's own field has the same distance, and no other seed's field has a smaller
 * distance. The path ends in the nearest seed. */
static void the_nearest_seed_gives_the_distance(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double values[SAMPLE_PARAMETERS];
    } surfaces[] = {{"terrain", {14, 0.8, 3}}, {"saddle", {1, 0.6, 5, 6}},
                    {"obstacles", {5, 1, 3}},  {"torus", {20, 10, 1, 0.4}},
                    {"tangle", {150, 11}},     {"cylinder", {0.1, 3, 16, 5}}};
    for (size_t s = 0; s < sizeof surfaces / sizeof *surfaces; s++) {
        struct gd_polygons polygons;
        check_ok(sample_find(surfaces[s].name)->generate(surfaces[s].values, &polygons), NULL);
        struct gd_mesh *mesh = test_mesh(&polygons);
        struct rng rng = {s};
        struct gd_seed seeds[SEEDS] = {0};
        struct gd_field *alone[SEEDS];
        for (int i = 0; i < SEEDS; i++) {
            seeds[i].point = test_point(mesh, test_random_place(&polygons, &rng));
            seeds[i].offset = i % 2 ? 0.02 * i : 0;
            alone[i] = test_field(mesh, &seeds[i], 1, 0);
        }
        struct gd_field *field = test_field(mesh, seeds, SEEDS, 0);
        assert_int_equal(gd_field_seed_count(field), SEEDS);
        uint32_t other_end = 0;
        for (int k = 0; k < POINTS; k++) {
            struct gd_point point = test_point(mesh, test_random_place(&polygons, &rng));
            double distance, least = INFINITY, own = INFINITY;
            uint32_t nearest;
            check_ok(gd_field_nearest(field, &point, &distance, &nearest), NULL);
            for (uint32_t i = 0; i < SEEDS; i++) {
                double d;
                check_ok(gd_field_distance(alone[i], &point, &d), NULL);
                least = fmin(least, d);
                if (i == nearest) own = d;
            }
            check_close(distance, least, 1e-12);
            check_close(own, least, 1e-12);
            if (nearest == UINT32_MAX) continue;
            struct gd_path path;
            check_ok(gd_field_path(field, &point, &path), NULL);
            other_end += !gd_point_equal(&path.points[path.count - 1], &seeds[nearest].point);
            gd_path_free(&path);
        }
        assert_int_equal(other_end, 0);
        for (int i = 0; i < SEEDS; i++) gd_field_release(alone[i]);
        gd_field_release(field);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

static void a_seed_is_nearest_to_itself(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_icosphere(1, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_seed seeds[4] = {
        {.point = test_point(mesh, (struct test_place){0, {1, 0, 0}})},
        {.point = test_point(mesh, (struct test_place){5, {0.3, 0.7, 0}})},
        {.point = test_point(mesh, (struct test_place){9, {0.2, 0.3, 0.5}})},
        {.point = test_point(mesh, (struct test_place){0, {1, 0, 0}}), .offset = 0.5}};
    struct gd_field *field = test_field(mesh, seeds, 4, 0);
    for (uint32_t i = 0; i < 3; i++) {
        double distance;
        uint32_t nearest;
        check_ok(gd_field_nearest(field, &seeds[i].point, &distance, &nearest), NULL);
        assert_true(distance == 0);
        assert_int_equal(nearest, i);
    }
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

static void no_path_and_beyond_reach(void **state)
{
    (void)state;
    double positions[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}};
    uint32_t corners[6] = {0, 1, 2, 3, 4, 5}, nearest = 7;
    struct gd_polygons two = {
        .positions = positions, .position_count = 6, .polygon_count = 2, .corners = corners};
    struct gd_mesh *mesh = test_mesh(&two);
    struct gd_seed seed = {.point = test_point(mesh, (struct test_place){0, {1, 0, 0}})};
    struct gd_point far = test_point(mesh, (struct test_place){0, {0, 1, 0}}),
                    apart = test_point(mesh, (struct test_place){1, {0.2, 0.3, 0.5}});
    struct gd_field *whole = test_field(mesh, &seed, 1, 0),
                    *partial = test_field(mesh, &seed, 1, 0.25);
    double distance = 7;
    assert_int_equal(gd_field_nearest(partial, &far, &distance, &nearest), GD_BEYOND_REACH);
    assert_true(distance == 7 && nearest == 7);
    check_ok(gd_field_nearest(whole, &apart, &distance, &nearest), NULL);
    assert_true(isinf(distance) && nearest == UINT32_MAX);
    gd_field_release(whole);
    gd_field_release(partial);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_nearest_seed_gives_the_distance),
        cmocka_unit_test(a_seed_is_nearest_to_itself),
        cmocka_unit_test(no_path_and_beyond_reach),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
