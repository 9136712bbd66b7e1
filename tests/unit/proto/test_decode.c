#include "support.h"

#include <stdio.h>

#include "proto/json/decode.h"

static json_t *document_of(const char *text)
{
    struct proto_problem problem;
    json_t *document = proto_decode_document(text, strlen(text), &problem);
    assert_non_null(document);
    return document;
}

static void refuses_hostile_json(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        size_t size; /* the size of the text; if it is 0, the text ends at the NUL */
    } cases[] = {
        {"{", 0},
        {"}", 0},
        {"{\"a\":1", 0},
        {"{\"a\":1}}", 0},
        {"{\"a\":1} x", 0},
        {"{\"a\":1}{}", 0},
        {"[1,]", 0},
        {"{\"a\":}", 0},
        {"{a:1}", 0},
        {"{'a':1}", 0},
        {"// c\n{}", 0},
        {"nul", 0},
        {"12", 0},
        {"\"text\"", 0},
        {"null", 0},
        {" ", 0},
        {"{\"a\":1,\"a\":2}", 0},
        {"{\"a\":1e999}", 0},
        {"{\"a\":-1e999}", 0},
        {"{\"a\":NaN}", 0},
        {"{\"a\":Infinity}", 0},
        {"{\"a\":01}", 0},
        {"{\"a\":+1}", 0},
        {"{\"a\":.5}", 0},
        {"{\"a\":0x10}", 0},
        {"{\"a\":1.}", 0},
        {"{\"a\":\"\xff\"}", 0},
        {"{\"\xc0\x80\":1}", 0},
        {"{\"a\":\"\xed\xa0\x80\"}", 0},
        {"{\"a\":\"\\ud800\"}", 0},
        {"{\"a\":\"\\u0000\"}", 0},
        {"{\"\\u0000\":1}", 0},
        {"{\"a\":\"\\x41\"}", 0},
        {"{\"a\":\"\n\"}", 0},
        {"\xef\xbb\xbf{}", 0},
        {"{\"a\":1}\0", 8},
        {"{\"a\":\0 1}", 9},
        {"{\"a\":\"\0\"}", 9},
        {"\0", 1},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_problem problem;
        size_t size = cases[i].size ? cases[i].size : strlen(cases[i].text);
        assert_null(proto_decode_document(cases[i].text, size, &problem));
        assert_pointer(&problem, "");
    }
    struct proto_problem problem;
    assert_null(proto_decode_document("", 0, &problem));
    assert_pointer(&problem, "");
}

static void reports_the_position_of_an_error(void **state)
{
    (void)state;
    struct proto_problem problem;
    const char *text = "{\n  \"a\": 1,\n  \"b\": ?\n}";
    assert_null(proto_decode_document(text, strlen(text), &problem));
    assert_non_null(strstr(problem.detail, "line 3, column 8, byte 20"));
    text = "{\"a\":\"\\u0000\"}";
    assert_null(proto_decode_document(text, strlen(text), &problem));
    assert_non_null(strstr(problem.detail, "a string holds \\u0000"));
}

/* Decodes `depth` nested brackets. Objects have keys with brackets, which do not count. */
static bool takes_depth(size_t depth, char open, char close)
{
    char text[1024];
    size_t at = 0;
    for (size_t i = 0; i < depth; i++) {
        text[at++] = open;
        if (open == '{' && i + 1 < depth) at += (size_t)sprintf(text + at, "\"[\\\"{\":");
    }
    for (size_t i = 0; i < depth; i++) text[at++] = close;
    struct proto_problem problem;
    json_t *document = proto_decode_document(text, at, &problem);
    if (!document) assert_int_equal(problem.limit, PROTO_DECODE_DEPTH);
    json_decref(document);
    return document != NULL;
}

static void bounds_the_depth(void **state)
{
    (void)state;
    assert_true(takes_depth(PROTO_DECODE_DEPTH, '[', ']'));
    assert_false(takes_depth(PROTO_DECODE_DEPTH + 1, '[', ']'));
    assert_true(takes_depth(PROTO_DECODE_DEPTH, '{', '}'));
    assert_false(takes_depth(PROTO_DECODE_DEPTH + 1, '{', '}'));
}

static void refuses_a_deep_megabyte_fast(void **state)
{
    (void)state;
    size_t size = 1 << 20;
    char *text = test_malloc(size);
    memset(text, '[', size);
    struct proto_problem problem;
    assert_null(proto_decode_document(text, size, &problem));
    assert_pointer(&problem, "");
    test_free(text);
}

static void takes_numbers_of_any_length(void **state)
{
    (void)state;
    json_t *document = document_of("{\"x\":[100000000000000000000, 12, 1e-400]}");
    struct proto_problem problem;
    double x[3];
    assert_true(proto_decode_numbers(document, "", "x", 3, x, &problem));
    assert_true(x[0] == 1e20 && x[1] == 12 && x[2] == 0);
    json_decref(document);
}

