#include "support.h"

#include <math.h>

#include "proto/decode.h"
#include "proto/pair.h"

/* --- the request
 * -------------------------------------------------------------------------------------------------------- */

static bool decode(const char *text, struct proto_pair *out, struct proto_problem *problem)
{
    json_t *document = proto_decode_document(text, strlen(text), problem);
    assert_non_null(document);
    bool decoded = proto_pair_decode(document, out, problem);
    json_decref(document);
    return decoded;
}

static void decodes_bodies(void **state)
{
    (void)state;
    struct proto_pair pair;
    struct proto_problem problem;
    assert_true(decode("{\"to\":{\"vertex\":2},\"from\":{\"xyz\":[1,2,3]}}", &pair, &problem));
    assert_true(pair.from.form == PROTO_POINT_XYZ && pair.to.form == PROTO_POINT_VERTEX && pair.to.vertex.index == 2);
    assert_string_equal(pair.from.place, "/from");
    assert_string_equal(pair.to.place, "/to");
}

static void refuses_bad_bodies(void **state)
{
    (void)state;
    static const struct {
        const char *text, *pointer;
    } cases[] = {
        {"[]", ""},
        {"{}", "/from"},
        {"{\"from\":{\"vertex\":1}}", "/to"},
        {"{\"to\":{\"vertex\":1}}", "/from"},
        {"{\"from\":1,\"to\":{\"vertex\":1}}", "/from"},
        {"{\"from\":{\"vertex\":1},\"to\":{\"vertex\":-1}}", "/to/vertex"},
        {"{\"from\":{\"vertex\":1},\"to\":{\"vertex\":1},\"max\":1}", "/max"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_pair pair;
        struct proto_problem problem;
        assert_false(decode(cases[i].text, &pair, &problem));
        assert_pointer(&problem, cases[i].pointer);
    }
}

static void parses_query_strings(void **state)
{
    (void)state;
    struct proto_pair pair;
    struct proto_problem problem;
    struct proto_parameters parameters = QUERY("to", "e:1-2:0.5", "from", "v:0");
    assert_true(proto_pair_parse(&parameters, &pair, &problem));
    assert_true(pair.from.form == PROTO_POINT_VERTEX && pair.to.form == PROTO_POINT_EDGE);
    parameters = QUERY("from", "v:0");
    assert_false(proto_pair_parse(&parameters, &pair, &problem));
    assert_parameter(&problem, "to");
    parameters = QUERY("to", "v:0", "from", "0");
    assert_false(proto_pair_parse(&parameters, &pair, &problem));
    assert_parameter(&problem, "from");
}

static void says_which_of_the_two_is_not_there(void **state)
{
    (void)state;
    struct gd_mesh *mesh = new_tetrahedron();
    struct proto_pair pair;
    struct proto_located_pair located;
    struct proto_problem problem;
    assert_true(decode("{\"from\":{\"vertex\":1},\"to\":{\"vertex\":4}}", &pair, &problem));
    assert_false(proto_pair_locate(mesh, &pair, &located, &problem));
    assert_pointer(&problem, "/to");
    struct proto_parameters parameters = QUERY("to", "v:0", "from", "v:9");
    assert_true(proto_pair_parse(&parameters, &pair, &problem));
    assert_false(proto_pair_locate(mesh, &pair, &located, &problem));
    assert_parameter(&problem, "from");
    gd_mesh_release(mesh);
}

/* --- the answer
 * --------------------------------------------------------------------------------------------------------- */

#define FROM "\"from\":{\"face\":0,\"barycentric\":[1,0,0],\"xyz\":[0,0,0],\"vertex\":0}"
#define TO   "\"to\":{\"face\":0,\"barycentric\":[0,0,1],\"xyz\":[1,0,0],\"vertex\":1,\"snap_distance\":1}"
#define PATH "\"path\":{\"length\":1,\"points\":[{\"xyz\":[0,0,0],\"vertex\":0},{\"xyz\":[1,0,0],\"vertex\":1}]}"
#define ALL                                                                                                            \
    (PROTO_PAIR_FIELD_DISTANCE | PROTO_PAIR_FIELD_REASON | PROTO_PAIR_FIELD_FROM | PROTO_PAIR_FIELD_TO |               \
     PROTO_PAIR_FIELD_PATH)

static void encodes_answers(void **state)
{
    (void)state;
    static const struct {
        double distance;
        uint32_t fields;
        enum proto_geometry geometry;
        const char *text;
    } cases[] = {
        {1, ALL, PROTO_GEOMETRY_FULL, "{\"distance\":1," FROM "," TO "," PATH "}"},
        {1, ALL - PROTO_PAIR_FIELD_PATH, PROTO_GEOMETRY_FULL, "{\"distance\":1," FROM "," TO "}"},
        {1, PROTO_PAIR_FIELD_PATH, PROTO_GEOMETRY_XYZ, "{\"path\":{\"length\":1,\"points\":[[0,0,0],[1,0,0]]}}"},
        {1, PROTO_PAIR_FIELD_PATH | PROTO_PAIR_FIELD_DISTANCE, PROTO_GEOMETRY_NONE,
         "{\"distance\":1,\"path\":{\"length\":1}}"},
        {1, PROTO_PAIR_FIELD_REASON, PROTO_GEOMETRY_FULL, "{}"},
        {INFINITY, ALL, PROTO_GEOMETRY_FULL,
         "{\"distance\":null,\"reason\":\"no_path\"," FROM "," TO ",\"path\":null}"},
        {INFINITY, PROTO_PAIR_FIELD_DISTANCE, PROTO_GEOMETRY_FULL, "{\"distance\":null,\"reason\":\"no_path\"}"},
        {INFINITY, PROTO_PAIR_FIELD_REASON, PROTO_GEOMETRY_FULL, "{\"reason\":\"no_path\"}"},
    };
    struct gd_mesh *mesh = new_tetrahedron();
    struct proto_located_pair pair = {.mesh = mesh, .from_snap = NAN, .to_snap = 1};
    assert_int_equal(gd_point_at_vertex(mesh, (struct gd_vertex){0}, &pair.from, NULL), GD_OK);
    assert_int_equal(gd_point_at_vertex(mesh, (struct gd_vertex){1}, &pair.to, NULL), GD_OK);
    struct gd_point points[] = {pair.from, pair.to};
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct gd_pair_answer answer = {.distance = cases[i].distance};
        if (isfinite(answer.distance)) answer.path = (struct gd_path){.length = 1, .count = 2, .points = points};
        struct proto_options options = {.fields = cases[i].fields, .geometry = cases[i].geometry};
        struct proto_writer writer = new_writer();
        proto_pair_encode(&writer, &pair, &answer, &options);
        assert_written(&writer, cases[i].text);
    }
    gd_mesh_release(mesh);
}

