#include "tests/support/test.h"

#include <math.h>

#include "gd/field.h"
#include "gd/sampling.h"
#include "tests/samples/samples.h"
#include "tests/support/watch.h"

enum { MOST = 12 };

static const double promise = 1e-9;

/* Sampling from a corner finds the opposite corner, then the other two corners, and then the
 * centre. The test uses one cell and many cells. */
static void corners_and_middle_of_a_square(void **state)
{
    (void)state;
    static const double radii[] = {M_SQRT2, 1, 1, M_SQRT1_2, 0.5};
    for (uint32_t cells = 1; cells <= 5; cells++) {
        struct gd_mesh *mesh =
            test_sample("grid", (double[SAMPLE_PARAMETERS]){cells, cells, 1, 1}, NULL);
        struct gd_point start = test_vertex(mesh, 0), points[MOST];
        double found[MOST];
        check_ok(
            gd_sampling_farthest(mesh, &start, NULL, &(struct gd_sampling){5, points, found}, NULL),
            NULL);
        for (int i = 0; i < 5; i++) check_close(found[i], radii[i], promise);
        struct gd_vec3 middle = gd_point_position(mesh, &points[4]);
        assert_true(hypot(middle.x - 0.5, middle.y - 0.5) < promise);
        gd_mesh_release(mesh);
    }
}

/* Each point's distance from the earlier points equals the reported radius, and no vertex is
 * farther away. */
static void radii_cover_the_surface(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double values[SAMPLE_PARAMETERS];
    } surfaces[] = {{"terrain", {14, 0.8, 3}},
                    {"torus", {20, 10, 1, 0.4}},
                    {"tangle", {150, 11}},
                    {"box", {1, 2, 3, 2}}};
    for (size_t s = 0; s < sizeof surfaces / sizeof *surfaces; s++) {
        struct gd_mesh *mesh = test_sample(surfaces[s].name, surfaces[s].values, NULL);
        struct gd_point points[MOST];
        double radii[MOST], vertices[4096];
        check_ok(gd_sampling_farthest(mesh, NULL, NULL, &(struct gd_sampling){MOST, points, radii},
                                      NULL),
                 NULL);
        struct gd_seed seeds[MOST] = {0};
        for (uint32_t i = 0; i < MOST; i++) {
            seeds[i].point = points[i];
            struct gd_field *field;
            struct gd_field_request request = {.seeds = seeds, .seed_count = i + 1};
            check_ok(gd_field_build(mesh, &request, NULL, &field, NULL), NULL);
            double distance = INFINITY;
            if (i + 1 < MOST) check_ok(gd_field_distance(field, &points[i + 1], &distance), NULL);
            if (i + 1 < MOST) check_close(distance, radii[i], promise);
            assert_true(i == 0 || radii[i] <= radii[i - 1]);
            gd_field_vertex_distances(field, vertices);
            for (uint32_t v = 0; v < gd_mesh_summary(mesh)->index_count; v++)
                assert_false(vertices[v] > radii[i] * (1 + promise));
            gd_field_release(field);
        }
        gd_mesh_release(mesh);
    }
}

static void components_come_first(void **state)
{
    (void)state;
    double positions[][3] = {{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0},
                             {5, 0, 0}, {6, 0, 0}, {5, 1, 0}};
    uint32_t corners[] = {4, 5, 6, 1, 2, 3};
    struct gd_polygons polygons = {
        .positions = positions, .position_count = 7, .polygon_count = 2, .corners = corners};
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_point points[3];
    double radii[3];
    check_ok(gd_sampling_farthest(mesh, NULL, NULL, &(struct gd_sampling){3, points, radii}, NULL),
             NULL);
    struct gd_point expected[2] = {test_vertex(mesh, 1), test_vertex(mesh, 4)};
    for (int i = 0; i < 2; i++) assert_true(gd_point_equal(&points[i], &expected[i]));
    assert_true(isinf(radii[0]));
    check_close(radii[1], 1, promise);
    gd_mesh_release(mesh);
}

static void progress_increases_and_a_cancel_is_obeyed(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("terrain", (double[SAMPLE_PARAMETERS]){20, 0.5, 1}, NULL);
    struct gd_point points[MOST];
    double radii[MOST] = {-1};
    struct test_watch watch = {.most = 8};
    struct gd_control control = {.progress = test_watch, .user = &watch};
    assert_int_equal(gd_sampling_farthest(mesh, NULL, &control,
                                          &(struct gd_sampling){MOST, points, radii}, NULL),
                     GD_CANCELLED);
    assert_true(watch.last > 0 && watch.last < 1 && radii[0] == -1);
    watch = (struct test_watch){0};
    check_ok(gd_sampling_farthest(mesh, NULL, &control, &(struct gd_sampling){MOST, points, radii},
                                  NULL),
             NULL);
    control = (struct gd_control){.budget_bytes = 64};
    assert_int_equal(gd_sampling_farthest(mesh, NULL, &control,
                                          &(struct gd_sampling){MOST, points, radii}, NULL),
                     GD_BUDGET);
    assert_int_equal(
        gd_sampling_farthest(mesh, NULL, NULL, &(struct gd_sampling){0, points, radii}, NULL),
        GD_INVALID_ARGUMENT);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(corners_and_middle_of_a_square),
        cmocka_unit_test(radii_cover_the_surface),
        cmocka_unit_test(components_come_first),
        cmocka_unit_test(progress_increases_and_a_cancel_is_obeyed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