static void reads_members(void **state)
{
    (void)state;
    json_t *document =
        document_of("{\"n\":-1.5,\"i\":4294967294,\"j\":3.0,\"v\":[1,2.5,3],\"e\":[3,9]}");
    struct proto_problem problem;
    double n, v[3];
    uint32_t i, j, e[2];
    assert_true(proto_decode_number(document, "", "n", &n, &problem));
    assert_true(proto_decode_index(document, "", "i", &i, &problem));
    assert_true(proto_decode_index(document, "", "j", &j, &problem));
    assert_true(proto_decode_numbers(document, "", "v", 3, v, &problem));
    assert_true(proto_decode_indices(document, "", "e", 2, e, &problem));
    assert_true(n == -1.5 && i == 4294967294u && j == 3 && v[1] == 2.5 && e[0] == 3 && e[1] == 9);
    json_decref(document);
}

static void pointers_name_the_wrong_member(void **state)
{
    (void)state;
    json_t *document = document_of("{\"s\":\"x\",\"h\":1.5,\"m\":-1,\"l\":4294967295,\"a\":[1,2],"
                                   "\"b\":[1,null,3],\"c\":[1,2.5]}");
    struct proto_problem problem;
    double n = 7, v[3];
    uint32_t i = 7, e[2];
    assert_false(proto_decode_number(document, "/p", "s", &n, &problem));
    assert_pointer(&problem, "/p/s");
    assert_non_null(strstr(problem.detail, "not a string"));
    assert_false(proto_decode_number(document, "/p", "gone", &n, &problem));
    assert_pointer(&problem, "/p/gone");
    static const char *const no_index[] = {"s", "h", "m", "l", "a"};
    for (size_t k = 0; k < COUNT(no_index); k++) {
        char pointer[8] = "/";
        assert_false(proto_decode_index(document, "", no_index[k], &i, &problem));
        assert_pointer(&problem, strcat(pointer, no_index[k]));
    }
    assert_false(proto_decode_numbers(document, "", "a", 3, v, &problem));
    assert_pointer(&problem, "/a");
    assert_false(proto_decode_numbers(document, "", "s", 3, v, &problem));
    assert_pointer(&problem, "/s");
    assert_false(proto_decode_numbers(document, "", "b", 3, v, &problem));
    assert_pointer(&problem, "/b/1");
    assert_false(proto_decode_indices(document, "", "c", 2, e, &problem));
    assert_pointer(&problem, "/c/1");
    assert_true(n == 7 && i == 7);
    json_decref(document);
}

static void refuses_unknown_fields(void **state)
{
    (void)state;
    static const char *const members[] = {"from", "to", NULL};
    struct proto_problem problem;
    json_t *document = document_of("{\"from\":1,\"t/o\":2}");
    assert_false(proto_decode_object(document, "/x", members, &problem));
    assert_pointer(&problem, "/x/t~1o");
    json_decref(document);
    document = document_of("{\"to\":1}");
    assert_true(proto_decode_object(document, "", members, &problem));
    assert_false(proto_decode_object(json_object_get(document, "to"), "/to", members, &problem));
    assert_pointer(&problem, "/to");
    json_decref(document);
}

static bool go_on(void *user, double fraction)
{
    (void)fraction;
    ++*(int *)user;
    return *(int *)user < 3;
}

static void a_large_text_ends_at_its_deadline(void **state)
{
    (void)state;
    const size_t size = (size_t)4 << 20;
    struct proto_problem problem;
    int looks = 0;
    const struct gd_control late = {.deadline_ns = 1}, ending = {.progress = go_on, .user = &looks};
    char *text = malloc(size);
    memset(text, ' ', size);
    assert_null(proto_decode_document_within(text, size, &late, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_DEADLINE_EXCEEDED);
    assert_null(proto_decode_document_within(text, size, &ending, &problem));
    assert_int_equal(looks, 3);
    memcpy(text, "[1]", 3);
    json_t *document = proto_decode_document_within(text, size, NULL, &problem);
    assert_non_null(document);
    json_decref(document);
    /* a text that is decoded at once does not reach its deadline */
    document = proto_decode_document_within("{}", 2, &late, &problem);
    assert_non_null(document);
    json_decref(document);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(refuses_hostile_json),
        cmocka_unit_test(reports_the_position_of_an_error),
        cmocka_unit_test(bounds_the_depth),
        cmocka_unit_test(refuses_a_deep_megabyte_fast),
        cmocka_unit_test(takes_numbers_of_any_length),
        cmocka_unit_test(reads_members),
        cmocka_unit_test(pointers_name_the_wrong_member),
        cmocka_unit_test(refuses_unknown_fields),
        cmocka_unit_test(a_large_text_ends_at_its_deadline),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
