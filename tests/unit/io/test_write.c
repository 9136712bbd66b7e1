#include <math.h>

#include "tests/unit/io/reading.h"

static double positions[][3] = {
    {16777217, 0.1, -0.0},
    {1e-320, 1.7976931348623157e308, 123456789012345678901234567890.0},
    {1.0 / 3, -2.2250738585072014e-308, 5e-324},
    {1e22, 1e23, 100000},
};
static uint32_t corners[] = {0, 1, 2, 2, 1, 3, 0, 3, 2, 1};
static uint32_t first[] = {0, 3, 7, 10};

static const struct gd_polygons triangles = {
    .positions = positions, .position_count = 4, .polygon_count = 3, .corners = corners};
static const struct gd_polygons mixed = {.positions = positions,
                                         .position_count = 4,
                                         .polygon_count = 3,
                                         .corners = corners,
                                         .first = first};

static void check_equal(const struct gd_polygons *a, const struct gd_polygons *b)
{
    assert_int_equal(a->position_count, b->position_count);
    assert_int_equal(a->polygon_count, b->polygon_count);
    assert_memory_equal(a->positions, b->positions, a->position_count * sizeof *a->positions);
    assert_int_equal(gd_polygons_corner_count(a), gd_polygons_corner_count(b));
    assert_memory_equal(a->corners, b->corners, gd_polygons_corner_count(a) * sizeof *a->corners);
    for (uint32_t i = 0; i <= a->polygon_count; i++)
        assert_int_equal(gd_polygons_first(a, i), gd_polygons_first(b, i));
}

static void check_round_trip(const struct gd_polygons *polygons, enum gd_format format)
{
    char *bytes;
    size_t size;
    struct gd_polygons back;
    assert_int_equal(gd_write_polygons(polygons, format, &bytes, &size), GD_OK);
    assert_int_equal(gd_format_recognise(bytes, size), format);
    assert_int_equal(read_copy(bytes, size, GD_FORMAT_ANY, NULL, &back, NULL), GD_OK);
    check_equal(polygons, &back);
    gd_polygons_free(&back);
    free(bytes);
}

static void keeps_every_bit(void **state)
{
    (void)state;
    static const enum gd_format exact[] = {GD_FORMAT_OBJ, GD_FORMAT_PLY, GD_FORMAT_OFF,
                                           GD_FORMAT_JSON};
    for (size_t i = 0; i < COUNT_OF(exact); i++) {
        check_round_trip(&triangles, exact[i]);
        check_round_trip(&mixed, exact[i]);
    }
}

/* Tests a polygon with more corners than a byte can count. */
static void keeps_large_polygons(void **state)
{
    (void)state;
    enum { CORNERS = 300 };
    static double circle[CORNERS][3];
    static uint32_t around[CORNERS];
    uint32_t ends[] = {0, CORNERS};
    for (uint32_t i = 0; i < CORNERS; i++) {
        circle[i][0] = i * 0.7;
        circle[i][1] = 1.0 / (1 + i);
        around[i] = i;
    }
    struct gd_polygons polygons = {.positions = circle,
                                   .position_count = CORNERS,
                                   .polygon_count = 1,
                                   .corners = around,
                                   .first = ends};
    check_round_trip(&polygons, GD_FORMAT_OBJ);
    check_round_trip(&polygons, GD_FORMAT_PLY);
    check_round_trip(&polygons, GD_FORMAT_OFF);
    check_round_trip(&polygons, GD_FORMAT_JSON);
}

static double points[][3] = {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0, 0, 16777217}};
static uint32_t tetrahedron[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};

static void writes_stl_as_floats(void **state)
{
    (void)state;
    struct gd_polygons polygons = {
        .positions = points, .position_count = 4, .polygon_count = 4, .corners = tetrahedron};
    char *bytes;
    size_t size;
    struct gd_polygons back;
    assert_int_equal(gd_write_polygons(&polygons, GD_FORMAT_STL, &bytes, &size), GD_OK);
    assert_int_equal(size, 84 + 50 * 4);
    assert_memory_equal(bytes + 80, "\4\0\0\0", 4);
    assert_memory_equal(bytes + 84, "\0\0\0\0\0\0\0\0\0\0\x80\xbf",
                        12); /* normal of the first face: (0, 0, -1), with zeros of either sign */
    assert_int_equal(gd_format_recognise(bytes, size), GD_FORMAT_STL);
    assert_int_equal(read_copy(bytes, size, GD_FORMAT_ANY, NULL, &back, NULL), GD_OK);
    char *text = mesh_text(&back);
    assert_string_equal(text, "0 0 0; 0 3 0; 2 0 0; 0 0 16777216 | 0 1 2; 0 2 3; 0 3 1; 2 1 3");
    free(text);
    gd_polygons_free(&back);
    free(bytes);
}

/* Positions that are floats stay exact in GLB and glTF. Other positions lose at most 2^-24 of the
 * mesh's size. */
static void writes_gltf_as_floats(void **state)
{
    (void)state;
    static double floats[][3] = {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0x1.99999ap-4, 0x1.8p-40, 7}};
    struct gd_polygons polygons = {
        .positions = floats, .position_count = 4, .polygon_count = 4, .corners = tetrahedron};
    check_round_trip(&polygons, GD_FORMAT_GLB);
    check_round_trip(&polygons, GD_FORMAT_GLTF);
    polygons.positions = points;
    for (enum gd_format format = GD_FORMAT_GLB; format <= GD_FORMAT_GLTF; format++) {
        char *bytes;
        size_t size;
        struct gd_polygons back;
        assert_int_equal(gd_write_polygons(&polygons, format, &bytes, &size), GD_OK);
        assert_int_equal(read_copy(bytes, size, GD_FORMAT_ANY, NULL, &back, NULL), GD_OK);
        for (uint32_t i = 0; i < 4; i++)
            for (int axis = 0; axis < 3; axis++)
                assert_true(fabs(back.positions[i][axis] - points[i][axis]) <= 0.5);
        gd_polygons_free(&back);
        free(bytes);
    }
}

