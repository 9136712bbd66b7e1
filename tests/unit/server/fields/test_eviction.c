#include "tests/unit/server/support.h"

#include <math.h>

#include "server/fields/eviction.h"

struct thing {
    struct server_evictable worth; /* first */
    bool is_there;
    uint64_t used; /* step of the trace, for LRU */
};

static void add(struct server_eviction *eviction, struct thing *thing, double cost, size_t bytes)
{
    *thing = (struct thing){.worth = {.cost = cost, .bytes = bytes, .uses = 1}, .is_there = true};
    assert_true(server_heap_reserve(&eviction->order));
    server_eviction_insert(eviction, &thing->worth);
}

static void assert_next(struct server_eviction *eviction, struct thing *thing)
{
    assert_ptr_equal(server_eviction_first(eviction), &thing->worth);
    server_eviction_evict(eviction, &thing->worth);
}

static void goes_by_cost_uses_and_bytes(void **state)
{
    (void)state;
    struct server_eviction eviction = {0};
    struct thing cheap, large, plain, used;
    add(&eviction, &used, 10, 100);
    add(&eviction, &plain, 20, 100);
    add(&eviction, &large, 20, 400);
    add(&eviction, &cheap, 2, 100);
    for (int i = 0; i < 5; i++) server_eviction_use(&eviction, &used.worth);
    assert_next(&eviction, &cheap);
    assert_next(&eviction, &large);
    assert_next(&eviction, &plain);
    assert_next(&eviction, &used);
    assert_null(server_eviction_first(&eviction));
    server_heap_free(&eviction.order);
}

static void what_was_dear_grows_old(void **state)
{
    (void)state;
    struct server_eviction eviction = {0};
    struct thing dear, others[200];
    int rounds = 0;
    add(&eviction, &dear, 1000, 10);
    for (; dear.is_there && rounds < 200; rounds++) {
        add(&eviction, &others[rounds], 10, 10);
        struct thing *first = (struct thing *)server_eviction_first(&eviction);
        server_eviction_evict(&eviction, &first->worth);
        first->is_there = false;
    }
    assert_true(rounds > 50 && rounds < 150);
    server_heap_free(&eviction.order);
}

/* --- a trace ---------------------------------------------------------------------------------- */

enum { THINGS = 400, STEPS = 40000 };

static uint32_t next_random(uint32_t *seed)
{
    return (*seed = *seed * 1664525 + 1013904223) >> 8;
}

/* Fields of meshes from 1,000 to 2 million faces: seconds to build grow faster than bytes do. */
static void make_things(struct thing *things)
{
    uint32_t seed = 1;
    for (int i = 0; i < THINGS; i++) {
        double faces = 1000 * pow(2000, next_random(&seed) / 16777216.0);
        things[i] = (struct thing){
            .worth = {.cost = 1e9 * pow(faces, 1.5) / 2e8 * (0.5 + next_random(&seed) / 16777216.0),
                      .bytes = (size_t)(faces * 300)}};
    }
}

/* What is asked for: a few often, whatever they cost; and now and then somebody goes through all of
 * them once. */
static int next_asked(uint32_t *seed, int step)
{
    if (step / THINGS % 10 == 9) return step % THINGS;
    double u = next_random(seed) / 16777216.0;
    return (int)(THINGS * u * u * u) * 37 % THINGS;
}

/* The one to go by LRU, or by the order of eviction. */
static struct thing *choose(struct thing *things, struct server_eviction *eviction)
{
    if (eviction) return (struct thing *)server_eviction_first(eviction);
    struct thing *oldest = NULL;
    for (int i = 0; i < THINGS; i++)
        if (things[i].is_there && (!oldest || things[i].used < oldest->used)) oldest = &things[i];
    return oldest;
}

/* Seconds that are spent on building when `limit` bytes can be kept. `eviction` NULL: by LRU. */
static double replay(struct server_eviction *eviction, size_t limit)
{
    struct thing things[THINGS];
    uint32_t seed = 2;
    double spent = 0;
    size_t held = 0;
    make_things(things);
    for (int step = 0; step < STEPS; step++) {
        struct thing *asked = &things[next_asked(&seed, step)];
        asked->used = (uint64_t)step + 1;
        if (asked->is_there) {
            if (eviction) server_eviction_use(eviction, &asked->worth);
            continue;
        }
        spent += asked->worth.cost / 1e9;
        if (asked->worth.bytes > limit) continue;
        while (held + asked->worth.bytes > limit) {
            struct thing *victim = choose(things, eviction);
            if (eviction) server_eviction_evict(eviction, &victim->worth);
            victim->is_there = false;
            held -= victim->worth.bytes;
        }
        asked->is_there = true;
        asked->worth.uses = 1;
        held += asked->worth.bytes;
        if (!eviction) continue;
        assert_true(server_heap_reserve(&eviction->order));
        server_eviction_insert(eviction, &asked->worth);
    }
    return spent;
}

static void a_trace_costs_less_than_by_lru(void **state)
{
    (void)state;
    /* of 31 GiB in all */
    static const size_t limits[] = {(size_t)2 << 30, (size_t)4 << 30, (size_t)8 << 30};
    for (size_t i = 0; i < COUNT(limits); i++) {
        struct server_eviction eviction = {0};
        double ours = replay(&eviction, limits[i]), lru = replay(NULL, limits[i]);
        print_message("%zu GiB: %.0f seconds recomputed, by LRU %.0f\n", limits[i] >> 30, ours,
                      lru);
        assert_true(ours < 0.95 * lru);
        server_heap_free(&eviction.order);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(goes_by_cost_uses_and_bytes),
        cmocka_unit_test(what_was_dear_grows_old),
        cmocka_unit_test(a_trace_costs_less_than_by_lru),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
