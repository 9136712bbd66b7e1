#include "support.h"

#include <math.h>

#include "proto/values/vector.h"

DECODER(decode_exp, struct proto_exp, proto_exp_decode)
DECODER(decode_log, struct proto_log, proto_log_decode)
DECODER(decode_transport, struct proto_transport, proto_transport_decode)

#define START  "\"start\":{\"vertex\":3}"
#define VECTOR "{\"direction\":1,\"length\":2}"

static void decodes_vectors(void **state)
{
    (void)state;
    struct proto_exp exp_wanted;
    struct proto_problem problem;
    assert_true(decode_exp("{" START ",\"vectors\":[" VECTOR ",{\"segments\":[" VECTOR "," VECTOR
                           "]}," VECTOR "],"
                           "\"combine\":null}",
                           &exp_wanted, &problem) == false);
    assert_pointer(&problem, "/combine");
    assert_true(decode_exp("{" START ",\"vectors\":[" VECTOR ",{\"segments\":[" VECTOR "," VECTOR
                           "],\"length\":4,"
                           "\"direction\":{\"angle\":1}}," VECTOR "]}",
                           &exp_wanted, &problem));
    struct proto_vectors *vectors = &exp_wanted.vectors;
    static const uint32_t first[] = {0, 1, 3, 4};
    assert_true(vectors->count == 3 && !vectors->factors &&
                !memcmp(vectors->first, first, sizeof first));
    assert_string_equal(vectors->segments[2].direction.place, "/vectors/1/segments/1/direction");
    assert_true(vectors->segments[3].length == 2 && vectors->segments[3].direction.angle == 1);
    proto_vectors_free(vectors);
    proto_vectors_free(vectors);
    struct proto_transport transport;
    assert_true(
        decode_transport("{\"from\":{\"vertex\":1},\"to\":{\"vertex\":2},\"vectors\":[" VECTOR
                         "," VECTOR "],\"combine\":[0.5,-1]}",
                         &transport, &problem));
    assert_true(transport.ends.count == 2 && transport.ends.items[1].vertex == 2);
    assert_true(transport.vectors.factors[1] == -1);
    proto_vectors_free(&transport.vectors);
    proto_points_free(&transport.ends);
    struct proto_log log_wanted;
    assert_true(decode_log("{\"from\":{\"vertex\":1},\"to\":\"all\"}", &log_wanted, &problem));
    assert_true(!log_wanted.to.count && !log_wanted.first_vector_only);
    assert_true(
        decode_log("{\"from\":{\"vertex\":1},\"to\":[{\"vertex\":2}],\"first_vector_only\":true}",
                   &log_wanted, &problem));
    assert_true(log_wanted.to.count == 1 && log_wanted.first_vector_only);
    proto_points_free(&log_wanted.to);
}

static void refuses_bad_bodies(void **state)
{
    (void)state;
    static const struct {
        const char *text, *pointer;
    } cases[] = {
        {"[]", ""},
        {"{\"vectors\":[" VECTOR "]}", "/start"},
        {"{" START "}", "/vectors"},
        {"{" START ",\"vectors\":[]}", "/vectors"},
        {"{" START ",\"vectors\":[3]}", "/vectors/0"},
        {"{" START ",\"vectors\":[" VECTOR ",{\"length\":1}]}", "/vectors/1/direction"},
        {"{" START ",\"vectors\":[{\"direction\":1,\"length\":1e200}]}", "/vectors/0/length"},
        {"{" START ",\"vectors\":[{\"segments\":{}}]}", "/vectors/0"},
        {"{" START ",\"vectors\":[{\"segments\":[" VECTOR ",{\"direction\":1}]}]}",
         "/vectors/0/segments/1/length"},
        {"{" START ",\"vectors\":[{\"segments\":[{\"segments\":[]}]}]}",
         "/vectors/0/segments/0/segments"},
        {"{" START ",\"vectors\":[" VECTOR "],\"combine\":[1,2]}", "/combine"},
        {"{" START ",\"vectors\":[{\"segments\":[" VECTOR "," VECTOR "]}],\"combine\":[1]}",
         "/vectors/0"},
    };
    struct proto_exp exp_wanted;
    struct proto_problem problem;
    for (size_t i = 0; i < COUNT(cases); i++) {
        assert_false(decode_exp(cases[i].text, &exp_wanted, &problem));
        assert_pointer(&problem, cases[i].pointer);
    }
    struct proto_log log_wanted;
    assert_false(decode_log("{\"from\":{\"vertex\":1},\"to\":[]}", &log_wanted, &problem));
    assert_pointer(&problem, "/to");
    assert_false(
        decode_log("{\"from\":{\"vertex\":1},\"to\":[{\"vertex\":1},3]}", &log_wanted, &problem));
    assert_pointer(&problem, "/to/1");
    struct proto_transport transport;
    assert_false(decode_transport("{\"from\":{\"vertex\":1},\"vectors\":[" VECTOR "]}", &transport,
                                  &problem));
    assert_pointer(&problem, "/to");
}

static void writes_vectors(void **state)
{
    (void)state;
    const struct gd_direction direction = {.angle = 0.5, .xyz = {0, 1, 0}};
    struct gd_vector segments[2] = {{direction, 1}, {direction, 2}};
    struct proto_writer writer = new_writer();
    proto_vector_encode(&writer, NULL, INFINITY);
    assert_written(&writer, "{\"direction\":null,\"length\":null,\"reason\":\"no_path\"}");
    writer = new_writer();
    proto_vector_encode(&writer, &direction, 3);
    assert_written(&writer, "{\"direction\":{\"angle\":0.5,\"xyz\":[0,1,0]},\"length\":3}");
    writer = new_writer();
    proto_log_encode(&writer, &(struct gd_log){.vector = {direction, 0}}, false);
    assert_written(&writer, "{\"direction\":null,\"length\":0}");
    writer = new_writer();
    proto_log_encode(&writer, &(struct gd_log){{direction, 3}, segments, 2}, true);
    assert_written(&writer,
                   "{\"direction\":{\"angle\":0.5,\"xyz\":[0,1,0]},\"length\":3,\"segments\":["
                   "{\"direction\":{\"angle\":0.5,\"xyz\":[0,1,0]},\"length\":1},"
                   "{\"direction\":{\"angle\":0.5,\"xyz\":[0,1,0]},\"length\":2}],"
                   "\"cut_locus\":true}");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(decodes_vectors),
                                       cmocka_unit_test(refuses_bad_bodies),
                                       cmocka_unit_test(writes_vectors)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
