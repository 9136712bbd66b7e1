#include "tests/support/test.h"

#include <string.h>

#include "gd/polygons.h"
#include "wavefront/queue.h"

enum { NODES = 100 };

static struct gd__queue *queue;
static uint32_t waiting[NODES]; /* the bucket of each node */

static int open_queue(void **state)
{
    (void)state;
    memset(waiting, 0xff, sizeof waiting);
    queue = gd__queue_create();
    if (!queue) return -1;
    gd__queue_set_width(queue, 0.5);
    return 0;
}

static int close_queue(void **state)
{
    (void)state;
    gd__queue_destroy(queue);
    return 0;
}

static void push(uint32_t node, double key)
{
    gd__queue_push(queue, node, key, &waiting[node]);
}

/* Returns the first waiting node. Skips stale entries, as the queue's owners do. */
static uint32_t pop(void)
{
    for (;;) {
        uint32_t node = gd__queue_pop(queue);
        if (node == GD_NONE) return GD_NONE;
        if (waiting[node] != queue->current) continue;
        waiting[node] = GD_NONE;
        return node;
    }
}

static void pops_in_order_of_buckets(void **state)
{
    (void)state;
    push(7, 3.2);
    push(3, 0.1);
    push(5, 1.7);
    push(4, 0.4); /* same bucket as node 3, after it */
    static const uint32_t order[] = {3, 4, 5, 7, GD_NONE};
    for (int i = 0; i < 5; i++) assert_int_equal(pop(), order[i]);
}

static void first_in_first_out_within_a_bucket(void **state)
{
    (void)state;
    /* all keys are in one bucket, in any order */
    for (uint32_t i = 0; i < NODES; i++) push(i, 7 + 0.4 * (i % 2));
    for (uint32_t i = 0; i < NODES; i++) assert_int_equal(pop(), i);
}

/* A node that moves to an earlier bucket leaves a stale entry. A push to a later bucket is
 * ignored. */
static void deletes_lazily(void **state)
{
    (void)state;
    push(1, 5);
    push(2, 3);
    push(1, 1); /* moves to an earlier bucket */
    push(2, 9); /* stays */
    assert_int_equal(queue->size, 3);
    assert_int_equal(pop(), 1);
    assert_int_equal(pop(), 2);
    assert_int_equal(queue->size, 1);
    assert_int_equal(pop(), GD_NONE); /* skips the stale entry of node 1 */
    assert_int_equal(queue->size, 0);
}

/* If a node returns to the bucket of its stale entry, this bucket has two entries of the node, but
 * the node is popped once. */
static void a_stale_entry_does_not_pop_twice(void **state)
{
    (void)state;
    push(1, 5);
    push(1, 1);
    assert_int_equal(pop(), 1);
    push(1, 5);
    assert_int_equal(queue->size, 2);
    assert_int_equal(pop(), 1);
    assert_int_equal(pop(), GD_NONE);
}

/* Keys beyond the ring or below the current bucket are allowed. Only their order is not exact. */
static void takes_any_key(void **state)
{
    (void)state;
    push(1, 1e300);
    push(2, 2);
    assert_int_equal(pop(), 2);
    push(3, 0); /* the bucket of this key has passed */
    assert_int_equal(pop(), 3);
    assert_int_equal(pop(), 1);
    for (int lap = 0; lap < 3; lap++) { /* the largest key is always beyond the ring */
        push(4, 1e300);
        push(5, 0);
        assert_int_equal(pop(), 5);
        assert_int_equal(pop(), 4);
    }
}

/* The size of a bucket that is filled while being emptied depends on its waiting entries only. */
static void a_bucket_filled_while_emptied_stays_small(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < NODES; i++) push(i, 1);
    for (uint32_t i = 0; i < 1000000; i++) {
        uint32_t node = pop();
        assert_int_equal(node, i % NODES);
        push(node, 0);
    }
    for (uint32_t i = 0; i < GD__QUEUE_BUCKETS; i++) assert_true(queue->bucket[i].capacity <= 1024);
}

static void peeks_at_what_comes_next(void **state)
{
    (void)state;
    push(0, 0.1);
    push(1, 0.2);
    push(2, 0.3);
    push(3, 0.7); /* the next bucket */
    push(4, 0.8);
    push(5, 2.1); /* the entry is too far ahead for gd__queue_peek */
    assert_int_equal(pop(), 0);
    for (uint32_t places = 1; places < 5; places++)
        assert_int_equal(gd__queue_peek(queue, places), places);
    assert_int_equal(gd__queue_peek(queue, 5), GD_NONE);
    assert_int_equal(gd__queue_peek(queue, 1000), GD_NONE);
}

/* Compares with a set: each pushed node is popped once, never before a node of an earlier
 * bucket. */
static void keeps_every_node_once(void **state)
{
    (void)state;
    struct rng rng = {3};
    bool in[NODES] = {false};
    double clock = 0;
    for (int i = 0; i < 300000; i++) {
        uint32_t node = rng_below(&rng, NODES);
        if (rng_unit(&rng) < 0.6) {
            push(node, clock + rng_between(&rng, 0, i % 3 ? 30 : 3000));
            in[node] = true;
        } else if ((node = pop()) != GD_NONE) {
            assert_true(in[node]);
            in[node] = false;
            for (uint32_t other = 0; other < NODES; other++)
                assert_true(waiting[other] >= queue->current);
            clock = queue->current * 0.5;
        }
    }
    uint32_t left = 0;
    for (int i = 0; i < NODES; i++) left += in[i];
    while (left--) assert_int_not_equal(pop(), GD_NONE);
    assert_int_equal(pop(), GD_NONE);
    assert_false(queue->out_of_memory);
}

/* A cleared queue is like a new one and may get another width. */
static void clears(void **state)
{
    (void)state;
    for (int round = 0; round < 3; round++) {
        for (uint32_t i = 0; i < NODES; i++) push(i, i * i);
        for (int i = 0; i < NODES / 2; i++) pop();
        gd__queue_clear(queue);
        memset(waiting, 0xff, sizeof waiting);
        assert_int_equal(queue->size, 0);
        assert_int_equal(pop(), GD_NONE);
        gd__queue_set_width(queue, 100);
        push(1, 99);
        push(2, 1);
        push(3, 100);
        for (uint32_t node = 1; node <= 3; node++) assert_int_equal(pop(), node);
        gd__queue_clear(queue);
        gd__queue_set_width(queue, 0.5);
    }
    gd__queue_destroy(NULL);
}

#define WITH_QUEUE(test) cmocka_unit_test_setup_teardown(test, open_queue, close_queue)

int main(void)
{
    const struct CMUnitTest tests[] = {
        WITH_QUEUE(pops_in_order_of_buckets),
        WITH_QUEUE(first_in_first_out_within_a_bucket),
        WITH_QUEUE(deletes_lazily),
        WITH_QUEUE(a_stale_entry_does_not_pop_twice),
        WITH_QUEUE(takes_any_key),
        WITH_QUEUE(a_bucket_filled_while_emptied_stays_small),
        WITH_QUEUE(peeks_at_what_comes_next),
        WITH_QUEUE(keeps_every_node_once),
        WITH_QUEUE(clears),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
