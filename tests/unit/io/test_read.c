#include "tests/unit/io/reading.h"

static enum gd_status read_text(const char *text, enum gd_format format, const struct gd_read_limits *limits,
                                struct gd_detail *detail)
{
    struct gd_polygons polygons = {0};
    enum gd_status status = read_copy(text, strlen(text), format, limits, &polygons, detail);
    gd_polygons_free(&polygons);
    return status;
}

static void refuses_what_is_no_mesh(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    struct gd_detail detail;
    assert_int_equal(gd_read_polygons(NULL, 0, GD_FORMAT_ANY, NULL, &polygons, &detail), GD_EMPTY);
    assert_int_equal(gd_read_polygons(NULL, 0, GD_FORMAT_OBJ, NULL, &polygons, NULL), GD_EMPTY);
    assert_int_equal(read_text("<html>", GD_FORMAT_ANY, NULL, &detail), GD_UNRECOGNIZED);
    assert_int_equal(detail.total, 0);
    assert_int_equal(read_text("<html>", (enum gd_format)99, NULL, NULL), GD_UNRECOGNIZED);
}

/* Two quadrilaterals and a triangle on six vertices: five triangles. */
static const char *const meshes[] = {
    [GD_FORMAT_OBJ] = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nf 1 2 5 4\nf 2 3 6 5\nf 1 2 3\n",
    [GD_FORMAT_OFF] = "OFF\n6 3 0\n0 0 0\n1 0 0\n2 0 0\n0 1 0\n1 1 0\n2 1 0\n4 0 1 4 3\n4 1 2 5 4\n3 0 1 2\n",
    [GD_FORMAT_PLY] =
        "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\nelement face "
        "3\n"
        "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n2 0 0\n0 1 0\n1 1 0\n2 1 0\n4 0 1 4 3\n"
        "4 1 2 5 4\n3 0 1 2\n",
    [GD_FORMAT_JSON] =
        "{\"vertices\":[[0,0,0],[1,0,0],[2,0,0],[0,1,0],[1,1,0],[2,1,0]],\"faces\":[[0,1,4,3],[1,2,5,4],[0,1,2]]}",
    [GD_FORMAT_STL] =
        "solid\n"
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\nendfacet\n"
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\n"
        "facet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 2 0 0\nvertex 2 1 0\nendloop\nendfacet\n"
        "facet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 2 1 0\nvertex 1 1 0\nendloop\nendfacet\n"
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 2 0 0\nendloop\nendfacet\nendsolid\n",
};

/* Limits are met exactly and passed by one, in every format, whether recognised or named. */
static void keeps_the_limits(void **state)
{
    (void)state;
    for (enum gd_format format = GD_FORMAT_OBJ; format <= GD_FORMAT_JSON; format++) {
        for (int any = 0; any < 2; any++) {
            enum gd_format named = any ? GD_FORMAT_ANY : format;
            struct gd_detail detail = {.text = ""};
            assert_int_equal(read_text(meshes[format], named, NULL, &detail), GD_OK);
            assert_int_equal(read_text(meshes[format], named, &(struct gd_read_limits){5, 6}, &detail), GD_OK);
            assert_int_equal(read_text(meshes[format], named, &(struct gd_read_limits){UINT32_MAX, UINT32_MAX}, NULL),
                             GD_OK);
            assert_string_equal(detail.text, "");
            assert_int_equal(read_text(meshes[format], named, &(struct gd_read_limits){4, 0}, &detail), GD_TOO_LARGE);
            assert_non_null(strstr(detail.text, "more than 4 triangles"));
            assert_int_equal(read_text(meshes[format], named, &(struct gd_read_limits){0, 5}, &detail), GD_TOO_LARGE);
            assert_non_null(strstr(detail.text, "more than 5 vertices"));
            assert_int_equal(read_text(meshes[format], named, &(struct gd_read_limits){1, 1}, NULL), GD_TOO_LARGE);
        }
    }
}

/* Declared counts are refused before the body is looked at. */
static void refuses_declared_counts(void **state)
{
    (void)state;
    struct gd_read_limits limits = {2, 5};
    assert_int_equal(
        read_text("OFF\n6 0 0\nx x x x x x x x x x x x x x x x x x x x x x x x", GD_FORMAT_OFF, &limits, NULL),
        GD_TOO_LARGE);
    assert_int_equal(
        read_text("OFF\n0 3 0\nx x x x x x x x x x x x x x x x x x x x x x x x", GD_FORMAT_OFF, &limits, NULL),
        GD_TOO_LARGE);
    assert_int_equal(read_text("ply\nformat ascii 1.0\nelement face 3\nproperty list int int vertex_index\nend_header\n"
                               "x x x x x x x x x x x x x x x x x x x x x x x x",
                               GD_FORMAT_PLY, &limits, NULL),
                     GD_TOO_LARGE);
}

/* All triangles: no `first`; arrays long enough to have grown many times. */
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
    for (uint32_t i = 0; i <= 2 * STRIP; i++) assert_int_equal(polygons.first[i], i <= STRIP ? 3 * i : 4 * i - STRIP);
    gd_polygons_free(&polygons);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(refuses_what_is_no_mesh),
        cmocka_unit_test(keeps_the_limits),
        cmocka_unit_test(refuses_declared_counts),
        cmocka_unit_test(grows_with_the_input),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
