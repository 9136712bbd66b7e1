#include "support.h"

#include "proto/values/mesh.h"
#include "proto/http/page.h"

/* --- name ------------------------------------------------------------------------------------- */

static bool is_name(const char *name)
{
    struct proto_problem problem = {0};
    bool good = proto_mesh_name_check(name, strlen(name), &problem);
    assert_int_equal(problem.code, good ? PROTO_PROBLEM_NONE : PROTO_PROBLEM_INVALID_REQUEST);
    return good;
}

static void checks_names(void **state)
{
    (void)state;
    static const char *const good[] = {"a",     "Z",         "0",    "_",   "-",
                                       "bunny", "bunny.obj", "a..b", "-._", "A-Z_0.9"};
    static const char *const bad[] = {"",    ".",    "..",   ".hidden",     "a b",
                                      "a/b", "a%20", "a\n",  "caf\xc3\xa9", "a:b",
                                      "a~",  "\x7f", "a\\b", "a+b"};
    for (size_t i = 0; i < COUNT(good); i++) assert_true(is_name(good[i]));
    for (size_t i = 0; i < COUNT(bad); i++) assert_false(is_name(bad[i]));
    char longest[PROTO_MESH_NAME + 2];
    memset(longest, 'x', sizeof longest);
    struct proto_problem problem;
    assert_true(proto_mesh_name_check(longest, PROTO_MESH_NAME, &problem));
    assert_false(proto_mesh_name_check(longest, PROTO_MESH_NAME + 1, &problem));
    assert_false(proto_mesh_name_check("a\0b", 3, &problem));
}

/* --- upload ----------------------------------------------------------------------------------- */

static void assert_options(struct proto_parameters parameters,
                           const struct proto_mesh_options *expected)
{
    struct proto_mesh_options options;
    struct proto_problem problem;
    assert_true(proto_mesh_options_parse(&parameters, &options, &problem));
    assert_int_equal(options.format, expected->format);
    assert_int_equal(options.build.refuse_polygons, expected->build.refuse_polygons);
    assert_int_equal(options.build.repair_split, expected->build.repair_split);
    assert_int_equal(options.build.weld, expected->build.weld);
    assert_true(options.build.weld_tolerance == expected->build.weld_tolerance);
}

#define OPTIONS(...) (&(struct proto_mesh_options){__VA_ARGS__})

static void reads_upload_options(void **state)
{
    (void)state;
    assert_options(NO_QUERY, OPTIONS(.format = GD_FORMAT_ANY));
    assert_options(QUERY("format", "stl"), OPTIONS(.format = GD_FORMAT_STL));
    assert_options(QUERY("triangulate", "false"), OPTIONS(.build = {.refuse_polygons = true}));
    assert_options(QUERY("triangulate", "true"), OPTIONS(.format = GD_FORMAT_ANY));
    assert_options(QUERY("format", "ply", "triangulate", "false", "repair", "none"),
                   OPTIONS(.format = GD_FORMAT_PLY, .build = {.refuse_polygons = true}));
}

static void reads_weld_and_repair(void **state)
{
    (void)state;
    assert_options(QUERY("weld", "0"), OPTIONS(.build = {.weld = true}));
    assert_options(QUERY("repair", "split"), OPTIONS(.build = {.repair_split = true}));
    assert_options(QUERY("weld", "1e-3", "repair", "split"),
                   OPTIONS(.build = {.weld = true, .weld_tolerance = 1e-3, .repair_split = true}));
}

static void refuses_bad_upload_options(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"format", "3ds"},    {"format", ""},      {"weld", "-0.1"},   {"weld", ""},
        {"weld", "1e999"},    {"weld", "nan"},     {"weld", "0.1mm"},  {"weld", " 1"},
        {"repair", "Split"},  {"repair", "all"},   {"repair", ""},     {"triangulate", "yes"},
        {"triangulate", "1"}, {"triangulate", ""}, {"fields", "name"}, {"Format", "obj"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_mesh_options options;
        struct proto_problem problem;
        struct proto_parameters parameters = QUERY(cases[i][0], cases[i][1]);
        assert_false(proto_mesh_options_parse(&parameters, &options, &problem));
        assert_parameter(&problem, cases[i][0]);
    }
}

