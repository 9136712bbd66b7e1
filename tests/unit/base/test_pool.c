#include "tests/support/test.h"

#include <string.h>

#include "base/pool.h"

/* Blocks from few chunks; who does the same work again finds one chunk for all of it. */

#define ITEM 64

/* The next one stands first in each. */
static uint32_t chunks_of(const struct gd__pool *pool)
{
    uint32_t count = 0;
    for (const void *chunk = pool->chunks; chunk; memcpy(&chunk, chunk, sizeof chunk)) count++;
    return count;
}

/* All different, each may be written to. */
static void take_blocks(struct gd__pool *pool, uint32_t count)
{
    char *last = NULL;
    for (uint32_t i = 0; i < count; i++) {
        char *block = gd__pool_take(pool, 0);
        assert_non_null(block);
        assert_ptr_not_equal(block, last);
        memset(block, (int)i, ITEM);
        last = block;
    }
}

static void released_blocks_come_first(void **state)
{
    (void)state;
    struct gd__pool pool;
    gd__pool_init(&pool, ITEM, NULL);
    void *first = gd__pool_take(&pool, 0), *large = gd__pool_take(&pool, 2);
    gd__pool_release(&pool, first, 0);
    gd__pool_release(&pool, large, 2);
    assert_ptr_equal(gd__pool_take(&pool, 2), large);
    assert_ptr_equal(gd__pool_take(&pool, 0), first);
    assert_int_equal(chunks_of(&pool), 1);
    gd__pool_destroy(&pool);
}

static void the_same_again_is_one_chunk(void **state)
{
    (void)state;
    struct gd__pool pool = {0};
    char *kept = NULL;
    size_t bytes = 0;
    for (int turn = 0; turn < 4; turn++) {
        gd__pool_restart(&pool, ITEM, NULL);
        take_blocks(&pool, 10000);
        if (turn == 0) {
            assert_true(chunks_of(&pool) > 3);
            bytes = pool.bytes;
        } else {
            assert_int_equal(chunks_of(&pool), 1);
            assert_in_range(pool.bytes, 10000 * ITEM, bytes);
        }
        if (turn == 2) kept = (char *)pool.chunks;
        if (turn == 3) assert_ptr_equal(pool.chunks, kept);
    }
    gd__pool_destroy(&pool);
}

/* Chunks have a largest size: one of those is kept of several, the others are given back. */
static void of_many_large_chunks_one_is_kept(void **state)
{
    (void)state;
    const size_t item = (size_t)1 << 20; /* only asked for: untouched memory costs nothing */
    struct gd__pool pool = {0};
    gd__pool_restart(&pool, item, NULL);
    for (int i = 0; i < 250; i++) assert_non_null(gd__pool_take(&pool, 0));
    const void *newest = pool.chunks;
    size_t all = pool.bytes;
    assert_true(chunks_of(&pool) > 3);
    struct gd__budget budget = {0};
    gd__pool_restart(&pool, item, &budget);
    assert_int_equal(chunks_of(&pool), 1);
    assert_ptr_equal(pool.chunks, newest);
    assert_in_range(pool.bytes, all / 8, all / 2);
    assert_int_equal(budget.held, pool.bytes);
    assert_non_null(gd__pool_take(&pool, 0));
    assert_int_equal(chunks_of(&pool), 1);
    gd__pool_destroy(&pool);
}

/* Less is done, and less may be taken than the time before. */
static void a_small_budget_is_enough_for_little(void **state)
{
    (void)state;
    struct gd__pool pool = {0};
    gd__pool_restart(&pool, ITEM, NULL);
    take_blocks(&pool, 100000);
    struct gd_control control = {.budget_bytes = 100000};
    struct gd__budget budget = {.control = &control};
    gd__pool_restart(&pool, ITEM, &budget);
    assert_int_equal(budget.held, 0);
    take_blocks(&pool, 1000);
    assert_in_range(budget.held, 1000 * ITEM, 100000);
    assert_int_equal(budget.held, pool.bytes);
    while (gd__pool_take(&pool, 0)) continue;
    assert_int_equal(pool.status, GD_BUDGET);
    gd__pool_destroy(&pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(released_blocks_come_first),
                                       cmocka_unit_test(the_same_again_is_one_chunk),
                                       cmocka_unit_test(of_many_large_chunks_one_is_kept),
                                       cmocka_unit_test(a_small_budget_is_enough_for_little)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
