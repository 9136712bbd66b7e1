#include "support.h"

#include <math.h>

#include "proto/queries/pair.h"
#include "tests/support/test.h"

/* --- the request ------------------------------------------------------------------------------ */

DECODER(decode, struct proto_points, proto_pair_decode)

static void decodes_bodies(void **state)
{
    (void)state;
    struct proto_points stops;
    struct proto_problem problem;
    assert_true(decode("{\"to\":{\"vertex\":2},\"from\":{\"xyz\":[1,2,3]}}", &stops, &problem));
    assert_int_equal(stops.count, 2);
    assert_true(stops.items[0].form == PROTO_POINT_XYZ &&
                stops.items[1].form == PROTO_POINT_VERTEX);
    assert_int_equal(stops.items[1].vertex, 2);
    assert_string_equal(stops.items[0].place, "/from");
    assert_string_equal(stops.items[1].place, "/to");
    proto_points_free(&stops);
}

static void decodes_stops_in_order_of_the_path(void **state)
{
    (void)state;
    struct proto_points stops;
    struct proto_problem problem;
    assert_true(
        decode("{\"via\":[{\"vertex\":5},{\"vertex\":6},{\"vertex\":5}],\"to\":{\"vertex\":2},"
               "\"from\":{\"vertex\":1}}",
               &stops, &problem));
    static const uint32_t expected[] = {1, 5, 6, 5, 2};
    assert_int_equal(stops.count, COUNT(expected));
    for (uint32_t i = 0; i < stops.count; i++) assert_int_equal(stops.items[i].vertex, expected[i]);
    assert_string_equal(stops.items[2].place, "/via/1");
    proto_points_free(&stops);
    assert_true(
        decode("{\"via\":[],\"to\":{\"vertex\":2},\"from\":{\"vertex\":1}}", &stops, &problem));
    assert_int_equal(stops.count, 2);
    proto_points_free(&stops);
}

static void refuses_bad_bodies(void **state)
{
    (void)state;
    static const struct refusal cases[] = {
        {"[]", ""},
        {"{}", "/from"},
        {"{\"from\":{\"vertex\":1}}", "/to"},
        {"{\"to\":{\"vertex\":1}}", "/from"},
        {"{\"from\":1,\"to\":{\"vertex\":1}}", "/from"},
        {"{\"from\":{\"vertex\":1},\"to\":{\"vertex\":-1}}", "/to/vertex"},
        {"{\"from\":{\"vertex\":1},\"to\":{\"vertex\":1},\"max\":1}", "/max"},
        {"{\"from\":{\"vertex\":1},\"to\":{\"vertex\":1},\"via\":{\"vertex\":1}}", "/via"},
        {"{\"from\":{\"vertex\":1},\"to\":{\"vertex\":1},\"via\":[{\"vertex\":1},{\"edge\":[1]}]}",
         "/via/1/edge"},
    };
    CHECK_REFUSED(decode, struct proto_points, cases)
}

static void parses_query_strings(void **state)
{
    (void)state;
    struct proto_points stops;
    struct proto_problem problem;
    struct proto_parameters parameters =
        QUERY("to", "e:1-2:0.5", "from", "v:0", "via", "v:3;f:1:0.2,0.3,0.5");
    assert_true(proto_pair_parse(&parameters, &stops, &problem));
    assert_int_equal(stops.count, 4);
    assert_true(stops.items[0].form == PROTO_POINT_VERTEX &&
                stops.items[3].form == PROTO_POINT_EDGE);
    assert_true(stops.items[1].form == PROTO_POINT_VERTEX &&
                stops.items[2].form == PROTO_POINT_FACE);
    proto_points_free(&stops);
}

static void refuses_bad_query_strings(void **state)
{
    (void)state;
    static const char *const bad_vias[] = {"", ";", "v:1;", ";v:1", "v:1;;v:2", "v:1,v:2", "v:1;x"};
    struct proto_points stops;
    struct proto_problem problem;
    struct proto_parameters parameters = QUERY("from", "v:0");
    assert_false(proto_pair_parse(&parameters, &stops, &problem));
    assert_parameter(&problem, "to");
    parameters = QUERY("to", "v:0", "from", "0");
    assert_false(proto_pair_parse(&parameters, &stops, &problem));
    assert_parameter(&problem, "from");
    for (size_t i = 0; i < COUNT(bad_vias); i++) {
        parameters = QUERY("from", "v:0", "to", "v:0", "via", bad_vias[i]);
        assert_false(proto_pair_parse(&parameters, &stops, &problem));
        assert_parameter(&problem, "via");
    }
}

static void names_the_missing_point(void **state)
{
    (void)state;
    struct gd_mesh *mesh = new_tetrahedron();
    struct proto_points stops;
    struct proto_located_points located;
    struct proto_problem problem;
    assert_true(decode("{\"from\":{\"vertex\":1},\"to\":{\"vertex\":4}}", &stops, &problem));
    assert_false(proto_points_locate(mesh, &stops, &located, &problem));
    assert_pointer(&problem, "/to");
    proto_points_free(&stops);
    assert_true(decode("{\"from\":{\"vertex\":1},\"to\":{\"vertex\":2},\"via\":[{\"vertex\":9}]}",
                       &stops, &problem));
    assert_false(proto_points_locate(mesh, &stops, &located, &problem));
    assert_pointer(&problem, "/via/0");
    proto_points_free(&stops);
    struct proto_parameters parameters = QUERY("to", "v:0", "from", "v:9");
    assert_true(proto_pair_parse(&parameters, &stops, &problem));
    assert_false(proto_points_locate(mesh, &stops, &located, &problem));
    assert_parameter(&problem, "from");
    proto_points_free(&stops);
    gd_mesh_release(mesh);
}

