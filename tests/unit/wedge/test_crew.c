#include "wedge/crew.h"

#include <pthread.h>

#include "gd/field.h"
#include "field/layout.h"
#include "tests/samples/samples.h"
#include "tests/support/threads.h"
#include "tests/support/test.h"

enum { ROUNDS = 20000, JOBS = 7 };

struct tally {
    struct gd__crew crew;
    uint32_t done[JOBS], by_helpers;
};

static void work(void *user, uint32_t job, uint32_t member)
{
    struct tally *tally = user;
    tally->done[job]++;
    if (member) __atomic_fetch_add(&tally->by_helpers, 1, __ATOMIC_RELAXED);
}

/* Rounds of all sizes, the counts of the one before having to be there in the next. */
static void lead(void *user)
{
    struct tally *tally = user;
    uint32_t expected[JOBS] = {0};
    for (uint32_t round = 0; round < ROUNDS; round++) {
        uint32_t count = 1 + round % JOBS;
        gd__crew_round(&tally->crew, count);
        for (uint32_t i = 0; i < count; i++) expected[i]++;
        assert_memory_equal(tally->done, expected, sizeof expected);
    }
}

static void run(const struct gd_executor *executor, uint32_t *by_helpers)
{
    struct tally tally = {.crew = {.lead = lead, .work = work}};
    tally.crew.user = &tally;
    gd__crew_run(&tally.crew, executor);
    *by_helpers = tally.by_helpers;
}

/* Tasks one after the other, the last one first. */
static void backwards(void *user, void (*task)(void *context, uint32_t index), void *context, uint32_t count)
{
    (void)user;
    while (count--) task(context, count);
}

static void every_job_is_done_once_a_round(void **state)
{
    (void)state;
    uint32_t by_helpers;
    struct gd_executor threads = test_threads(3), sequence = {.width = 4, .run = backwards};
    run(NULL, &by_helpers);
    assert_int_equal(by_helpers, 0);
    run(&sequence, &by_helpers);
    assert_int_equal(by_helpers, 0);
    run(&threads, &by_helpers);
    print_message("# of %d rounds helpers did %u jobs\n", ROUNDS, by_helpers);
}

/* The field is the same to the last bit on one thread and on several, every time. */
static void threads_change_nothing(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_terrain(48, 0.4, 7, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_seed seed = {0};
    check_ok(gd_point_at_vertex(mesh, (struct gd_vertex){11}, &seed.point, NULL), NULL);
    struct gd_field_request request = {.seeds = &seed, .seed_count = 1};
    struct gd_field *alone, *together;
    check_ok(gd_field_build(mesh, &request, NULL, NULL, &alone, NULL), NULL);
    for (uint32_t i = 0; i < 12; i++) {
        struct gd_executor threads = test_threads(2 + i % 3);
        check_ok(gd_field_build(mesh, &request, NULL, &threads, &together, NULL), NULL);
        assert_int_equal(alone->wedge_bytes, together->wedge_bytes);
        assert_memory_equal(alone->wedges, together->wedges, alone->wedge_bytes);
        assert_memory_equal(alone->distance, together->distance, mesh->vertex_count * sizeof(double));
        gd_field_release(together);
    }
    gd_field_release(alone);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_job_is_done_once_a_round),
                                       cmocka_unit_test(threads_change_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
