#include "support.h"

#include "proto/queries/subdivision.h"
#include "proto/values/usd.h"

static void reads_options(void **state)
{
    (void)state;
    struct proto_subdivision_options options;
    struct proto_problem problem;
    struct proto_parameters query = NO_QUERY;
    assert_true(proto_subdivision_options_parse(&query, &options, &problem));
    assert_true(options.format == GD_FORMAT_ANY && !options.has_scheme &&
                options.scheme == GD_SCHEME_CATMULL_CLARK);
    query = QUERY("format", "json", "scheme", "loop");
    assert_true(proto_subdivision_options_parse(&query, &options, &problem));
    assert_true(options.format == GD_FORMAT_JSON && options.has_scheme &&
                options.scheme == GD_SCHEME_LOOP);
    query = QUERY("format", "obj");
    assert_true(proto_subdivision_options_parse(&query, &options, &problem) &&
                options.format == GD_FORMAT_OBJ);
    query = QUERY("scheme", "bilinear");
    assert_false(proto_subdivision_options_parse(&query, &options, &problem));
    assert_parameter(&problem, "scheme");
    query = QUERY("weld", "1");
    assert_false(proto_subdivision_options_parse(&query, &options, &problem));
    assert_parameter(&problem, "weld");
}

#define POINTS "\"points\":[[0,0,0],[1,0,0],[1,1,0],[0,1,0],[2,0,0]]"
#define FACES  "\"faceVertexCounts\":[4,3],\"faceVertexIndices\":[0,1,2,3,1,4,2]"

static bool read(const char *text, const struct gd_read_options *limits, struct proto_usd *out,
                 struct proto_problem *problem)
{
    return proto_usd_read(text, strlen(text), limits, out, problem);
}

static void reads_usd(void **state)
{
    (void)state;
    struct proto_usd usd;
    struct proto_problem problem;
    const char text[] =
        "{" POINTS "," FACES ",\"creaseIndices\":[0,1,2,3,0],\"creaseLengths\":[3,2],"
        "\"creaseSharpnesses\":[1.5,10],\"cornerIndices\":[4],\"cornerSharpnesses\":[2],"
        "\"interpolateBoundary\":\"edgeOnly\",\"subdivisionScheme\":\"loop\"}";
    assert_true(proto_usd_is(text, strlen(text)));
    assert_false(proto_usd_is("{\"vertices\":[],\"faces\":[]}", 25));
    assert_false(proto_usd_is(NULL, 0));
    assert_true(read(text, NULL, &usd, &problem));
    const struct gd_control_mesh *mesh = &usd.control_mesh;
    assert_true(mesh->polygons.position_count == 5 && mesh->polygons.polygon_count == 2);
    assert_true(gd_polygons_first(&mesh->polygons, 1) == 4 &&
                gd_polygons_corner_count(&mesh->polygons) == 7);
    assert_int_equal(mesh->crease_count, 3);
    assert_true(mesh->creases[1].vertices[0] == 1 && mesh->creases[1].vertices[1] == 2);
    assert_true(mesh->creases[1].sharpness == 1.5 && mesh->creases[2].sharpness == 10);
    assert_true(mesh->creases[2].vertices[0] == 3 && mesh->creases[2].vertices[1] == 0);
    assert_true(mesh->corner_count == 1 && mesh->corners[0].vertex == 4 &&
                mesh->corners[0].sharpness == 2);
    assert_true(mesh->boundary == GD_INTERPOLATE_EDGE_ONLY && usd.has_scheme &&
                usd.scheme == GD_SCHEME_LOOP);
    gd_control_mesh_free(&usd.control_mesh);
    assert_true(
        read("{" POINTS "," FACES
             ",\"creaseIndices\":[0,1,2],\"creaseLengths\":[3],\"creaseSharpnesses\":[1,2]}",
             NULL, &usd, &problem));
    assert_true(usd.control_mesh.creases[0].sharpness == 1 &&
                usd.control_mesh.creases[1].sharpness == 2);
    assert_true(usd.control_mesh.boundary == GD_INTERPOLATE_EDGE_AND_CORNER && !usd.has_scheme);
    gd_control_mesh_free(&usd.control_mesh);
}

