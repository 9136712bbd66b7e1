#include "support.h"

#include <math.h>

#include "proto/queries/field.h"
#include "proto/http/page.h"

DECODER(decode_whole, struct proto_field_request, proto_field_request_decode)

/* Decodes a request and releases its set, so that the tests need not release it. */
static bool decode(const char *text, struct proto_field_request *out, struct proto_problem *problem)
{
    bool decoded = decode_whole(text, out, problem);
    if (decoded) proto_set_free(&out->set);
    return decoded;
}

static void decodes_requests(void **state)
{
    (void)state;
    struct proto_field_request request;
    struct proto_problem problem;
    assert_true(decode("{\"set\":{\"points\":[{\"vertex\":1}]}}", &request, &problem));
    assert_true(request.max_distance == 0);
    assert_true(
        decode("{\"max_distance\":0.5,\"set\":{\"points\":[{\"vertex\":1}]}}", &request, &problem));
    assert_true(request.max_distance == 0.5);
}

static void refuses_bad_requests(void **state)
{
    (void)state;
    static const struct refusal cases[] = {
        {"[]", ""},
        {"{}", "/set"},
        {"{\"set\":{\"points\":[{\"vertex\":1}]},\"radius\":1}", "/radius"},
        {"{\"set\":{\"points\":[{\"vertex\":1}]},\"max_distance\":0}", "/max_distance"},
        {"{\"set\":{\"points\":[{\"vertex\":1}]},\"max_distance\":-1}", "/max_distance"},
        {"{\"set\":{\"points\":[{\"vertex\":1}]},\"max_distance\":null}", "/max_distance"},
        {"{\"set\":{\"points\":[{\"vertex\":1.5}]}}", "/set/points/0/vertex"},
    };
    CHECK_REFUSED(decode, struct proto_field_request, cases)
}

static void encodes_descriptions(void **state)
{
    (void)state;
    struct gd_mesh *mesh = new_tetrahedron();
    struct proto_field_description description = {
        .id = "0123", .wedges = 7, .bytes = 900, .build_ms = 0.25, .members = 2, .max = 1.5};
    assert_int_equal(gd_point_at_vertex(mesh, (struct gd_vertex){1}, &description.farthest, NULL),
                     GD_OK);
    struct proto_writer writer = new_writer();
    proto_field_encode(&writer, mesh, &description, PROTO_FIELD_FIELD_ALL);
    assert_written(
        &writer,
        "{\"id\":\"0123\",\"wedges\":7,\"bytes\":900,\"build_ms\":0.25,\"max\":1.5,\"farthest\":"
        "{\"face\":0,\"barycentric\":[0,0,1],\"xyz\":[1,0,0],\"vertex\":1},\"members\":2,"
        "\"max_distance\":null,\"set\":null,\"created\":\"1970-01-01T00:00:00Z\"}");
    description.uses = 3;
    description.set = "{\"points\":[\"v:1\"]}";
    proto_page_begin(&writer, "fields");
    proto_field_encode_listed(&writer, mesh, &description);
    proto_page_end(&writer, NULL);
    assert_non_null(strstr(writer.data, "\"set\":{\"points\":[\"v:1\"]},\"created\":"));
    assert_non_null(strstr(writer.data, ",\"uses\":3}]"));
    proto_writer_free(&writer);
    writer = new_writer();
    description.max = NAN;
    description.max_distance = 0.5;
    proto_field_encode(&writer, mesh, &description,
                       PROTO_FIELD_FIELD_MAX | PROTO_FIELD_FIELD_FARTHEST |
                           PROTO_FIELD_FIELD_MAX_DISTANCE);
    assert_written(
        &writer,
        "{\"max\":null,\"reason\":\"beyond_max_distance\",\"farthest\":null,\"max_distance\":0.5}");
    proto_page_begin(&writer, "fields");
    proto_field_encode(&writer, mesh, &description, PROTO_FIELD_FIELD_ID);
    proto_field_encode(&writer, mesh, &description, PROTO_FIELD_FIELD_ID);
    proto_page_end(&writer, "0123");
    assert_written(&writer, "{\"fields\":[{\"id\":\"0123\"},{\"id\":\"0123\"}],\"next\":\"0123\"}");
    gd_mesh_release(mesh);
}

