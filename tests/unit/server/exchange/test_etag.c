#include "tests/unit/server/support.h"

#include "server/exchange/etag.h"

static bool holds(const char *if_match, const char *if_none_match, const char *etag)
{
    return server_precondition_holds(&(struct server_precondition){{if_match}, {if_none_match}},
                                     etag);
}

static void if_match(void **state)
{
    (void)state;
    assert_true(holds(NULL, NULL, "a"));
    assert_true(holds(NULL, NULL, NULL));
    assert_true(holds("\"a\"", NULL, "a"));
    assert_true(holds("\"x\", \"a\"", NULL, "a"));
    assert_true(holds("*", NULL, "a"));
    assert_false(holds("\"b\"", NULL, "a"));
    assert_false(holds("a", NULL, "a")); /* a tag must have quotes */
    assert_false(holds("\"aa\"", NULL, "a"));
    assert_false(holds("*", NULL, NULL));
    assert_false(holds("\"a\"", NULL, NULL));
}

static void if_none_match(void **state)
{
    (void)state;
    assert_true(holds(NULL, "*", NULL));
    assert_true(holds(NULL, "\"b\"", "a"));
    assert_true(holds(NULL, "\"a\"", NULL));
    assert_false(holds(NULL, "*", "a"));
    assert_false(holds(NULL, "\"b\", \"a\"", "a"));
}

static void weak_tags(void **state)
{
    (void)state;
    /* in the strong comparison a weak tag equals no tag */
    assert_false(holds("W/\"a\"", NULL, "a"));
    assert_true(holds("W/\"a\", \"a\"", NULL, "a"));
    assert_false(holds(NULL, "W/\"a\"", "a"));
    assert_false(holds(NULL, "\"b\" ,W/\"a\"", "a"));
    assert_true(holds(NULL, "w/\"a\"", "a")); /* the W must be a capital */
}

static enum server_etag_form known(const char *list)
{
    return server_precondition_known(&(struct server_precondition){.if_none_match = {list}}, "a");
}

static void lists(void **state)
{
    (void)state;
    static const char *const with[] = {
        "\"a\"", " \"a\"", "\"x\",\"a\"", ",,\"x\" ,\t\"a\",", "\"x,y\", \"a\"", "\"\", \"a\""};
    static const char *const without[] = {"",   "\"",  "\"a",     "a",          "\"x\" * \"a\"",
                                          "W/", "W/a", "\"a\\\"", "\"x, \"a\"", "**"};
    for (size_t i = 0; i < COUNT(with); i++) assert_int_equal(known(with[i]), SERVER_ETAG_PLAIN);
    for (size_t i = 0; i < COUNT(without); i++)
        assert_int_equal(known(without[i]), SERVER_ETAG_NONE);
}

static void an_asterisk_with_blanks(void **state)
{
    (void)state;
    static const char *const any[] = {"* ", "*\t", " *", "\t * \t "};
    for (size_t i = 0; i < COUNT(any); i++) {
        assert_false(holds(NULL, any[i], "a"));
        assert_true(holds(NULL, any[i], NULL));
        assert_true(holds(any[i], NULL, "a"));
        assert_false(holds(any[i], NULL, NULL));
    }
}

static void several_lines_are_one_list(void **state)
{
    (void)state;
    const struct server_precondition match = {.if_match = {"\"x\"", "W/\"a\"", "\"b\", \"a\""}};
    const struct server_precondition none_match = {.if_none_match = {"\"x\"", "broken", "\"a\""}};
    assert_true(server_precondition_holds(&match, "a"));
    assert_true(server_precondition_holds(&match, "b"));
    assert_false(server_precondition_holds(&match, "c"));
    assert_false(server_precondition_holds(&none_match, "a"));
    assert_false(server_precondition_holds(&none_match, "x"));
    assert_true(server_precondition_holds(&none_match, "c"));
}

static void the_compressed_form_is_the_same_resource(void **state)
{
    (void)state;
    assert_true(holds("\"a-gzip\"", NULL, "a"));
    assert_false(holds(NULL, "\"x\", W/\"a-gzip\"", "a"));
    assert_int_equal(known("\"a-gzip\", \"a\""), SERVER_ETAG_PACKED);
    static const char *const others[] = {"\"a-gzi\"", "\"a-gzip-gzip\"", "\"b-gzip\"", "\"-gzip\"",
                                         "\"a-GZIP\""};
    for (size_t i = 0; i < COUNT(others); i++) assert_int_equal(known(others[i]), SERVER_ETAG_NONE);
}

