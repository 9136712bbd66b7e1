#include "support.h"

#include "proto/http/page.h"

static void reads_limit_and_after(void **state)
{
    (void)state;
    struct proto_page page;
    struct proto_problem problem;
    struct proto_parameters parameters = NO_QUERY;
    assert_true(proto_page_parse(&parameters, &page, &problem));
    assert_int_equal(page.limit, PROTO_PAGE_DEFAULT);
    assert_null(page.after);
    parameters = QUERY("limit", "1000", "after", "cow");
    assert_true(proto_page_parse(&parameters, &page, &problem));
    assert_int_equal(page.limit, PROTO_PAGE_MOST);
    assert_string_equal(page.after, "cow");
}

static void reads_a_prefix_of_names_only(void **state)
{
    (void)state;
    struct proto_page page;
    struct proto_problem problem;
    struct proto_parameters parameters = QUERY("prefix", "co");
    assert_false(proto_page_parse(&parameters, &page, &problem));
    assert_true(proto_page_parse_names(&parameters, &page, &problem));
    assert_string_equal(page.prefix, "co");
}

static void refuses_bad_pages(void **state)
{
    (void)state;
    static const char *const cases[][2] = {{"limit", "0"}, {"limit", "1001"}, {"limit", "-1"},
                                           {"limit", "x"}, {"limit", ""},     {"page", "2"}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_page page;
        struct proto_problem problem;
        struct proto_parameters parameters = QUERY(cases[i][0], cases[i][1]);
        assert_false(proto_page_parse(&parameters, &page, &problem));
        assert_parameter(&problem, cases[i][0]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(reads_limit_and_after),
                                       cmocka_unit_test(reads_a_prefix_of_names_only),
                                       cmocka_unit_test(refuses_bad_pages)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