/* --- the answer ------------------------------------------------------------------------------- */

#define FROM "\"from\":{\"face\":0,\"barycentric\":[1,0,0],\"xyz\":[0,0,0],\"vertex\":0}"
#define TO                                                                                         \
    "\"to\":{\"face\":0,\"barycentric\":[0,0,1],\"xyz\":[1,0,0],\"vertex\":1,\"snap_distance\":1}"
#define PATH                                                                                       \
    "\"path\":{\"length\":1,\"points\":[{\"xyz\":[0,0,0],\"vertex\":0},{\"xyz\":[1,0,0],"          \
    "\"vertex\":1}]}"
#define ALL                                                                                        \
    (PROTO_PATH_FIELD_DISTANCE | PROTO_PATH_FIELD_REASON | PROTO_PATH_FIELD_FROM |                 \
     PROTO_PATH_FIELD_TO | PROTO_PATH_FIELD_VIA | PROTO_PATH_FIELD_PATH)

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
        {1, ALL - PROTO_PATH_FIELD_PATH, PROTO_GEOMETRY_FULL, "{\"distance\":1," FROM "," TO "}"},
        {1, PROTO_PATH_FIELD_PATH, PROTO_GEOMETRY_XYZ,
         "{\"path\":{\"length\":1,\"points\":[[0,0,0],[1,0,0]]}}"},
        {1, PROTO_PATH_FIELD_PATH | PROTO_PATH_FIELD_DISTANCE, PROTO_GEOMETRY_NONE,
         "{\"distance\":1,\"path\":{\"length\":1}}"},
        {1, PROTO_PATH_FIELD_REASON, PROTO_GEOMETRY_FULL, "{}"},
        {INFINITY, ALL, PROTO_GEOMETRY_FULL,
         "{\"distance\":null,\"reason\":\"no_path\"," FROM "," TO ",\"path\":null}"},
        {INFINITY, PROTO_PATH_FIELD_DISTANCE, PROTO_GEOMETRY_FULL,
         "{\"distance\":null,\"reason\":\"no_path\"}"},
        {INFINITY, PROTO_PATH_FIELD_REASON, PROTO_GEOMETRY_FULL, "{\"reason\":\"no_path\"}"},
    };
    struct gd_mesh *mesh = new_tetrahedron();
    struct gd_point points[] = {test_vertex(mesh, 0), test_vertex(mesh, 1)};
    double snaps[] = {NAN, 1};
    struct proto_located_points stops = {
        .mesh = mesh, .points = points, .snaps = snaps, .count = 2};
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct gd_pair_answer answer = {.distance = cases[i].distance};
        if (isfinite(answer.distance))
            answer.path = (struct gd_path){.length = 1, .count = 2, .points = points};
        struct proto_options options = {
            .fields = cases[i].fields, .names = proto_path_fields, .geometry = cases[i].geometry};
        struct proto_writer writer = new_writer();
        proto_pair_encode(&writer, &stops, &answer, &options);
        assert_written(&writer, cases[i].text);
    }
    gd_mesh_release(mesh);
}

static void encodes_stops(void **state)
{
    (void)state;
    struct gd_mesh *mesh = new_tetrahedron();
    struct gd_point points[] = {test_vertex(mesh, 0), test_vertex(mesh, 1), test_vertex(mesh, 2)};
    double snaps[] = {NAN, 1, NAN};
    struct proto_located_points stops = {
        .mesh = mesh, .points = points, .snaps = snaps, .count = 3};
    struct proto_options options = {.fields = PROTO_PATH_FIELD_VIA, .names = proto_path_fields};
    struct gd_pair_answer answer = {.distance = 2};
    struct proto_writer writer = new_writer();
    proto_pair_encode(&writer, &stops, &answer, &options);
    assert_written(&writer,
                   "{\"via\":[{\"face\":0,\"barycentric\":[0,0,1],\"xyz\":[1,0,0],\"vertex\":1,"
                   "\"snap_distance\":1}]}");
    gd_mesh_release(mesh);
}

static void names_its_fields_in_the_order_of_the_bits(void **state)
{
    (void)state;
    struct proto_options options;
    struct proto_problem problem;
    struct proto_parameters parameters = QUERY("select", "path,distance");
    assert_true(proto_options_parse(&parameters, proto_path_fields, proto_get_path_parameters,
                                    &options, &problem));
    assert_int_equal(options.fields, PROTO_PATH_FIELD_PATH | PROTO_PATH_FIELD_DISTANCE);
    assert_false(proto_options_parse(&parameters, proto_distance_fields,
                                     proto_get_distance_parameters, &options, &problem));
    assert_parameter(&problem, "select");
    parameters = QUERY("select", "from,to,reason,via");
    assert_true(proto_options_parse(&parameters, proto_distance_fields,
                                    proto_get_distance_parameters, &options, &problem));
    assert_int_equal(options.fields, PROTO_PATH_FIELD_FROM | PROTO_PATH_FIELD_TO |
                                         PROTO_PATH_FIELD_REASON | PROTO_PATH_FIELD_VIA);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(decodes_bodies),
        cmocka_unit_test(decodes_stops_in_order_of_the_path),
        cmocka_unit_test(refuses_bad_bodies),
        cmocka_unit_test(parses_query_strings),
        cmocka_unit_test(refuses_bad_query_strings),
        cmocka_unit_test(names_the_missing_point),
        cmocka_unit_test(encodes_answers),
        cmocka_unit_test(encodes_stops),
        cmocka_unit_test(names_its_fields_in_the_order_of_the_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
