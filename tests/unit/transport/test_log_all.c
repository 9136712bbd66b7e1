#include "lines.h"

#include "gd/query.h"
#include "tests/support/field.h"

/* Checks the map at a vertex. The map's length must equal the length of gd_pair_from_field's path.
 * Increments *others if the map's direction belongs to another path. */
static void check_vertex(const struct gd_field *field, struct gd_point from, uint32_t index,
                         double angle, double length, uint32_t *others)
{
    const struct gd_mesh *mesh = gd_field_mesh(field);
    struct gd_point to = vertex(mesh, index);
    struct gd_pair_answer answer;
    struct gd_log log;
    check_ok(gd_pair_from_field(field, &from, &to, true, &answer), NULL);
    check_close(length, answer.distance, 0);
    if (!isinf(length) && length > 0) {
        check_ok(gd_vector_log(mesh, &answer.path, &log, NULL), NULL);
        if (fabs(remainder(angle - log.vector.direction.angle, 2 * M_PI)) > promise) ++*others;
        gd_log_free(&log);
    } else {
        assert_true(isnan(angle));
    }
    gd_pair_answer_free(&answer);
}

static void check_map(const struct gd_mesh *mesh, struct gd_point from)
{
    uint32_t count = gd_mesh_summary(mesh)->index_count, others = 0;
    double *angles = malloc(2 * count * sizeof *angles), *lengths = angles + count;
    struct gd_field *field = test_field_from(mesh, from);
    struct gd_detail detail = {0};
    check_ok(gd_vector_log_all(field, NULL, angles, lengths, &detail), &detail);
    for (uint32_t i = 0; i < count; i++) {
        struct gd_point point;
        bool is_there = !gd_point_at_vertex(mesh, (struct gd_vertex){i}, &point, NULL);
        assert_true(is_there == !isnan(lengths[i]));
        if (is_there) check_vertex(field, from, i, angles[i], lengths[i], &others);
    }
    assert_true(others <= 2 + count / 200); /* on the cut locus several paths are shortest */
    gd_field_release(field);
    free(angles);
}

static void agrees_with_paths(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double values[SAMPLE_PARAMETERS];
    } surfaces[] = {{"terrain", {30, 0.8, 3}},
                    {"genus2", {6, 0.1}},
                    {"tangle", {200, 11}},
                    {"tangle", {150, 4}},
                    {"saddle", {1, 0.7, 12, 6}}};
    for (uint32_t s = 0; s < COUNT(surfaces); s++) {
        struct surface surface = surface_of(surfaces[s].name, surfaces[s].values);
        struct rng rng = {s + 1};
        for (int i = 0; i < 6; i++)
            check_map(surface.mesh,
                      test_point(surface.mesh, test_random_place(&surface.polygons, &rng)));
        surface_free(&surface);
    }
    static const char *const names[] = {"spot", "cow", "suzanne", "rocker-arm", "teapot"};
    for (uint32_t i = 0; i < COUNT(names); i++) {
        struct surface surface;
        if (!surface_read(names[i], &surface)) continue;
        check_map(surface.mesh, nearest(surface.mesh, 0.1, 0.2, 0.3));
        surface_free(&surface);
    }
}

/* In a plane the directions are known. */
static void in_the_plane(void **state)
{
    (void)state;
    struct surface grid = surface_of("grid", (double[SAMPLE_PARAMETERS]){40, 40, 1, 1});
    struct gd_point from = nearest(grid.mesh, 0.412, 0.357, 0);
    struct gd_vec3 p = gd_point_position(grid.mesh, &from);
    uint32_t count = gd_mesh_summary(grid.mesh)->index_count;
    double *angles = malloc(2 * count * sizeof *angles), *lengths = angles + count;
    double zero = along(grid.mesh, from, 1, 0, 0).angle;
    struct gd_field *field = test_field_from(grid.mesh, from);
    check_ok(gd_vector_log_all(field, NULL, angles, lengths, NULL), NULL);
    for (uint32_t i = 0; i < count; i++) {
        struct gd_vec3 q = gd_mesh_position(grid.mesh, (struct gd_vertex){i});
        expect_near(remainder(angles[i] - zero - atan2(q.y - p.y, q.x - p.x), 2 * M_PI), 0, exact);
        check_close(lengths[i], hypot(q.x - p.x, q.y - p.y), exact);
    }
    gd_field_release(field);
    free(angles);
    surface_free(&grid);
}

static void other_fields_are_refused(void **state)
{
    (void)state;
    struct surface grid = surface_of("grid", (double[SAMPLE_PARAMETERS]){9, 9, 1, 1});
    uint32_t count = gd_mesh_summary(grid.mesh)->index_count;
    double *angles = malloc(2 * count * sizeof *angles);
    const struct gd_seed seeds[2] = {{.point = vertex(grid.mesh, 0)},
                                     {.point = vertex(grid.mesh, 5)}};
    const struct gd_field_request requests[] = {{.seeds = seeds, .seed_count = 2},
                                                {.seeds = seeds, .seed_count = 1, .radius = 0.3}};
    for (uint32_t i = 0; i < COUNT(requests); i++) {
        struct gd_field *field;
        check_ok(gd_field_build(grid.mesh, &requests[i], NULL, &field, NULL), NULL);
        assert_int_equal(gd_vector_log_all(field, NULL, angles, angles + count, NULL),
                         GD_INVALID_ARGUMENT);
        gd_field_release(field);
    }
    struct gd_field *field = test_field_from(grid.mesh, seeds[0].point);
    struct gd_control control = {.budget_bytes = 100};
    assert_int_equal(gd_vector_log_all(field, &control, angles, angles + count, NULL), GD_BUDGET);
    control = (struct gd_control){.deadline_ns = 1};
    assert_int_equal(gd_vector_log_all(field, &control, angles, angles + count, NULL), GD_DEADLINE);
    gd_field_release(field);
    free(angles);
    surface_free(&grid);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(agrees_with_paths),
        cmocka_unit_test(in_the_plane),
        cmocka_unit_test(other_fields_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
