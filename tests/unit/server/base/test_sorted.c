#include "tests/unit/server/support.h"

#include <stdio.h>

#include "server/base/sorted.h"

static int compare(const void *item, const void *key)
{
    return strcmp(item, key);
}

static void add(struct server_sorted *sorted, const char *item)
{
    assert_true(server_sorted_reserve(sorted));
    server_sorted_insert(sorted, server_sorted_index(sorted, item), (void *)item);
}

static void keeps_items_in_order(void **state)
{
    (void)state;
    static const char *const names[] = {"m", "b", "z", "bb", "-", "B"};
    static const char *const in_order[] = {"-", "B", "b", "bb", "m", "z"};
    struct server_sorted sorted = {.compare = compare};
    assert_null(server_sorted_find(&sorted, "b"));
    for (size_t i = 0; i < COUNT(names); i++) add(&sorted, names[i]);
    for (uint32_t i = 0; i < sorted.count; i++) {
        assert_string_equal(sorted.items[i], in_order[i]);
        assert_int_equal(server_sorted_index(&sorted, in_order[i]), i);
        assert_int_equal(server_sorted_after(&sorted, in_order[i]), i + 1);
    }
    assert_int_equal(server_sorted_index(&sorted, "c"), 4);
    assert_int_equal(server_sorted_after(&sorted, "c"), 4);
    assert_null(server_sorted_find(&sorted, "c"));
    assert_string_equal(server_sorted_remove(&sorted, 2), "b");
    assert_null(server_sorted_find(&sorted, "b"));
    assert_string_equal(server_sorted_find(&sorted, "bb"), "bb");
    free(sorted.items);
}

static void grows(void **state)
{
    (void)state;
    static char texts[100][4];
    struct server_sorted sorted = {.compare = compare};
    for (int i = 0; i < 100; i++) {
        snprintf(texts[i], sizeof texts[i], "%02d", (i * 37) % 100);
        add(&sorted, texts[i]);
    }
    for (uint32_t i = 0; i < 100; i++) assert_int_equal(atoi(sorted.items[i]), i);
    free(sorted.items);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keeps_items_in_order),
        cmocka_unit_test(grows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