static void finds_the_format_of_an_upload(void **state)
{
    (void)state;
    static const char ply[] = "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n";
    static const char none[] = "\x01\x02\x03";
    struct proto_mesh_options options = {.format = GD_FORMAT_OFF};
    assert_int_equal(proto_mesh_upload_format(&options, ply, sizeof ply - 1, "model/obj"),
                     GD_FORMAT_OFF);
    options.format = GD_FORMAT_ANY;
    assert_int_equal(proto_mesh_upload_format(&options, ply, sizeof ply - 1, "model/obj"),
                     GD_FORMAT_PLY);
    assert_int_equal(proto_mesh_upload_format(&options, none, sizeof none - 1, "model/obj"),
                     GD_FORMAT_OBJ);
    assert_int_equal(proto_mesh_upload_format(&options, none, sizeof none - 1, "image/png"),
                     GD_FORMAT_ANY);
    assert_int_equal(proto_mesh_upload_format(&options, none, sizeof none - 1, NULL),
                     GD_FORMAT_ANY);
}

/* --- content ---------------------------------------------------------------------------------- */

static void chooses_the_format_to_send(void **state)
{
    (void)state;
    static const struct {
        const char *accept;
        enum gd_format format;
    } cases[] = {
        {NULL, GD_FORMAT_OBJ},
        {"*/*", GD_FORMAT_OBJ},
        {"model/*", GD_FORMAT_OBJ},
        {"model/stl", GD_FORMAT_STL},
        {"application/x-ply, */*;q=0.1", GD_FORMAT_PLY},
        {"text/*", GD_FORMAT_OFF},
        {"model/gltf-binary", GD_FORMAT_GLB},
        {"model/gltf+json, model/gltf-binary;q=0.9", GD_FORMAT_GLTF},
        {"application/json, text/plain, */*", GD_FORMAT_OBJ},
        {"model/obj;q=0, model/stl;q=0.5, text/x-off;q=0.6", GD_FORMAT_OFF},
    };
    struct proto_problem problem;
    enum gd_format format = GD_FORMAT_ANY;
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_parameters parameters = NO_QUERY;
        assert_true(proto_mesh_content_format(&parameters, cases[i].accept, &format, &problem));
        assert_int_equal(format, cases[i].format);
    }
    struct proto_parameters parameters = QUERY("format", "off");
    assert_true(proto_mesh_content_format(&parameters, "model/stl", &format, &problem));
    assert_int_equal(format, GD_FORMAT_OFF);
}

