#include "tests/unit/server/support.h"

#include "server/base/heap.h"

#define NODES 500

static uint32_t random_state;

static uint32_t next_random(void)
{
    random_state = random_state * 1664525 + 1013904223;
    return random_state >> 8;
}

static void check(const struct server_heap *heap)
{
    for (size_t i = 0; i < heap->size; i++) {
        assert_int_equal(heap->nodes[i]->index, i);
        assert_true(i == 0 || heap->nodes[(i - 1) / 2]->key <= heap->nodes[i]->key);
    }
}

static void fill(struct server_heap *heap, struct server_heap_node nodes[NODES])
{
    for (int i = 0; i < NODES; i++) {
        nodes[i].key = next_random() % 100;
        assert_true(server_heap_reserve(heap));
        server_heap_insert(heap, &nodes[i]);
    }
    check(heap);
}

static void gives_the_lowest_first(void **state)
{
    (void)state;
    struct server_heap heap = {0};
    struct server_heap_node nodes[NODES];
    fill(&heap, nodes);
    for (double last = 0; heap.size;) {
        struct server_heap_node *lowest = heap.nodes[0];
        assert_true(lowest->key >= last);
        last = lowest->key;
        server_heap_remove(&heap, lowest);
        check(&heap);
    }
    server_heap_free(&heap);
}

static void keeps_order_when_any_node_goes_or_rises(void **state)
{
    (void)state;
    struct server_heap heap = {0};
    struct server_heap_node nodes[NODES];
    fill(&heap, nodes);
    while (heap.size) {
        struct server_heap_node *node = heap.nodes[next_random() % heap.size];
        if (next_random() % 2)
            server_heap_remove(&heap, node);
        else
            server_heap_raise(&heap, node, node->key + next_random() % 50);
        check(&heap);
    }
    server_heap_free(&heap);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gives_the_lowest_first),
        cmocka_unit_test(keeps_order_when_any_node_goes_or_rises),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
