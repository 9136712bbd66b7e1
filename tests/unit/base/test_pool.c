#include "tests/support/test.h"

#include <string.h>

#include "base/pool.h"

/* A pool allocates its blocks from few chunks. After a restart, the same number of blocks fits into
 * one chunk. */

#define ITEM 64

/* Returns the number of chunks. The first bytes of each chunk point to the next chunk. */
static uint32_t chunks_of(const struct gd__pool *pool)
{
    uint32_t count = 0;
    for (const void *chunk = pool->chunks; chunk; memcpy(&chunk, chunk, sizeof chunk)) count++;
    return count;
}

/* Takes blocks, checks that consecutive blocks differ, and writes to each of them. */
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

static void a_restart_makes_one_chunk(void **state)
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

/* The size of a chunk is limited. A restart keeps one chunk of the largest size and frees the
 * others. */
static void a_restart_keeps_one_large_chunk(void **state)
{
    (void)state;
    /* the test does not write to the blocks, so their memory is only reserved */
    const size_t item = (size_t)1 << 20;
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

/* After a restart, a smaller amount of work fits into a smaller budget. */
static void little_work_fits_a_small_budget(void **state)
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
                                       cmocka_unit_test(a_restart_makes_one_chunk),
                                       cmocka_unit_test(a_restart_keeps_one_large_chunk),
                                       cmocka_unit_test(little_work_fits_a_small_budget)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