static void refuses_what_stl_cannot_hold(void **state)
{
    (void)state;
    char *bytes = NULL;
    size_t size = 7;
    assert_int_equal(gd_write_polygons(&mixed, GD_FORMAT_STL, &bytes, &size), GD_NOT_TRIANGLES);
    assert_int_equal(gd_write_polygons(&triangles, GD_FORMAT_STL, &bytes, &size), GD_EXTENT);
    assert_int_equal(gd_write_polygons(&triangles, GD_FORMAT_ANY, &bytes, &size),
                     GD_INVALID_ARGUMENT);
    double small[][3] = {{0, 0, 0}, {1e-46, 0, 0}, {0, -1e-46, 0}};
    for (enum gd_format format = GD_FORMAT_STL; format <= GD_FORMAT_GLTF; format++) {
        bool has_floats = format == GD_FORMAT_STL || format >= GD_FORMAT_GLB;
        struct gd_polygons polygons = {.positions = small,
                                       .position_count = 3,
                                       .polygon_count = 1,
                                       .corners = (uint32_t[]){0, 1, 2}};
        if (has_floats)
            assert_int_equal(gd_write_polygons(&polygons, format, &bytes, &size), GD_EXTENT);
        else
            check_round_trip(&polygons, format);
    }
    for (int i = 0; i < 6; i++) {
        double large[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        large[2][i / 2] = i % 2 ? 1e39 : (double)NAN;
        uint32_t all[] = {0, 1, 2};
        struct gd_polygons polygons = {
            .positions = large, .position_count = 3, .polygon_count = 1, .corners = all};
        assert_int_equal(gd_write_polygons(&polygons, GD_FORMAT_STL, &bytes, &size), GD_EXTENT);
    }
    assert_int_equal(gd_write_polygons(&mixed, GD_FORMAT_GLB, &bytes, &size), GD_NOT_TRIANGLES);
    assert_int_equal(gd_write_polygons(&mixed, GD_FORMAT_GLTF, &bytes, &size), GD_NOT_TRIANGLES);
    assert_int_equal(gd_write_polygons(&triangles, GD_FORMAT_GLB, &bytes, &size), GD_EXTENT);
    assert_int_equal(gd_write_polygons(&triangles, GD_FORMAT_GLTF, &bytes, &size), GD_EXTENT);
    assert_null(bytes);
    assert_int_equal(size, 7);
}

static void writes_text_as_documented(void **state)
{
    (void)state;
    static double corner[][3] = {{0, 0, 0}, {1.5, 0, 0}, {0, 0.1, 0}};
    static uint32_t all[] = {0, 1, 2};
    struct gd_polygons polygons = {
        .positions = corner, .position_count = 3, .polygon_count = 1, .corners = all};
    static const struct {
        enum gd_format format;
        const char *text;
    } cases[] = {
        {GD_FORMAT_OBJ, "v 0 0 0\nv 1.5 0 0\nv 0 0.1 0\nf 1 2 3\n"},
        {GD_FORMAT_OFF, "OFF\n3 1 0\n0 0 0\n1.5 0 0\n0 0.1 0\n3 0 1 2\n"},
        {GD_FORMAT_JSON, "{\"vertices\":[[0,0,0],[1.5,0,0],[0,0.1,0]],\"faces\":[[0,1,2]]}\n"},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char *bytes;
        size_t size;
        assert_int_equal(gd_write_polygons(&polygons, cases[i].format, &bytes, &size), GD_OK);
        assert_int_equal(size, strlen(cases[i].text));
        assert_memory_equal(bytes, cases[i].text, size);
        free(bytes);
    }
}

static bool stop_later(void *user, double fraction)
{
    (void)fraction;
    return --*(uint32_t *)user > 0;
}

static void stops_when_the_callback_asks(void **state)
{
    (void)state;
    const uint32_t count = 300000;
    struct gd_polygons many = {.position_count = count, .polygon_count = count};
    many.positions = calloc(count, sizeof *many.positions);
    many.corners = calloc(count, 3 * sizeof *many.corners);
    const enum gd_format formats[] = {GD_FORMAT_PLY, GD_FORMAT_OBJ, GD_FORMAT_OFF, GD_FORMAT_JSON,
                                      GD_FORMAT_STL};
    for (size_t i = 0; i < COUNT_OF(formats); i++) {
        char *bytes;
        size_t size;
        uint32_t turns = 5;
        const struct gd_control late = {.deadline_ns = 1},
                                ending = {.progress = stop_later, .user = &turns};
        assert_int_equal(gd_write_polygons_within(&many, formats[i], &late, &bytes, &size),
                         GD_DEADLINE);
        assert_int_equal(gd_write_polygons_within(&many, formats[i], &ending, &bytes, &size),
                         GD_CANCELLED);
        turns = UINT32_MAX;
        assert_int_equal(gd_write_polygons_within(&many, formats[i], &ending, &bytes, &size),
                         GD_OK);
        assert_true(UINT32_MAX - turns > size >> 20);
        free(bytes);
    }
    free(many.positions);
    free(many.corners);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keeps_every_bit),
        cmocka_unit_test(keeps_large_polygons),
        cmocka_unit_test(writes_stl_as_floats),
        cmocka_unit_test(writes_gltf_as_floats),
        cmocka_unit_test(refuses_what_stl_cannot_hold),
        cmocka_unit_test(writes_text_as_documented),
        cmocka_unit_test(stops_when_the_callback_asks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
