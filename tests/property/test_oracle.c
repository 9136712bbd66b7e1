/* Compares the engine with the brute-force solver on thousands of small random surfaces. They have
 * boundaries, saddles, slivers, components of very different size, inconsistent orientations,
 * unreferenced vertices, and several sources. */
#include "tests/oracle/unfold.h"

#include <math.h>
#include <stdlib.h>

#include "gd/query.h"
#include "tests/samples/samples.h"
#include "tests/samples/transform.h"
#include "tests/support/test.h"

static const double promise = 1e-9;

enum { MAX_SOURCES = 2, TARGETS = 5 };

/* A random test case, which has a mesh, sources and targets. */
struct question {
    struct gd_polygons polygons;
    uint32_t source_count;
    struct test_place sources[MAX_SOURCES], targets[TARGETS];
    double offsets[MAX_SOURCES];
};

/* Returns a random mesh. If `squeeze` is less than 1, one axis is scaled by a random factor between
 * `squeeze` and 1. */
static struct gd_polygons random_polygons(struct rng *rng, double squeeze)
{
    struct gd_polygons polygons, small;
    assert_int_equal(sample_tangle(4 + rng_below(rng, 45), rng_next(rng), &polygons), GD_OK);
    if (rng_below(rng, 4) == 0) {
        assert_int_equal(sample_tangle(4 + rng_below(rng, 15), rng_next(rng), &small), GD_OK);
        sample_scale(&small, 1e-6, 1e-6, 1e-6);
        assert_int_equal(sample_append(&polygons, &small), GD_OK);
        gd_polygons_free(&small);
    }
    if (squeeze < 1) {
        double factor[3] = {1, 1, 1};
        factor[rng_below(rng, 3)] = pow(squeeze, rng_unit(rng));
        sample_scale(&polygons, factor[0], factor[1], factor[2]);
    }
    if (rng_below(rng, 3) == 0) sample_flip_faces(&polygons, 0.4, rng_next(rng));
    if (rng_below(rng, 3) == 0)
        assert_int_equal(sample_renumber(&polygons, rng_next(rng), NULL, NULL), GD_OK);
    return polygons;
}

static struct question random_question(uint64_t seed, double squeeze)
{
    struct rng rng = {seed};
    struct question question = {.polygons = random_polygons(&rng, squeeze),
                                .source_count = 1 + (rng_below(&rng, 4) == 0)};
    for (uint32_t i = 0; i < question.source_count; i++) {
        question.sources[i] = test_random_place(&question.polygons, &rng);
        question.offsets[i] = question.source_count > 1 ? rng_between(&rng, 0, 1) : 0;
    }
    for (int i = 0; i < TARGETS; i++)
        question.targets[i] = test_random_place(&question.polygons, &rng);
    if (rng_below(&rng, 4) == 0) question.targets[0].face = question.sources[0].face;
    return question;
}

/* Returns the exact distances of all vertices, followed by the distances of the targets. The caller
 * frees them. */
static double *exact_answers(const struct question *question)
{
    const struct gd_polygons *polygons = &question->polygons;
    uint32_t insertions = question->source_count + TARGETS, target[TARGETS];
    struct unfold_mesh *mesh =
        unfold_create((const double(*)[3])polygons->positions, polygons->position_count,
                      polygons->corners, polygons->polygon_count, insertions);
    long double *distance = calloc(polygons->position_count + insertions, sizeof *distance);
    double *answers = calloc(polygons->position_count + TARGETS, sizeof *answers);
    assert_true(mesh && distance && answers);
    uint32_t source[MAX_SOURCES];
    for (uint32_t i = 0; i < question->source_count; i++)
        source[i] = unfold_insert(mesh, question->sources[i].face, question->sources[i].weight);
    for (int i = 0; i < TARGETS; i++)
        target[i] = unfold_insert(mesh, question->targets[i].face, question->targets[i].weight);
    for (uint32_t i = 0; i < polygons->position_count + TARGETS; i++) answers[i] = INFINITY;
    for (uint32_t s = 0; s < question->source_count; s++) {
        unfold_distances(mesh, source[s], distance);
        for (uint32_t i = 0; i < polygons->position_count + TARGETS; i++) {
            uint32_t vertex =
                i < polygons->position_count ? i : target[i - polygons->position_count];
            answers[i] = fmin(answers[i], (double)(question->offsets[s] + distance[vertex]));
        }
    }
    free(distance);
    unfold_free(mesh);
    return answers;
}

