/* A workspace is clean between calls. No earlier call changes a result, for any mesh and status of
 * the earlier call. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gd/field.h"
#include "gd/query.h"
#include "gd/workspace.h"
#include "tests/samples/samples.h"

enum { MESHES = 4, ROUNDS = 60 };

static struct gd_polygons polygons[MESHES];
static struct gd_mesh *meshes[MESHES];
static struct gd_workspace *workspace;

static int open_all(void **state)
{
    (void)state;
    check_ok(sample_terrain(24, 0.3, 7, &polygons[0]), NULL);
    check_ok(sample_icosphere(1, 1, &polygons[1]), NULL);
    check_ok(sample_genus2(4, 0.05, &polygons[2]), NULL);
    check_ok(sample_tangle(300, 3, &polygons[3]), NULL);
    for (int i = 0; i < MESHES; i++) meshes[i] = test_mesh(&polygons[i]);
    workspace = gd_workspace_create();
    return workspace ? 0 : -1;
}

static int close_all(void **state)
{
    (void)state;
    gd_workspace_destroy(workspace);
    for (int i = 0; i < MESHES; i++) {
        gd_mesh_release(meshes[i]);
        gd_polygons_free(&polygons[i]);
    }
    return 0;
}

/* Returns the field's image with the build time set to 0. */
static char *image_of(const struct gd_field *field, size_t *size)
{
    *size = gd_field_image_size(field);
    char *image = malloc(*size);
    assert_non_null(image);
    gd_field_write_image(field, image);
    const struct gd_field_statistics *statistics = gd_field_statistics(field);
    /* the bytes of all statistics, because those of the time alone may also stand elsewhere */
    char *at = memmem(image, *size, statistics, sizeof *statistics);
    assert_non_null(at);
    memset(at + offsetof(struct gd_field_statistics, build_ns), 0, sizeof statistics->build_ns);
    return image;
}

static void check_same_field(const struct gd_mesh *mesh, const struct gd_field_request *request)
{
    struct gd_control control = {.workspace = workspace};
    struct gd_field *fresh, *again;
    size_t size, size_again;
    check_ok(gd_field_build(mesh, request, NULL, &fresh, NULL), NULL);
    check_ok(gd_field_build(mesh, request, &control, &again, NULL), NULL);
    char *image = image_of(fresh, &size), *image_again = image_of(again, &size_again);
    assert_int_equal(size, size_again);
    assert_memory_equal(image, image_again, size);
    assert_int_equal(gd_field_memsize(fresh), gd_field_memsize(again));
    free(image);
    free(image_again);
    gd_field_release(fresh);
    gd_field_release(again);
}

static bool stop_at_once(void *user, double fraction)
{
    (void)user, (void)fraction;
    return false;
}

static void check_refusal(const struct gd_mesh *mesh, const struct gd_field_request *request,
                          struct gd_control control, enum gd_status expected)
{
    struct gd_field *field = NULL;
    control.workspace = workspace;
    assert_int_equal(gd_field_build(mesh, request, &control, &field, NULL), expected);
    assert_null(field);
}

/* Computes fields and pairs on meshes of several sizes in random order. Some fields end at a radius
 * or at a target, and some calls are cancelled. Each result equals the result with a fresh
 * workspace. */