static enum server_etag_form known_as(const char *list, const char *etag)
{
    return server_precondition_known(&(struct server_precondition){.if_none_match = {list}}, etag);
}

static void tags_of_forms(void **state)
{
    (void)state;
    char csv[SERVER_ETAG_TEXT], own[SERVER_ETAG_TEXT];
    server_etag_write(csv, "a", "csv");
    server_etag_write(own, "a", NULL);
    assert_string_equal(csv, "a-csv." SERVER_FORMAT_VERSION);
    assert_string_equal(own, "a");
}

/* If-None-Match of a GET compares the tag of one representation. */
static void each_form_has_a_separate_tag(void **state)
{
    (void)state;
    static const char *const others[] = {"\"a\"",       "\"a-gzip\"",      "\"a-json.1\"",
                                         "\"a-csv.0\"", "\"a-csv.1-gzi\"", "\"a-csv\""};
    assert_int_equal(known_as("\"a-csv.1\"", "a-csv.1"), SERVER_ETAG_PLAIN);
    assert_int_equal(known_as("W/\"a-csv.1-gzip\"", "a-csv.1"), SERVER_ETAG_PACKED);
    assert_int_equal(known_as("\"a-csv.1\"", "a"), SERVER_ETAG_NONE);
    for (size_t i = 0; i < COUNT(others); i++)
        assert_int_equal(known_as(others[i], "a-csv.1"), SERVER_ETAG_NONE);
}

/* If-Match, and If-None-Match of changes, accept any tag of the resource. */
static void every_form_names_the_resource(void **state)
{
    (void)state;
    static const char *const names[] = {"\"a\"", "\"a-gzip\"", "\"a-json.1\"",
                                        "\"a-float64.1-gzip\""};
    static const char *const others[] = {"\"a-\"",       "\"a-.1\"",      "\"a-json\"",
                                         "\"a-json.2\"", "\"a-JSON.1\"",  "\"a-x-json.1\"",
                                         "\"b-json.1\"", "\"aa-json.1\"", "\"ajson.1\"",
                                         "\"-json.1\"",  "\"a-json.1.1\""};
    for (size_t i = 0; i < COUNT(names); i++) {
        assert_true(holds(names[i], NULL, "a"));
        assert_true(holds(names[i], NULL, "a-csv.1")); /* only the base of the tag counts */
        assert_false(holds(NULL, names[i], "a"));
    }
    for (size_t i = 0; i < COUNT(others); i++) {
        assert_false(holds(others[i], NULL, "a"));
        assert_true(holds(NULL, others[i], "a"));
    }
    assert_false(holds("W/\"a-json.1\"", NULL, "a"));
    assert_false(holds(NULL, "W/\"a-json.1\"", "a"));
}

static void read_from_a_request(void **state)
{
    (void)state;
    struct server_exchange exchange = {
        .headers = {{"if-match", "\"a\""}, {"If-None-Match", "1"}, {"IF-MATCH", "\"b\""}},
        .header_count = 3};
    const struct server_precondition precondition = server_precondition_read(&exchange);
    assert_string_equal(precondition.if_match[0], "\"a\"");
    assert_string_equal(precondition.if_match[1], "\"b\"");
    assert_null(precondition.if_match[2]);
    assert_string_equal(precondition.if_none_match[0], "1");
    assert_null(precondition.if_none_match[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(if_match),
        cmocka_unit_test(if_none_match),
        cmocka_unit_test(weak_tags),
        cmocka_unit_test(lists),
        cmocka_unit_test(an_asterisk_with_blanks),
        cmocka_unit_test(several_lines_are_one_list),
        cmocka_unit_test(the_compressed_form_is_the_same_resource),
        cmocka_unit_test(tags_of_forms),
        cmocka_unit_test(each_form_has_a_separate_tag),
        cmocka_unit_test(every_form_names_the_resource),
        cmocka_unit_test(read_from_a_request),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