static struct gd_field *build_field(const struct gd_mesh *mesh, const struct question *question)
{
    struct gd_seed seeds[MAX_SOURCES];
    struct gd_field_request request = {.seeds = seeds, .seed_count = question->source_count};
    for (uint32_t i = 0; i < question->source_count; i++)
        seeds[i] = (struct gd_seed){.point = test_point(mesh, question->sources[i]),
                                    .offset = question->offsets[i]};
    struct gd_field *field = NULL;
    struct gd_detail detail = {0};
    check_ok(gd_field_build(mesh, &request, NULL, &field, &detail), &detail);
    return field;
}

/* Checks that the path's length plus its source's offset is the distance. Returns the relative
 * error. */
static double check_path(const struct gd_field *field, const struct question *question,
                         struct gd_point target, double expected)
{
    struct gd_path path = {0};
    enum gd_status status = gd_field_path(field, &target, &path);
    if (isinf(expected)) {
        assert_int_equal(status, GD_NOT_ON_SURFACE);
        return 0;
    }
    check_ok(status, NULL);
    double best = INFINITY;
    for (uint32_t i = 0; i < question->source_count; i++)
        if (fabs(path.length + question->offsets[i] - expected) < fabs(best - expected))
            best = path.length + question->offsets[i];
    gd_path_free(&path);
    return check_close(best, expected, promise);
}

static double check_pair(const struct gd_mesh *mesh, const struct question *question,
                         struct gd_point target, double expected)
{
    struct gd_point source = test_point(mesh, question->sources[0]);
    struct gd_pair_answer answer = {0};
    struct gd_detail detail = {0};
    check_ok(gd_pair_solve(mesh, &(struct gd_pair_request){.from = &source, .to = &target}, NULL,
                           &answer, &detail),
             &detail);
    double error = check_close(answer.distance, expected, promise);
    gd_pair_answer_free(&answer);
    return error;
}

static double compare(const struct gd_mesh *mesh, const struct question *question)
{
    const struct gd_polygons *polygons = &question->polygons;
    struct gd_field *field = build_field(mesh, question);
    double *expected = exact_answers(question),
           *values = calloc(polygons->position_count, sizeof *values), worst = 0;
    assert_non_null(values);
    gd_field_vertex_distances(field, values);
    for (uint32_t v = 0; v < polygons->position_count; v++)
        if (!isnan(values[v])) worst = fmax(worst, check_close(values[v], expected[v], promise));
    for (int i = 0; i < TARGETS; i++) {
        struct gd_point target = test_point(mesh, question->targets[i]);
        double distance = NAN, exact = expected[polygons->position_count + (uint32_t)i];
        check_ok(gd_field_distance(field, &target, &distance), NULL);
        worst = fmax(worst, check_close(distance, exact, promise));
        worst = fmax(worst, check_path(field, question, target, exact));
        if (question->source_count == 1)
            worst = fmax(worst, check_pair(mesh, question, target, exact));
    }
    free(values);
    free(expected);
    gd_field_release(field);
    return worst;
}

static double compare_all(uint64_t seeds, double squeeze)
{
    double worst = 0;
    for (uint64_t seed = 0; seed < seeds; seed++) {
        struct question question = random_question(seed, squeeze);
        struct gd_mesh *mesh = test_mesh(&question.polygons);
        worst = fmax(worst, compare(mesh, &question));
        gd_mesh_release(mesh);
        gd_polygons_free(&question.polygons);
    }
    return worst;
}

static void test_random_surfaces(void **state)
{
    (void)state;
    print_message("# 6000 random surfaces: worst error %.2g\n", compare_all(6000, 1));
}

/* Scales one axis by factors down to 1e-5, which makes needles and caps almost without area. */
static void test_slivers(void **state)
{
    (void)state;
    print_message("# 3000 random surfaces of slivers: worst error %.2g\n", compare_all(3000, 1e-5));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_surfaces),
        cmocka_unit_test(test_slivers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
