/* Compares pruned searches with whole fields by the distance and path of pairs, with and without
 * landmarks. GD_PAIRS: total number of pairs (2,200). */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>

#include "gd/query.h"
#include "gd/workspace.h"
#include "tests/samples/random.h"
#include "tests/samples/transform.h"
#include "tests/samples/samples.h"

#define AGREEMENT     1e-12
#define PAIRS_A_FIELD 20

struct trial {
    const struct gd_mesh *mesh;
    const struct gd_polygons *polygons;
    struct gd_landmarks *landmarks;
    struct gd_control control;
    struct rng *rng;
    double worst;
    uint32_t pairs, unreachable;
};

/* Searches the distance only, and then the path. */
static void compare_one(struct trial *trial, struct gd_pair_request request, double expected)
{
    struct gd_detail detail = {0};
    struct gd_pair_answer answer = {0};
    check_ok(gd_pair_solve(trial->mesh, &request, &trial->control, &answer, &detail), &detail);
    trial->worst = fmax(trial->worst, check_close(answer.distance, expected, AGREEMENT));
    request.output = GD_PAIR_PATH;
    check_ok(gd_pair_solve(trial->mesh, &request, &trial->control, &answer, &detail), &detail);
    trial->worst = fmax(trial->worst, check_close(answer.distance, expected, AGREEMENT));
    if (isfinite(expected)) {
        check_close(answer.path.length, expected, 1e-9);
        assert_true(gd_point_equal(&answer.path.points[0], request.from));
        assert_true(gd_point_equal(&answer.path.points[answer.path.count - 1], request.to));
    }
    gd_pair_answer_free(&answer);
}

static void compare(struct trial *trial, const struct gd_point *from, const struct gd_point *to,
                    double expected)
{
    for (int k = 0; k < 4; k++) /* with and without landmarks, in both directions */
        compare_one(trial,
                    (struct gd_pair_request){.from = k & 2 ? to : from,
                                             .to = k & 2 ? from : to,
                                             .landmarks = k & 1 ? trial->landmarks : NULL},
                    expected);
    trial->unreachable += isinf(expected);
    trial->pairs++;
}

static void compare_with_field(struct trial *trial)
{
    struct gd_seed seed = {
        .point = test_point(trial->mesh, test_random_place(trial->polygons, trial->rng))};
    struct gd_field_request request = {.seeds = &seed, .seed_count = 1};
    struct gd_field *field;
    check_ok(gd_field_build(trial->mesh, &request, &trial->control, &field, NULL), NULL);
    for (int i = 0; i < PAIRS_A_FIELD; i++) {
        struct gd_point to =
            test_point(trial->mesh, test_random_place(trial->polygons, trial->rng));
        double expected;
        check_ok(gd_field_distance(field, &to, &expected), NULL);
        compare(trial, &seed.point, &to, expected);
    }
    gd_field_release(field);
}

static void check_mesh(const char *name, struct gd_polygons *polygons, uint32_t pairs)
{
    struct rng rng = {77};
    struct trial trial = {.mesh = test_mesh(polygons), .polygons = polygons, .rng = &rng};
    trial.control.workspace = gd_workspace_create();
    check_ok(gd_landmarks_build(trial.mesh, 5, &trial.control, &trial.landmarks), NULL);
    while (trial.pairs < pairs) compare_with_field(&trial);
    print_message("# %s: %u pairs, %u of them unreachable, worst difference %.2g\n", name,
                  trial.pairs, trial.unreachable, trial.worst);
    gd_landmarks_release(trial.landmarks);
    gd_workspace_destroy(trial.control.workspace);
    gd_mesh_release((struct gd_mesh *)trial.mesh);
    gd_polygons_free(polygons);
}

static void pruned_equals_unpruned(void **state)
{
    (void)state;
    const char *wish = getenv("GD_PAIRS");
    uint32_t pairs = (wish ? (uint32_t)strtoul(wish, NULL, 10) : 2200) / 11;
    struct gd_polygons polygons, part;
    check_ok(sample_icosphere(3, 1, &polygons), NULL);
    check_mesh("icosphere", &polygons, pairs);
    check_ok(sample_torus(40, 24, 1, 0.4, &polygons), NULL);
    check_mesh("torus", &polygons, pairs);
    check_ok(sample_terrain(24, 0.4, 3, &polygons), NULL);
    check_mesh("terrain", &polygons, pairs);
    check_ok(sample_terrain(16, 20, 3, &polygons), NULL);
    check_mesh("steep terrain", &polygons, pairs);
    check_ok(sample_genus2(5, 0.05, &polygons), NULL);
    check_mesh("genus2", &polygons, pairs);
    check_ok(sample_grid(20, 15, 1, 1, &polygons), NULL);
    check_mesh("grid", &polygons, pairs);
    check_ok(sample_box((const double[3]){1, 2, 3}, (const uint32_t[3]){4, 4, 4}, &polygons), NULL);
    check_mesh("box", &polygons, pairs);
    check_ok(sample_tangle(300, 9, &polygons), NULL);
    check_mesh("tangle", &polygons, pairs);
    check_ok(sample_cylinder(1, 30, 12, 3, &polygons), NULL);
    check_mesh("tall prism", &polygons, pairs);
    check_ok(sample_saddle(1, 0.5, 16, 6, &polygons), NULL);
    check_ok(sample_tangle(60, 2, &part), NULL);
    for (uint32_t i = 0; i < part.position_count; i++)
        for (int axis = 0; axis < 3; axis++)
            part.positions[i][axis] = 1e7 + 1e-3 * part.positions[i][axis];
    check_ok(sample_append(&polygons, &part), NULL);
    gd_polygons_free(&part);
    check_mesh("two components, one tiny and far away", &polygons, pairs);
    check_ok(sample_icosphere(1, 1, &polygons), NULL);
    check_ok(sample_terrain(8, 0.5, 3, &part), NULL);
    for (uint32_t i = 0; i < part.position_count; i++)
        for (int axis = 0; axis < 3; axis++) part.positions[i][axis] *= 1e-42;
    for (uint32_t i = 0; i < polygons.position_count; i++) polygons.positions[i][0] += 3;
    check_ok(sample_append(&polygons, &part), NULL);
    gd_polygons_free(&part);
    check_mesh("two components, one smaller than floats tell", &polygons, pairs);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(pruned_equals_unpruned)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