static void calls_are_independent(void **state)
{
    (void)state;
    struct rng rng = {17};
    for (int round = 0; round < ROUNDS; round++) {
        uint32_t m = rng_below(&rng, MESHES);
        const struct gd_mesh *mesh = meshes[m];
        struct gd_seed seed = {.point = test_point(mesh, test_random_place(&polygons[m], &rng))};
        struct gd_point target = test_point(mesh, test_random_place(&polygons[m], &rng));
        double edge = gd_mesh_summary(mesh)->edge_length.mean;
        struct gd_field_request requests[3] = {
            {.seeds = &seed, .seed_count = 1},
            {.seeds = &seed, .seed_count = 1, .radius = 3 * edge},
            {.seeds = &seed, .seed_count = 1, .target = &target}};
        check_same_field(mesh, &requests[round % 3]);
        struct gd_pair_answer fresh = {0}, again = {0};
        struct gd_control control = {.workspace = workspace};
        check_ok(gd_pair_solve(mesh, &(struct gd_pair_request){.from = &seed.point, .to = &target},
                               NULL, &fresh, NULL),
                 NULL);
        check_ok(gd_pair_solve(mesh, &(struct gd_pair_request){.from = &seed.point, .to = &target},
                               &control, &again, NULL),
                 NULL);
        assert_true(fresh.distance == again.distance);
        gd_pair_answer_free(&fresh);
        gd_pair_answer_free(&again);
        if (round % 4 == 1)
            check_refusal(mesh, &requests[0], (struct gd_control){.progress = stop_at_once},
                          GD_CANCELLED);
        if (round % 4 == 2)
            check_refusal(mesh, &requests[0], (struct gd_control){.deadline_ns = 1}, GD_DEADLINE);
        if (round % 7 == 3) gd_workspace_trim(workspace);
    }
}

/* A refusal before anything was allocated leaves an empty and usable workspace. */
static void an_empty_workspace_survives_refusal(void **state)
{
    (void)state;
    struct gd_seed seed = {.point = test_point(meshes[0], (struct test_place){0, {1, 0, 0}})};
    struct gd_field_request request = {.seeds = &seed, .seed_count = 1};
    gd_workspace_trim(workspace);
    check_refusal(meshes[0], &request, (struct gd_control){.budget_bytes = 1000}, GD_BUDGET);
    check_same_field(meshes[0], &request);
}

/* The budget of one call does not affect the next. */
static void each_call_has_its_own_budget(void **state)
{
    (void)state;
    struct gd_seed seed = {.point = test_point(meshes[0], (struct test_place){0, {1, 0, 0}})};
    struct gd_field_request request = {.seeds = &seed, .seed_count = 1};
    struct gd_pair_answer answer;
    struct gd_point far =
        test_point(meshes[0], (struct test_place){polygons[0].polygon_count - 1, {0, 1, 0}});
    struct gd_control free_of_it = {.workspace = workspace};
    check_ok(gd_pair_solve(meshes[0], &(struct gd_pair_request){.from = &seed.point, .to = &far},
                           &free_of_it, &answer, NULL),
             NULL);
    gd_pair_answer_free(&answer);
    size_t budget = 4096;
    struct gd_field *field = NULL;
    while (gd_field_build(meshes[0], &request, &(struct gd_control){.budget_bytes = budget}, &field,
                          NULL) == GD_BUDGET)
        budget += budget / 8;
    gd_field_release(field);
    check_refusal(meshes[0], &request, (struct gd_control){.budget_bytes = budget / 2}, GD_BUDGET);
    check_same_field(meshes[0], &request);
}

static void reports_its_size(void **state)
{
    (void)state;
    struct gd_seed seed = {.point = test_point(meshes[0], (struct test_place){0, {1, 0, 0}})};
    gd_workspace_trim(workspace);
    size_t empty = gd_workspace_bytes(workspace);
    check_same_field(meshes[0], &(struct gd_field_request){.seeds = &seed, .seed_count = 1});
    assert_true(gd_workspace_bytes(workspace) >
                empty + gd_mesh_summary(meshes[0])->vertices * sizeof(double));
    gd_workspace_trim(workspace);
    assert_int_equal(gd_workspace_bytes(workspace), empty);
    gd_workspace_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(calls_are_independent),
        cmocka_unit_test(an_empty_workspace_survives_refusal),
        cmocka_unit_test(each_call_has_its_own_budget),
        cmocka_unit_test(reports_its_size),
    };
    return cmocka_run_group_tests(tests, open_all, close_all);
}
