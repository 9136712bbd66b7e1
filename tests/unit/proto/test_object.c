#include "support.h"

#include <math.h>

#include "proto/json/object.h"

static const struct proto_rule length = {.name = "length",
                                         .is_required = true,
                                         .is_above = true,
                                         .most = INFINITY,
                                         .refusal = "a length is more than 0"},
                               count = {.name = "count",
                                        .least = 1,
                                        .most = 9,
                                        .refusal = "ask for one",
                                        .too_large = "ask for fewer"},
                               list = {.name = "list",
                                       .least = 1,
                                       .most = 2,
                                       .refusal = "one at least",
                                       .expected = "expected a list",
                                       .too_large = "two at most"},
                               word = {.name = "word",
                                       .refusal = "word is \"a\" or \"b\"",
                                       .words = (const char *const[]){"a", "b", NULL}};

struct read {
    double length;
    uint32_t count;
    unsigned word;
    size_t items;
};

static bool read_object(const json_t *document, struct read *out, struct proto_problem *problem)
{
    const struct proto_object object = {document, "/inner", problem};
    char place[PROTO_PLACE];
    bool ok;
    *out = (struct read){.count = 4, .word = 1};
    const json_t *items = proto_object_list(&object, &list, place, &ok);
    out->items = json_array_size(items);
    return ok && proto_take_number(&object, &length, &out->length) &&
           proto_take_index(&object, &count, &out->count) &&
           proto_take_word(&object, &word, &out->word);
}

DECODER(decode, struct read, read_object)

static void members_within_their_limits_are_accepted(void **state)
{
    (void)state;
    struct read read;
    struct proto_problem problem;
    assert_true(decode("{\"length\":0.5}", &read, &problem));
    assert_true(read.length == 0.5 && read.count == 4 && read.word == 1 && read.items == 0);
    assert_true(
        decode("{\"length\":1e300,\"count\":9,\"word\":\"a\",\"list\":[1,2]}", &read, &problem));
    assert_true(read.count == 9 && read.word == 0 && read.items == 2);
}

static void members_beyond_their_limits_are_refused_with_a_sentence(void **state)
{
    (void)state;
    static const struct {
        const char *text, *pointer, *sentence;
        bool is_too_large;
    } cases[] = {
        {"{}", "/inner/length", "the member \"length\" is missing", false},
        {"{\"length\":0}", "/inner/length", "a length is more than 0", false},
        {"{\"length\":\"1\"}", "/inner/length", "expected a number, not a string", false},
        {"{\"length\":1,\"count\":0}", "/inner/count", "ask for one", false},
        {"{\"length\":1,\"count\":-1}", "/inner/count", "ask for one", false},
        {"{\"length\":1,\"count\":1.5}", "/inner/count",
         "expected a whole number from 0 to 4294967294", false},
        {"{\"length\":1,\"count\":10}", "/inner/count", "ask for fewer", true},
        {"{\"length\":1,\"word\":\"c\"}", "/inner/word", "word is \"a\" or \"b\"", false},
        {"{\"length\":1,\"word\":1}", "/inner/word", "word is \"a\" or \"b\"", false},
        {"{\"list\":[]}", "/inner/list", "one at least", false},
        {"{\"list\":{}}", "/inner/list", "expected a list", false},
        {"{\"list\":[1,2,3]}", "/inner/list", "two at most", true},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct read read;
        struct proto_problem problem;
        assert_false(decode(cases[i].text, &read, &problem));
        assert_string_equal(problem.pointer, cases[i].pointer);
        assert_string_equal(problem.detail, cases[i].sentence);
        assert_int_equal(problem.code, cases[i].is_too_large ? PROTO_PROBLEM_TOO_LARGE
                                                             : PROTO_PROBLEM_INVALID_REQUEST);
    }
}

static void exactly_one_of_two_members_is_required(void **state)
{
    (void)state;
    static const char *const texts[] = {"{}", "{\"a\":1,\"b\":1}", "{\"a\":1}", "{\"b\":1}"};
    for (size_t i = 0; i < COUNT(texts); i++) {
        struct proto_problem problem;
        json_t *document = parse(texts[i]);
        const struct proto_object object = {document, "", &problem};
        assert_int_equal(proto_object_one_of(&object, "a", "b", "say a or b"), i >= 2);
        if (i < 2) assert_string_equal(problem.detail, "say a or b");
        json_decref(document);
    }
}

static void fields_are_written_where_they_are_wanted(void **state)
{
    (void)state;
    const struct proto_options *options =
        FIELDS(mean, PROTO_MEAN_FIELD_SPREAD | PROTO_MEAN_FIELD_CONVERGED);
    struct proto_writer writer = new_writer();
    proto_write_object_begin(&writer);
    assert_false(proto_field(&writer, options, PROTO_MEAN_FIELD_POINT));
    proto_field_number(&writer, options, PROTO_MEAN_FIELD_RESIDUAL, 1);
    proto_field_number(&writer, options, PROTO_MEAN_FIELD_SPREAD, 2);
    proto_field_uint(&writer, options, PROTO_MEAN_FIELD_ITERATIONS, 3);
    proto_field_bool(&writer, options, PROTO_MEAN_FIELD_CONVERGED, true);
    proto_write_object_end(&writer);
    assert_written(&writer, "{\"spread\":2,\"converged\":true}");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(members_within_their_limits_are_accepted),
        cmocka_unit_test(members_beyond_their_limits_are_refused_with_a_sentence),
        cmocka_unit_test(exactly_one_of_two_members_is_required),
        cmocka_unit_test(fields_are_written_where_they_are_wanted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
