#include "tests/samples/samples.h"
#include "tests/unit/io/reading.h"

static enum gd_status read_text(const char *text, enum gd_format format,
                                const struct gd_read_options *limits, struct gd_detail *detail)
{
    struct gd_polygons polygons = {0};
    enum gd_status status = read_copy(text, strlen(text), format, limits, &polygons, detail);
    gd_polygons_free(&polygons);
    return status;
}

static void refuses_other_content(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    struct gd_detail detail;
    assert_int_equal(gd_read_polygons(NULL, 0, NULL, &polygons, &detail), GD_EMPTY);
    assert_int_equal(gd_read_polygons(NULL, 0, &(struct gd_read_options){.format = GD_FORMAT_OBJ},
                                      &polygons, NULL),
                     GD_EMPTY);
    assert_int_equal(read_text("<html>", GD_FORMAT_ANY, NULL, &detail), GD_UNRECOGNIZED);
    assert_int_equal(detail.total, 0);
    assert_int_equal(read_text("<html>", (enum gd_format)99, NULL, NULL), GD_UNRECOGNIZED);
}

/* Each mesh has six vertices, two quadrilaterals and one triangle. Triangulated, it has five
 * triangles. */
static const char *const meshes[] = {
    [GD_FORMAT_OBJ] =
        "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nf 1 2 5 4\nf 2 3 6 5\nf 1 2 3\n",
    [GD_FORMAT_OFF] =
        "OFF\n6 3 0\n0 0 0\n1 0 0\n2 0 0\n0 1 0\n1 1 0\n2 1 0\n4 0 1 4 3\n4 1 2 5 4\n3 0 1 2\n",
    [GD_FORMAT_PLY] = "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float "
                      "y\nproperty float z\nelement face "
                      "3\n"
                      "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n2 0 0\n0 "
                      "1 0\n1 1 0\n2 1 0\n4 0 1 4 3\n"
                      "4 1 2 5 4\n3 0 1 2\n",
    [GD_FORMAT_JSON] = "{\"vertices\":[[0,0,0],[1,0,0],[2,0,0],[0,1,0],[1,1,0],[2,1,0]],\"faces\":["
                       "[0,1,4,3],[1,2,5,4],[0,1,2]]}",
    [GD_FORMAT_GLTF] =
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":33,\"uri\":\"data:;base64,"
        "AAAAAQAAAgAAAAEAAQEAAgEAAAEEAAQDAQIFAQUEAAEC\"}],\"bufferViews\":[{\"buffer\":0,"
        "\"byteLength\":18},"
        "{\"buffer\":0,\"byteOffset\":18,\"byteLength\":15}],\"accessors\":[{\"bufferView\":0,"
        "\"componentType\":5121,"
        "\"count\":6,\"type\":\"VEC3\"},{\"bufferView\":1,\"componentType\":5121,\"count\":15,"
        "\"type\":\"SCALAR\"}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}]}",
    [GD_FORMAT_STL] = "solid\n"
                      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 "
                      "0\nendloop\nendfacet\n"
                      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 1 0\nvertex 0 1 "
                      "0\nendloop\nendfacet\n"
                      "facet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 2 0 0\nvertex 2 1 "
                      "0\nendloop\nendfacet\n"
                      "facet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 2 1 0\nvertex 1 1 "
                      "0\nendloop\nendfacet\n"
                      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 2 0 "
                      "0\nendloop\nendfacet\nendsolid\n",
};

static enum gd_status read_within(enum gd_format format, enum gd_format named, uint32_t faces,
                                  uint32_t vertices, struct gd_detail *detail)
{
    return read_text(meshes[format], named,
                     &(struct gd_read_options){.max_faces = faces, .max_vertices = vertices},
                     detail);
}

/* Each reader accepts input exactly at the limits and rejects one element more. Each file is read
 * twice: with a named format, and with a format that is recognised from the content. */
static void keeps_the_limits(void **state)
{
    (void)state;
    for (enum gd_format format = GD_FORMAT_OBJ; format <= GD_FORMAT_GLTF; format++) {
        for (int any = 0; any < 2 && meshes[format]; any++) {
            enum gd_format named = any ? GD_FORMAT_ANY : format;
            struct gd_detail detail = {.text = ""};
            assert_int_equal(read_text(meshes[format], named, NULL, &detail), GD_OK);
            assert_int_equal(read_within(format, named, 5, 6, &detail), GD_OK);
            assert_int_equal(read_within(format, named, UINT32_MAX, UINT32_MAX, NULL), GD_OK);
            assert_string_equal(detail.text, "");
            assert_int_equal(read_within(format, named, 4, 0, &detail), GD_TOO_LARGE);
            assert_non_null(strstr(detail.text, "more than 4 triangles"));
            assert_int_equal(read_within(format, named, 0, 5, &detail), GD_TOO_LARGE);
            assert_non_null(strstr(detail.text, "more than 5 vertices"));
            assert_int_equal(read_within(format, named, 1, 1, NULL), GD_TOO_LARGE);
        }
    }
}