static void writes_values(void **state)
{
    (void)state;
    struct proto_writer writer = new_writer();
    proto_values_encode(&writer, (const double[]){0, 0.5, INFINITY, NAN}, 4);
    assert_written(&writer, "{\"values\":[0,0.5,null,null]}");
}

static void an_edge_is_two_vertices(void **state)
{
    (void)state;
    static const char *const wrong[] = {"3",    "3-",   "-3",           "3-x", "3-4-5",
                                        "3-4 ", "03-4", "4294967295-1", "3:4"};
    struct proto_parameters parameters = QUERY("edge", "9-3");
    struct proto_problem problem;
    struct gd_vertex ends[2];
    assert_true(proto_wedges_parse(&parameters, ends, &problem));
    assert_true(ends[0].index == 3 && ends[1].index == 9);
    parameters = NO_QUERY;
    assert_false(proto_wedges_parse(&parameters, ends, &problem));
    assert_parameter(&problem, "edge");
    for (size_t i = 0; i < COUNT(wrong); i++) {
        parameters = QUERY("edge", wrong[i]);
        assert_false(proto_wedges_parse(&parameters, ends, &problem));
        assert_parameter(&problem, "edge");
    }
}

static void writes_wedges(void **state)
{
    (void)state;
    const struct gd_vertex ends[2] = {{3}, {9}};
    const struct gd_wedge wedges[2] = {{.b0 = 0,
                                        .b1 = 1,
                                        .d0 = 2,
                                        .d1 = 3,
                                        .sigma = 4,
                                        .tau = true,
                                        .at_vertex = true,
                                        .source = 5},
                                       {.b0 = 1, .b1 = 2, .d0 = 3, .d1 = 4, .source = 6}};
    struct proto_writer writer = new_writer();
    proto_wedges_encode(&writer, ends, wedges, 2, UINT32_MAX);
    assert_written(
        &writer,
        "{\"edge\":[3,9],\"wedges\":[{\"b0\":0,\"b1\":1,\"d0\":2,\"d1\":3,\"sigma\":4,\"tau\":true,"
        "\"source\":{\"vertex\":5}},{\"b0\":1,\"b1\":2,\"d0\":3,\"d1\":4,\"sigma\":0,\"tau\":false,"
        "\"source\":{\"member\":6}}]}");
    proto_wedges_encode(&writer, ends, wedges, 0, PROTO_WEDGES_FIELD_WEDGES);
    assert_written(&writer, "{\"wedges\":[]}");
}

/* Strict clients read an index as an integer, so it has no fraction. */
static void a_set_is_written_in_the_form_of_requests(void **state)
{
    (void)state;
    static const char set[] =
        "{\"points\":[\"v:1\",{\"vertex\":5,\"offset\":0.1,\"label\":\"a\\\"\\\\b\"}],"
        "\"curves\":[{\"vertices\":[0,4294967294],\"closed\":true}],"
        "\"boundaries\":[],\"x\\n\":null}";
    json_t *document = parse(set);
    char *text;
    assert_true(proto_field_write_set(document, &text));
    json_t *again = parse(text);
    assert_true(json_equal(document, again));
    assert_non_null(strstr(text, "{\"vertex\":5,\"offset\":0.1,\"label\":\"a\\\"\\\\b\"}"));
    assert_non_null(strstr(text, "[0,4294967294]"));
    free(text);
    json_decref(again);
    json_decref(document);
}

static void a_long_set_is_not_written(void **state)
{
    (void)state;
    char label[PROTO_FIELD_SET + 1], *text;
    /* {"label":"aaa"} has 12 characters besides the letters a */
    for (size_t size = PROTO_FIELD_SET - 12; size <= PROTO_FIELD_SET - 11; size++) {
        memset(label, 'a', size);
        json_t *document = json_pack("{s:s#}", "label", label, (int)size);
        assert_true(proto_field_write_set(document, &text));
        assert_int_equal(text != NULL, size == PROTO_FIELD_SET - 12);
        free(text);
        json_decref(document);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(decodes_requests),
        cmocka_unit_test(refuses_bad_requests),
        cmocka_unit_test(encodes_descriptions),
        cmocka_unit_test(writes_values),
        cmocka_unit_test(an_edge_is_two_vertices),
        cmocka_unit_test(writes_wedges),
        cmocka_unit_test(a_set_is_written_in_the_form_of_requests),
        cmocka_unit_test(a_long_set_is_not_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
