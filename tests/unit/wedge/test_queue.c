#include "tests/support/test.h"

#include "gd/polygons.h"
#include "wedge/queue.h"

static struct gd__queue queue;

static int open_queue(void **state)
{
    (void)state;
    return gd__queue_init(&queue, 100, 0.5) != GD_OK;
}

static int close_queue(void **state)
{
    (void)state;
    gd__queue_destroy(&queue);
    return 0;
}

static void pops_in_order_of_buckets(void **state)
{
    (void)state;
    gd__queue_push(&queue, 7, 3.2);
    gd__queue_push(&queue, 3, 0.1);
    gd__queue_push(&queue, 5, 1.7);
    gd__queue_push(&queue, 4, 0.4); /* the bucket of node 3, behind it */
    uint32_t order[] = {3, 4, 5, 7, GD_NONE};
    for (int i = 0; i < 5; i++) assert_int_equal(gd__queue_pop(&queue), order[i]);
}

static void decreases_keys_only(void **state)
{
    (void)state;
    gd__queue_push(&queue, 1, 5);
    gd__queue_push(&queue, 2, 3);
    gd__queue_push(&queue, 1, 1); /* forward */
    gd__queue_push(&queue, 2, 9); /* stays */
    assert_int_equal(queue.size, 2);
    assert_int_equal(gd__queue_pop(&queue), 1);
    assert_int_equal(gd__queue_pop(&queue), 2);
    assert_int_equal(gd__queue_pop(&queue), GD_NONE);
}

/* Keys beyond the ring and below the current bucket are legal: they only lose their exact order. */
static void takes_any_key(void **state)
{
    (void)state;
    gd__queue_push(&queue, 1, 1e300);
    gd__queue_push(&queue, 2, 2);
    assert_int_equal(gd__queue_pop(&queue), 2);
    gd__queue_push(&queue, 3, 0); /* the past */
    assert_int_equal(gd__queue_pop(&queue), 3);
    assert_int_equal(gd__queue_pop(&queue), 1);
}

static void keeps_every_node_once(void **state)
{
    (void)state;
    struct rng rng = {3};
    bool waiting[100] = {false};
    double clock = 0;
    for (int i = 0; i < 100000; i++) {
        uint32_t node = rng_below(&rng, 100);
        if (rng_unit(&rng) < 0.6) {
            gd__queue_push(&queue, node, clock + rng_between(&rng, 0, 3000));
            waiting[node] = true;
        } else if ((node = gd__queue_pop(&queue)) != GD_NONE) {
            assert_true(waiting[node]);
            waiting[node] = false;
            clock = (double)queue.current * 0.5;
        }
    }
    uint32_t left = 0;
    for (int i = 0; i < 100; i++) left += waiting[i];
    assert_int_equal(queue.size, left);
    while (left--) assert_int_not_equal(gd__queue_pop(&queue), GD_NONE);
    assert_int_equal(gd__queue_pop(&queue), GD_NONE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(pops_in_order_of_buckets, open_queue, close_queue),
        cmocka_unit_test_setup_teardown(decreases_keys_only, open_queue, close_queue),
        cmocka_unit_test_setup_teardown(takes_any_key, open_queue, close_queue),
        cmocka_unit_test_setup_teardown(keeps_every_node_once, open_queue, close_queue),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
