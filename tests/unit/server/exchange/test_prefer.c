#include "tests/unit/server/support.h"

#include "server/exchange/exchange.h"

static bool prefers(const char *first, const char *second)
{
    struct server_exchange *exchange = calloc(1, sizeof *exchange);
    server_exchange_add_header(exchange, "Accept", "respond-async");
    if (first) server_exchange_add_header(exchange, "prefer", first);
    if (second) server_exchange_add_header(exchange, "Prefer", second);
    bool is_preferred = server_exchange_prefers(exchange, "respond-async");
    free(exchange);
    return is_preferred;
}

static void finds_the_preference_in_any_list(void **state)
{
    (void)state;
    static const char *const lists[] = {"respond-async",
                                        "Respond-Async",
                                        "wait=10, respond-async",
                                        "respond-async;wait=10",
                                        "respond-async ; a=b , return=minimal",
                                        " ,, respond-async",
                                        "respond-async=\"\"",
                                        "respond-async = ",
                                        "a=\"x, y\",respond-async",
                                        "a=\"\\\",\" , respond-async"};
    for (size_t i = 0; i < COUNT(lists); i++) {
        assert_true(prefers(lists[i], NULL));
        assert_true(prefers("return=minimal", lists[i]));
    }
}

static void ignores_other_preferences(void **state)
{
    (void)state;
    static const char *const lists[] = {"",
                                        "respond",
                                        "respond-asynchronously",
                                        "respond-async-not",
                                        "not-respond-async",
                                        "a=\"respond-async\"",
                                        "a=\", respond-async\"",
                                        "a; respond-async",
                                        "respond-async=no",
                                        "a=\"\\",
                                        "wait=10 respond-async"};
    assert_false(prefers(NULL, NULL));
    for (size_t i = 0; i < COUNT(lists); i++) assert_false(prefers(lists[i], NULL));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_the_preference_in_any_list),
        cmocka_unit_test(ignores_other_preferences),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
