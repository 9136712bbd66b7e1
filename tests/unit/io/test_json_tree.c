#include "io/json_tree.h"
#include "tests/unit/io/reading.h"

static enum gd_status parse(const char *text, struct gd__json *out, struct gd_detail *detail)
{
    struct gd__scan scan = gd__scan_begin(text, strlen(text), detail);
    scan.by_byte = true;
    return gd__json_parse(&scan, NULL, out);
}

/* Checks the values as text. The text has, for each value, its first character and the number of
 * the next value. */
static void check_tree(const char *text, const char *expected)
{
    struct gd__json json;
    char *shape = NULL;
    size_t size;
    FILE *stream = open_memstream(&shape, &size);
    assert_int_equal(parse(text, &json, NULL), GD_OK);
    for (uint32_t i = 0; i < json.count; i++)
        fprintf(stream, "%c%u ", *gd__json_at(&json, i), gd__json_next(&json, i));
    fclose(stream);
    assert_string_equal(shape, expected);
    free(shape);
    gd__json_free(&json);
}

static void numbers_values_in_order(void **state)
{
    (void)state;
    check_tree("7", "71 ");
    check_tree(" [ ] ", "[1 ");
    check_tree("[[],{},[1]]", "[5 [2 {3 [5 15 ");
    check_tree("{\"a\":[1,-2e3],\"b\":{\"c\":true},\"d\":null}",
               "{11 \"2 [5 14 -5 \"6 {9 \"8 t9 \"10 n11 ");
}

static void finds_members(void **state)
{
    (void)state;
    struct gd__json json;
    double number;
    assert_int_equal(
        parse("{\"a\\\"\":1,\"ab\":2,\"a\":\"text\",\"a\":4,\"n\":-2.5e1}", &json, NULL), GD_OK);
    assert_true(gd__json_says(&json, gd__json_member(&json, 0, "a"), "text"));
    assert_false(gd__json_says(&json, gd__json_member(&json, 0, "a"), "tex"));
    assert_false(gd__json_says(&json, gd__json_member(&json, 0, "a"), "texts"));
    assert_true(gd__json_real(&json, gd__json_member(&json, 0, "n"), &number) && number == -25);
    assert_false(gd__json_real(&json, gd__json_member(&json, 0, "a"), &number));
    assert_int_equal(gd__json_member(&json, 0, "b"), UINT32_MAX);
    assert_int_equal(gd__json_member(&json, 1, "b"), UINT32_MAX);
    gd__json_free(&json);
}

static void refuses_invalid_json(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        enum gd_status status;
        uint64_t place;
    } bad[] = {
        {"", GD_TRUNCATED, 0},     {"{", GD_TRUNCATED, 1},     {"[1", GD_TRUNCATED, 2},
        {"[1,]", GD_SYNTAX, 3},    {"{\"a\"}", GD_SYNTAX, 4},  {"{\"a\":1,}", GD_SYNTAX, 7},
        {"{1:2}", GD_SYNTAX, 1},   {"[1}", GD_SYNTAX, 2},      {"1 2", GD_SYNTAX, 2},
        {"[01]", GD_SYNTAX, 1},    {"[tru]", GD_SYNTAX, 1},    {"\"a", GD_TRUNCATED, 2},
        {"[truex]", GD_SYNTAX, 5}, {"\"a\nb\"", GD_SYNTAX, 2}, {"[\"a\\\"]", GD_TRUNCATED, 6},
        {"]", GD_SYNTAX, 0},       {"[1]]", GD_SYNTAX, 3},     {"[,1]", GD_SYNTAX, 1},
    };
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        struct gd__json json = {.count = 77};
        struct gd_detail detail = {.text = ""};
        enum gd_status status = parse(bad[i].text, &json, &detail);
        if (status != bad[i].status || detail.elements[0][0] != bad[i].place)
            fail_msg("'%s': %s, '%s'", bad[i].text, gd_status_name(status), detail.text);
        assert_int_equal(json.count, 77);
    }
}

static void bounds_depth(void **state)
{
    (void)state;
    char text[2 * GD__JSON_DEPTH + 3];
    struct gd__json json;
    struct gd_detail detail;
    for (size_t depth = GD__JSON_DEPTH; depth <= GD__JSON_DEPTH + 1; depth++) {
        memset(text, '[', depth);
        memset(text + depth, ']', depth);
        text[2 * depth] = '\0';
        enum gd_status status = parse(text, &json, &detail);
        assert_int_equal(status, depth > GD__JSON_DEPTH ? GD_UNSUPPORTED : GD_OK);
        if (status == GD_OK) gd__json_free(&json);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_values_in_order),
        cmocka_unit_test(finds_members),
        cmocka_unit_test(refuses_invalid_json),
        cmocka_unit_test(bounds_depth),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