/* A declared count above the limit is rejected before the body is read. */
static void refuses_declared_counts(void **state)
{
    (void)state;
    struct gd_read_options limits = {.max_faces = 2, .max_vertices = 5};
    assert_int_equal(read_text("OFF\n6 0 0\nx x x x x x x x x x x x x x x x x x x x x x x x",
                               GD_FORMAT_OFF, &limits, NULL),
                     GD_TOO_LARGE);
    assert_int_equal(read_text("OFF\n0 3 0\nx x x x x x x x x x x x x x x x x x x x x x x x",
                               GD_FORMAT_OFF, &limits, NULL),
                     GD_TOO_LARGE);
    assert_int_equal(read_text("ply\nformat ascii 1.0\nelement face 3\nproperty list int int "
                               "vertex_index\nend_header\n"
                               "x x x x x x x x x x x x x x x x x x x x x x x x",
                               GD_FORMAT_PLY, &limits, NULL),
                     GD_TOO_LARGE);
}

/* A file that has only triangles is read without the array `first`. The other arrays grow many
 * times. */
static void grows_with_the_input(void **state)
{
    (void)state;
    enum { STRIP = 5000 };
    char *text = NULL;
    size_t size;
    FILE *stream = open_memstream(&text, &size);
    for (int i = 0; i < STRIP + 2; i++) fprintf(stream, "v %d %d 0\n", i / 2, i % 2);
    for (int i = 0; i < STRIP; i++) fprintf(stream, "f %d %d %d\n", i + 1, i + 2, i + 3);
    fflush(stream);
    struct gd_polygons polygons;
    assert_int_equal(read_copy(text, size, GD_FORMAT_ANY, NULL, &polygons, NULL), GD_OK);
    assert_null(polygons.first);
    assert_int_equal(polygons.position_count, STRIP + 2);
    assert_int_equal(polygons.polygon_count, STRIP);
    for (uint32_t i = 0; i < 3 * STRIP; i++) assert_int_equal(polygons.corners[i], i / 3 + i % 3);
    gd_polygons_free(&polygons);

    for (int i = 0; i < STRIP; i++) fprintf(stream, "f 1 2 4 3\n");
    fclose(stream);
    assert_int_equal(read_copy(text, size, GD_FORMAT_ANY, NULL, &polygons, NULL), GD_OK);
    assert_non_null(polygons.first);
    for (uint32_t i = 0; i <= 2 * STRIP; i++)
        assert_int_equal(polygons.first[i], i <= STRIP ? 3 * i : 4 * i - STRIP);
    gd_polygons_free(&polygons);
    free(text);
}

/* --- control ---------------------------------------------------------------------------------- */

/* Cancels a call when its control is checked more than `allowed` times. `looks` counts the
 * checks. */
struct watch {
    size_t looks, allowed;
    double last;
};

static bool on_progress(void *user, double fraction)
{
    struct watch *watch = user;
    assert_true(fraction >= watch->last && fraction <= 1);
    watch->last = fraction;
    return watch->looks++ < watch->allowed;
}

static enum gd_status read_watched(const char *bytes, size_t size, struct watch *watch,
                                   uint64_t deadline_ns)
{
    const struct gd_control control = {
        .progress = on_progress, .user = watch, .deadline_ns = deadline_ns};
    struct gd_polygons polygons = {0};
    enum gd_status status =
        read_copy(bytes, size, GD_FORMAT_ANY, &(struct gd_read_options){.control = &control},
                  &polygons, NULL);
    if (status != GD_OK) assert_null(polygons.positions);
    gd_polygons_free(&polygons);
    return status;
}

/* Checks that the reader checks its control at regular intervals, and that it stops if the control
 * cancels it or its deadline has passed. */
static void check_control(const char *bytes, size_t size)
{
    struct watch whole = {.allowed = SIZE_MAX}, half = {0}, late = {.allowed = SIZE_MAX};
    assert_int_equal(read_watched(bytes, size, &whole, 0), GD_OK);
    assert_in_range(whole.looks, size / 100000, size / 10000);
    assert_true(whole.last > 0.8);
    half.allowed = whole.looks / 2;
    assert_int_equal(read_watched(bytes, size, &half, 0), GD_CANCELLED);
    assert_int_equal(half.looks, half.allowed + 1);
    assert_int_equal(read_watched(bytes, size, &late, 1), GD_DEADLINE);
    assert_int_equal(late.looks, 0);
}