static void refuses_other_media_types(void **state)
{
    (void)state;
    struct proto_problem problem;
    enum gd_format format = GD_FORMAT_STL;
    struct proto_parameters parameters = NO_QUERY;
    assert_false(
        proto_mesh_content_format(&parameters, "image/png, application/json", &format, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_NOT_ACCEPTABLE);
    static const char *const cases[][2] = {{"format", "json"}, {"format", "x"}, {"weld", "1"}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        parameters = QUERY(cases[i][0], cases[i][1]);
        assert_false(proto_mesh_content_format(&parameters, NULL, &format, &problem));
        assert_parameter(&problem, cases[i][0]);
    }
    assert_int_equal(format, GD_FORMAT_STL);
}

/* --- description ------------------------------------------------------------------------------ */

#define NOT_REPAIRED                                                                               \
    "\"repair\":{\"edges_split\":0,\"vertices_split\":0,\"vertices_welded\":0,\"vertices_"         \
    "merged\":0,"                                                                                  \
    "\"duplicate_faces\":0,\"degenerate_faces\":0,\"edges_flipped\":0,\"faces_cut\":0,\"lines_"    \
    "skipped\":0,"                                                                                 \
    "\"largest_shift\":0,"                                                                         \
    "\"vertices_copied\":0,"                                                                       \
    "\"copies\":[],\"first\":{}}"

#define DESCRIPTION                                                                                \
    "{\"name\":\"corner\",\"sha256\":\"ab12\",\"index_count\":5,\"vertices\":4,\"faces\":3,"       \
    "\"edges\":6,"                                                                                 \
    "\"components\":1,"                                                                            \
    "\"boundary_count\":1,\"boundaries\":[{\"vertices\":3,\"length\":3.414213562373095}],\"euler_" \
    "characteristic\":1,"                                                                          \
    "\"genus\":0,"                                                                                 \
    "\"orientation\":{\"flipped_faces\":1},\"area\":1.8660254037844386,\"bounding_box\":{\"min\":" \
    "[0,0,0],\"max\":[1,"                                                                          \
    "1,1]},"                                                                                       \
    "\"edge_length\":{\"min\":1,\"mean\":1.2071067811865475,\"max\":1.4142135623730951},"          \
    "\"degenerate_faces\":0,"                                                                      \
    "\"saddle_vertices\":0,"                                                                       \
    "\"unreferenced_vertices\":1," NOT_REPAIRED ",\"memory_bytes\":4096,\"fields_"                 \
    "cached\":2,"                                                                                  \
    "\"created\":\"2026-11-21T12:34:56Z\",\"etag\":\"1f0c\"}"

/* Builds the tetrahedron without its last face. One face is reversed, and one vertex is unused. */
static struct gd_mesh *new_corner(void)
{
    static double positions[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {9, 9, 9}};
    static uint32_t corners[] = {0, 2, 1, 0, 3, 1, 1, 2, 3};
    const struct gd_polygons polygons = {
        .positions = positions, .position_count = 5, .polygon_count = 3, .corners = corners};
    struct gd_mesh *mesh = NULL;
    assert_int_equal(gd_mesh_build(&polygons, NULL, NULL, &mesh, NULL), GD_OK);
    return mesh;
}

static void describes_meshes(void **state)
{
    (void)state;
    struct gd_mesh *mesh = new_corner();
    const struct proto_mesh_description description = {.name = "corner",
                                                       .sha256 = "ab12",
                                                       .created = 1795264496,
                                                       .etag = "1f0c",
                                                       .fields_cached = 2,
                                                       .memory_bytes = 4096,
                                                       .mesh = mesh};
    struct proto_writer writer = new_writer();
    proto_mesh_encode(&writer, &description);
    assert_written(&writer, DESCRIPTION);

    writer = new_writer();
    proto_page_begin(&writer, "meshes");
    proto_mesh_encode(&writer, &description);
    proto_mesh_encode(&writer, &description);
    proto_page_end(&writer, "corner");
    assert_written(&writer, "{\"meshes\":[" DESCRIPTION "," DESCRIPTION "],\"next\":\"corner\"}");
    gd_mesh_release(mesh);

    writer = new_writer();
    proto_page_begin(&writer, "meshes");
    proto_page_end(&writer, NULL);
    assert_written(&writer, "{\"meshes\":[],\"next\":null}");
}

/* Uses two triangles that share only vertex 0, a duplicate of one of these triangles, and a
 * triangle without area. */
static void describes_repairs(void **state)
{
    (void)state;
    static double positions[6][3] = {{0, 0, 0},  {1, 0, 0},  {1, 1, 0},
                                     {-1, 0, 0}, {-1, 1, 0}, {-1, 1, 0}};
    static uint32_t corners[] = {0, 1, 2, 0, 3, 4, 3, 4, 5, 2, 1, 0};
    const struct gd_polygons polygons = {
        .positions = positions, .position_count = 6, .polygon_count = 4, .corners = corners};
    const struct gd_mesh_options options = {.repair_split = true};
    struct gd_mesh *mesh = NULL;
    assert_int_equal(gd_mesh_build(&polygons, &options, NULL, &mesh, NULL), GD_OK);
    struct proto_mesh_description description = {
        .name = "mended", .sha256 = "", .etag = "", .mesh = mesh};
    struct proto_writer writer = new_writer();
    proto_mesh_encode(&writer, &description);
    size_t size = 0;
    char *text = proto_writer_take(&writer, &size);
    static const char expected[] =
        "\"repair\":{\"edges_split\":0,\"vertices_split\":1,\"vertices_welded\":0,\"vertices_"
        "merged\":1,"
        "\"duplicate_faces\":1,\"degenerate_faces\":1,\"edges_flipped\":0,\"faces_cut\":0,\"lines_"
        "skipped\":0,"
        "\"largest_shift\":0,"
        "\"vertices_copied\":1,"
        "\"copies\":[[6,0]],\"first\":{\"vertices_split\":[[0,1]],\"vertices_merged\":[[5,4]],"
        "\"duplicate_faces\":[[3,0]],\"degenerate_faces\":[2]}}";
    if (!memmem(text, size, expected, strlen(expected))) fail_msg("%.*s", (int)size, text);
    free(text);
    gd_mesh_release(mesh);
}

/* Builds `count` separate triangles. Each triangle has its own boundary. */
static struct gd_mesh *build_loose_triangles(uint32_t count)
{
    double(*positions)[3] = calloc(3 * count, sizeof *positions);
    uint32_t *corners = calloc(3 * count, sizeof *corners);
    struct gd_mesh *mesh = NULL;
    for (uint32_t i = 0; i < 3 * count; i++) {
        positions[i][0] = i / 3 * 2 + (i % 3 == 1), positions[i][1] = i % 3 == 2;
        corners[i] = i;
    }
    const struct gd_polygons polygons = {.positions = positions,
                                         .position_count = 3 * count,
                                         .polygon_count = count,
                                         .corners = corners};
    assert_int_equal(gd_mesh_build(&polygons, &(struct gd_mesh_options){0}, NULL, &mesh, NULL),
                     GD_OK);
    free(positions);
    free(corners);
    return mesh;
}

static char *text_of(struct proto_writer *writer)
{
    size_t size = 0;
    proto_append(writer, "", 1);
    return proto_writer_take(writer, &size);
}

static uint32_t count_of(const char *text, const char *word)
{
    uint32_t count = 0;
    while ((text = strstr(text, word))) count++, text++;
    return count;
}

#define LOOP "{\"vertices\":3,\"length\":3.414213562373095}"

static void long_lists_of_boundaries_are_cut(void **state)
{
    (void)state;
    struct gd_mesh *mesh = build_loose_triangles(250);
    const struct proto_mesh_description description = {
        .name = "loose", .sha256 = "", .etag = "", .mesh = mesh};
    struct proto_writer writer = new_writer();
    proto_mesh_encode(&writer, &description);
    char *text = text_of(&writer);
    assert_non_null(strstr(text, "\"boundary_count\":250,"));
    assert_int_equal(count_of(text, LOOP), PROTO_MESH_BOUNDARIES);
    assert_null(proto_mesh_shorten(text)); /* the text is short already */
    free(text);
    gd_mesh_release(mesh);
}

static void boundaries_come_by_page(void **state)
{
    (void)state;
    static const struct {
        int64_t after;
        uint32_t limit, count;
        const char *next;
    } pages[] = {{-1, 100, 3, "null"}, {-1, 3, 3, "null"}, {-1, 2, 2, "\"1\""},
                 {1, 2, 1, "null"},    {2, 2, 0, "null"},  {INT64_MAX, 1000, 0, "null"}};
    struct gd_mesh *mesh = build_loose_triangles(3);
    for (size_t i = 0; i < COUNT(pages); i++) {
        char next[32];
        struct proto_writer writer = new_writer();
        proto_boundaries_encode(&writer, mesh, pages[i].after, pages[i].limit);
        char *text = text_of(&writer);
        assert_int_equal(count_of(text, LOOP), pages[i].count);
        snprintf(next, sizeof next, "\"next\":%s}", pages[i].next);
        assert_non_null(strstr(text, next));
        free(text);
    }
    gd_mesh_release(mesh);
}

static void long_descriptions_of_old_records_are_shortened(void **state)
{
    (void)state;
    struct proto_writer writer = new_writer();
    proto_append_format(&writer, "{\"name\":\"old\",\"boundaries\":[" LOOP);
    for (int i = 1; i < 300; i++) proto_append_format(&writer, "," LOOP);
    proto_append_format(&writer, "],\"area\":0.1}");
    char *text = text_of(&writer), *shortened = proto_mesh_shorten(text);
    assert_int_equal(count_of(shortened, "{\"vertices\":3,"), PROTO_MESH_BOUNDARIES);
    assert_non_null(strstr(shortened, "\"name\":\"old\""));
    assert_non_null(strstr(shortened, "\"boundary_count\":300"));
    assert_non_null(strstr(shortened, "\"area\":0.1"));
    free(shortened);
    free(text);
    assert_null(proto_mesh_shorten("{\"boundaries\":"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(checks_names),
        cmocka_unit_test(reads_upload_options),
        cmocka_unit_test(reads_weld_and_repair),
        cmocka_unit_test(refuses_bad_upload_options),
        cmocka_unit_test(finds_the_format_of_an_upload),
        cmocka_unit_test(chooses_the_format_to_send),
        cmocka_unit_test(refuses_other_media_types),
        cmocka_unit_test(describes_meshes),
        cmocka_unit_test(describes_repairs),
        cmocka_unit_test(long_lists_of_boundaries_are_cut),
        cmocka_unit_test(boundaries_come_by_page),
        cmocka_unit_test(long_descriptions_of_old_records_are_shortened),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
