#include "support.h"

#include "proto/queries/many.h"

static struct proto_many many_of(const char *text)
{
    struct proto_many many;
    struct proto_problem problem;
    if (!proto_many_read(text, strlen(text), &many, &problem))
        fail_msg("%s: %s", text, problem.detail);
    return many;
}

static void assert_asks(const struct proto_many *many, uint32_t item, const char *mesh,
                        const char *question, const char *expected)
{
    struct proto_writer writer;
    proto_writer_init(&writer, 4096);
    assert_string_equal(proto_many_ask(many, item, &writer), question);
    assert_string_equal(proto_many_mesh(many, item), mesh);
    assert_int_equal(writer.failure, PROTO_WRITER_FINE);
    assert_int_equal(writer.size, strlen(expected));
    assert_memory_equal(writer.data, expected, writer.size);
    proto_writer_free(&writer);
}

static void all_pairs_are_rows_of_a_matrix(void **state)
{
    (void)state;
    struct proto_many many =
        many_of("{\"query\":\"all-pairs\",\"mesh\":\"cow\",\"vertices\":[4,17]}");
    assert_int_equal(many.item_count, 2);
    assert_asks(&many, 1, "cow", "matrix",
                "{\"sources\":[{\"vertex\":17}],\"targets\":[{\"vertex\":4},{\"vertex\":17}]}");
    proto_many_free(&many);
}

static void a_batch_of_fields_sends_each_mesh_the_same_set(void **state)
{
    (void)state;
    struct proto_many many = many_of(
        "{\"query\":\"fields\",\"meshes\":[\"a\",\"b\"],\"set\":{\"points\":[{\"xyz\":[0.1,0,1]}]},"
        "\"max_distance\":2.5}");
    assert_int_equal(many.item_count, 2);
    assert_asks(&many, 1, "b", "fields",
                "{\"set\":{\"points\":[{\"xyz\":[0.1,0,1]}]},\"max_distance\":2.5}");
    proto_many_free(&many);
}

static void invalid_batches_are_refused(void **state)
{
    static const char *const texts[] = {
        "[]",
        "{}",
        "{\"query\":\"path\"}",
        "{\"query\":\"all-pairs\",\"mesh\":\"a\"}",
        "{\"query\":\"all-pairs\",\"mesh\":\"\",\"vertices\":[1]}",
        "{\"query\":\"all-pairs\",\"mesh\":\"a\",\"vertices\":[]}",
        "{\"query\":\"all-pairs\",\"mesh\":\"a\",\"vertices\":3}",
        "{\"query\":\"all-pairs\",\"mesh\":\"a\",\"vertices\":[-1]}",
        "{\"query\":\"all-pairs\",\"mesh\":\"a\",\"vertices\":[0.5]}",
        "{\"query\":\"all-pairs\",\"mesh\":\"a\",\"vertices\":[4294967295]}",
        "{\"query\":\"all-pairs\",\"mesh\":\"a\",\"vertices\":[0],\"set\":{}}",
        "{\"query\":\"fields\",\"meshes\":[\"a\"]}",
        "{\"query\":\"fields\",\"meshes\":[3],\"set\":{}}",
        "{\"query\":\"fields\",\"meshes\":[\"a\"],\"set\":{},\"max_distance\":0}"};
    (void)state;
    for (size_t i = 0; i < COUNT(texts); i++) {
        struct proto_many many;
        struct proto_problem problem;
        if (proto_many_read(texts[i], strlen(texts[i]), &many, &problem))
            fail_msg("%s was read", texts[i]);
        assert_int_equal(problem.code, PROTO_PROBLEM_INVALID_REQUEST);
    }
}

static void writes_state_and_answers(void **state)
{
    (void)state;
    struct proto_many many =
        many_of("{\"query\":\"all-pairs\",\"mesh\":\"cow\",\"vertices\":[4,17]}");
    struct proto_writer writer;
    proto_writer_init(&writer, 4096);
    proto_batch_encode(&writer,
                       &(struct proto_many_state){
                           .id = "x", .items = 4, .done = 1, .failed = 1, .is_cancelled = true});
    proto_many_encode_answer(&writer, &many, 1, 200, "{\"distances\":[[0]]}", 19);
    proto_many_encode_answer(&writer, &many, 0, 412, "{}", 2);
    static const char expected[] =
        "{\"id\":\"x\",\"state\":\"cancelled\",\"items\":4,\"done\":1,\"failed\":1,\"progress\":0."
        "25,"
        "\"created\":\"1970-01-01T00:00:00Z\"}"
        ",{\"item\":1,\"status\":200,\"mesh\":\"cow\",\"vertex\":17,\"answer\":{\"distances\":[[0]]"
        "}}"
        ",{\"item\":0,\"status\":412,\"mesh\":\"cow\",\"vertex\":4,\"problem\":{}}";
    assert_int_equal(writer.size, sizeof expected - 1);
    assert_memory_equal(writer.data, expected, writer.size);
    proto_writer_free(&writer);
    proto_many_free(&many);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_pairs_are_rows_of_a_matrix),
        cmocka_unit_test(a_batch_of_fields_sends_each_mesh_the_same_set),
        cmocka_unit_test(invalid_batches_are_refused),
        cmocka_unit_test(writes_state_and_answers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