static void obeys_its_control(void **state)
{
    (void)state;
    struct gd_polygons sphere;
    assert_int_equal(sample_icosphere(6, 1, &sphere), GD_OK);
    for (enum gd_format format = GD_FORMAT_OBJ; format <= GD_FORMAT_GLTF; format++) {
        char *bytes;
        size_t size;
        assert_int_equal(gd_write_polygons(&sphere, format, &bytes, &size), GD_OK);
        check_control(bytes, size);
        free(bytes);
    }
    gd_polygons_free(&sphere);
}

/* Runs check_control on a text: `begin`, then `repeated` many times, then `end`. */
static void check_control_of_skipped(const char *begin, const char *repeated, const char *end)
{
    enum { TIMES = 200000 };
    char *text = NULL;
    size_t size;
    FILE *stream = open_memstream(&text, &size);
    fputs(begin, stream);
    for (int i = 0; i < TIMES; i++) fputs(repeated, stream);
    fputs(end, stream);
    fclose(stream);
    check_control(text, size);
    free(text);
}

static void obeys_its_control_in_skipped_input(void **state)
{
    (void)state;
    static const char vertices[] = "element vertex 3\nproperty int x\nproperty int y\nproperty int "
                                   "z\nelement face 1\nproperty list int int "
                                   "vertex_indices\nend_header\n";
    static const char triangle[] = "\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    char records[500], list[500];
    snprintf(records, sizeof records,
             "ply\nformat ascii 1.0\nelement dust 200000\nproperty float w\n%s", vertices);
    snprintf(list, sizeof list,
             "ply\nformat ascii 1.0\nelement dust 1\nproperty list int int w\n%s200000", vertices);
    check_control_of_skipped("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "vn 0.125 0.5 0.25\n", "");
    check_control_of_skipped(records, "0.125 \n", triangle + 1);
    check_control_of_skipped(list, " 12345", triangle);
    check_control_of_skipped("", "solid a\nendsolid a\n", meshes[GD_FORMAT_STL]);
}

/* Tests long skipped input before the first element. */
static void blanks_end_at_the_deadline(void **state)
{
    (void)state;
    const size_t size = (size_t)3 << 20;
    static const struct {
        enum gd_format format;
        const char *begin, fill;
    } cases[] = {{GD_FORMAT_OBJ, "", ' '},
                 {GD_FORMAT_OBJ, "#", ' '},
                 {GD_FORMAT_OBJ, "", '\n'},
                 {GD_FORMAT_OFF, "", '\n'},
                 {GD_FORMAT_JSON, "", ' '},
                 {GD_FORMAT_JSON, "{", '\n'},
                 {GD_FORMAT_STL, "solid", ' '},
                 {GD_FORMAT_STL, "solid\n", 'x'},
                 {GD_FORMAT_PLY, "ply\ncomment", ' '}};
    char *text = malloc(size);
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        const struct gd_control late = {.deadline_ns = 1};
        const struct gd_read_options options = {.format = cases[i].format, .control = &late};
        struct gd_polygons polygons;
        memset(text, cases[i].fill, size);
        memcpy(text, cases[i].begin, strlen(cases[i].begin));
        assert_int_equal(gd_read_polygons(text, size, &options, &polygons, NULL), GD_DEADLINE);
        assert_true(gd_read_polygons(text, size,
                                     &(struct gd_read_options){.format = cases[i].format},
                                     &polygons, NULL) != GD_DEADLINE);
    }
    memset(text, ' ', size);
    strcpy(text + size - 20, "\nv 0 0 0\n");
    /* the first vertex is beyond the first MiB */
    assert_int_equal(gd_format_recognise(text, size - 10), GD_FORMAT_ANY);
    memcpy(text + 1000, "\nv 0 0 0\n", 9);
    assert_int_equal(gd_format_recognise(text, size - 10), GD_FORMAT_OBJ);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(refuses_other_content),
        cmocka_unit_test(keeps_the_limits),
        cmocka_unit_test(refuses_declared_counts),
        cmocka_unit_test(grows_with_the_input),
        cmocka_unit_test(obeys_its_control),
        cmocka_unit_test(obeys_its_control_in_skipped_input),
        cmocka_unit_test(blanks_end_at_the_deadline),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