static void refuses_bad_usd(void **state)
{
    (void)state;
    static const struct {
        const char *text, *pointer;
    } cases[] = {
        {"[]", ""},
        {"{" FACES "}", "/points"},
        {"{\"points\":5," FACES "}", "/points"},
        {"{\"points\":[[0,0,0],[1,\"0\",0]]," FACES "}", "/points/1"},
        {"{" POINTS "}", "/faceVertexCounts"},
        {"{" POINTS ",\"faceVertexCounts\":[4],\"faceVertexIndices\":[0,1,2]}",
         "/faceVertexCounts"},
        {"{" POINTS ",\"faceVertexCounts\":[4294967294,3],\"faceVertexIndices\":[0,1,2]}",
         "/faceVertexCounts"},
        {"{" POINTS "," FACES
         ",\"creaseIndices\":[0,1],\"creaseLengths\":[4294967294,2],\"creaseSharpnesses\":[1]}",
         "/creaseLengths"},
        {"{" POINTS "," FACES
         ",\"creaseIndices\":[0,1,2],\"creaseLengths\":[2,1],\"creaseSharpnesses\":[1,1]}",
         "/creaseLengths/1"},
        {"{" POINTS "," FACES ",\"cornerIndices\":[1.5]}", "/cornerIndices/0"},
        {"{" POINTS "," FACES ",\"interpolateBoundary\":1}", "/interpolateBoundary"},
        {"{" POINTS "," FACES ",\"subdivisionScheme\":\"bilinear\"}", "/subdivisionScheme"},
        {"{" POINTS "," FACES ",\"holeIndices\":[0]}", "/holeIndices"},
    };
    struct proto_usd usd;
    struct proto_problem problem;
    for (size_t i = 0; i < COUNT(cases); i++) {
        assert_false(read(cases[i].text, NULL, &usd, &problem));
        assert_pointer(&problem, cases[i].pointer);
    }
    assert_false(read("{" POINTS ",\"faceVertexCounts\":[3],\"faceVertexIndices\":[0,1,5]}", NULL,
                      &usd, &problem));
    assert_true(problem.code == PROTO_PROBLEM_INVALID_MESH && strcmp(problem.reason, "index") == 0);
    assert_false(read("{" POINTS ",\"faceVertexCounts\":[],\"faceVertexIndices\":[]}", NULL, &usd,
                      &problem));
    assert_string_equal(problem.reason, "empty");
    assert_false(
        read("{" POINTS "," FACES "}", &(struct gd_read_options){.max_faces = 2}, &usd, &problem));
    assert_true(problem.code == PROTO_PROBLEM_TOO_LARGE && problem.limit == 2);
    assert_false(read("{" POINTS "," FACES "}", &(struct gd_read_options){.max_vertices = 4}, &usd,
                      &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_TOO_LARGE);
}

/* A tag with an invalid index is an error of the file, not of the request. */
static void reports_errors_of_the_file(void **state)
{
    (void)state;
    struct gd_detail detail = {0};
    struct proto_problem problem;
    (void)gd_fail(&detail, GD_NO_SUCH_EDGE, "the crease 0-7 is no edge");
    assert_false(proto_subdivision_refuse(GD_NO_SUCH_EDGE, &detail, &problem));
    assert_true(problem.code == PROTO_PROBLEM_INVALID_MESH &&
                strcmp(problem.reason, "no_such_edge") == 0);
    assert_string_equal(problem.detail, "the crease 0-7 is no edge");
    assert_false(proto_subdivision_refuse(GD_DEADLINE, NULL, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_DEADLINE_EXCEEDED);
}

static void encodes_descriptions(void **state)
{
    (void)state;
    struct proto_usd usd;
    struct proto_problem problem;
    struct gd_subdivision *surface;
    assert_true(read("{" POINTS "," FACES "}", NULL, &usd, &problem));
    assert_int_equal(
        gd_subdivision_create(&usd.control_mesh, GD_SCHEME_CATMULL_CLARK, NULL, &surface, NULL),
        GD_OK);
    const struct proto_subdivision_description description = {.name = "s",
                                                              .sha256 = "00",
                                                              .etag = "e",
                                                              .memory_bytes = 7,
                                                              .surface = surface,
                                                              .summary =
                                                                  gd_subdivision_summary(surface)};
    struct proto_writer writer = new_writer();
    proto_subdivision_encode(&writer, &description);
    assert_written(&writer,
                   "{\"name\":\"s\",\"sha256\":\"00\",\"scheme\":\"catmull_clark\",\"vertices\":5,"
                   "\"edges\":6,\"faces\":2,"
                   "\"extraordinary_vertices\":[],\"crease_edges\":0,\"corner_vertices\":0,"
                   "\"boundary_edges\":5,"
                   "\"boundaries\":1,\"least_level\":1,\"usual_level\":7,\"memory_bytes\":7,"
                   "\"created\":\"1970-01-01T00:00:00Z\",\"etag\":\"e\"}");
    gd_subdivision_release(surface);
    gd_control_mesh_free(&usd.control_mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(reads_options), cmocka_unit_test(reads_usd),
                                       cmocka_unit_test(refuses_bad_usd),
                                       cmocka_unit_test(reports_errors_of_the_file),
                                       cmocka_unit_test(encodes_descriptions)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