static void names_its_fields_in_the_order_of_the_bits(void **state)
{
    (void)state;
    struct proto_options options;
    struct proto_problem problem;
    struct proto_parameters parameters = QUERY("fields", "path,distance");
    assert_true(proto_options_parse(&parameters, proto_path_fields, proto_pair_parameters, &options, &problem));
    assert_int_equal(options.fields, PROTO_PAIR_FIELD_PATH | PROTO_PAIR_FIELD_DISTANCE);
    assert_false(proto_options_parse(&parameters, proto_distance_fields, proto_pair_parameters, &options, &problem));
    assert_parameter(&problem, "fields");
    parameters = QUERY("fields", "from,to,reason");
    assert_true(proto_options_parse(&parameters, proto_distance_fields, proto_pair_parameters, &options, &problem));
    assert_int_equal(options.fields, PROTO_PAIR_FIELD_FROM | PROTO_PAIR_FIELD_TO | PROTO_PAIR_FIELD_REASON);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(decodes_bodies),       cmocka_unit_test(refuses_bad_bodies),
        cmocka_unit_test(parses_query_strings), cmocka_unit_test(says_which_of_the_two_is_not_there),
        cmocka_unit_test(encodes_answers),      cmocka_unit_test(names_its_fields_in_the_order_of_the_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
