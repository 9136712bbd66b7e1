#include "gd/result_file.h"

#include <math.h>

#include "gd/colour_map.h"
#include "tests/samples/samples.h"
#include "tests/unit/io/reading.h"

static double corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.1}};
static uint32_t faces[6] = {0, 1, 2, 0, 2, 3};
static const struct gd_polygons square = {corners, 4, 2, faces, NULL};
static const double distances[4] = {0, 1, 0.1, INFINITY};
static const double points[5][3] = {{0, 0, 0}, {0.5, 0.5, 0}, {1, 1, 0}, {0, 0, 0}, {3, 4, 0}};
static const uint32_t first[3] = {0, 3, 5}, single[2] = {4, 5};

static char *written(const struct gd_result *result, enum gd_result_format format, size_t *size)
{
    char *bytes = NULL;
    assert_int_equal(gd_write_result(result, format, &bytes, size), GD_OK);
    assert_true(*size <= gd_result_cost(result));
    return bytes;
}

static void check_text(const struct gd_result *result, enum gd_result_format format,
                       const char *expected)
{
    size_t size;
    char *bytes = written(result, format, &size);
    assert_int_equal(size, strlen(expected));
    assert_memory_equal(bytes, expected, size);
    free(bytes);
}

static void writes_rows(void **state)
{
    (void)state;
    check_text(&(struct gd_result){.mesh = &square, .distances = distances}, GD_RESULT_CSV,
               "vertex,x,y,z,distance\r\n0,0,0,0,0\r\n1,1,0,0,1\r\n2,1,1,0,0.1\r\n3,0,1,0.1,\r\n");
    check_text(&(struct gd_result){.points = points, .first = first, .line_count = 2},
               GD_RESULT_CSV,
               "line,point,x,y,z,along\r\n0,0,0,0,0,0\r\n0,1,0.5,0.5,0,0.7071067811865476\r\n"
               "0,2,1,1,0,1.4142135623730951\r\n1,0,0,0,0,0\r\n1,1,3,4,0,5\r\n");
}

static void writes_lines(void **state)
{
    (void)state;
    check_text(&(struct gd_result){.points = points, .first = first, .line_count = 2},
               GD_RESULT_OBJ, "v 0 0 0\nv 0.5 0.5 0\nv 1 1 0\nv 0 0 0\nv 3 4 0\nl 1 2 3\nl 4 5\n");
    check_text(
        &(struct gd_result){.mesh = &square, .points = points, .first = first, .line_count = 1},
        GD_RESULT_OBJ,
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.1\nf 1 2 3\nf 1 3 4\nv 0 0 0\nv 0.5 0.5 0\nv 1 1 0\nl "
        "5 6 7\n");
    check_text(&(struct gd_result){.points = points + 0,
                                   .first = (const uint32_t[]){0, 1},
                                   .line_count = 1},
               GD_RESULT_OBJ, "v 0 0 0\n");
}

/* Writes three lines at two levels. */
static void writes_levels(void **state)
{
    (void)state;
    const double levels[3] = {0.1, 0.1, 2};
    const struct gd_result result = {.points = points,
                                     .first = (const uint32_t[]){0, 2, 4, 5},
                                     .line_count = 3,
                                     .levels = levels};
    check_text(
        &result, GD_RESULT_OBJ,
        "v 0 0 0\nv 0.5 0.5 0\nv 1 1 0\nv 0 0 0\nv 3 4 0\ng level_0.1\nl 1 2\nl 3 4\ng level_2\n");
    check_text(&result, GD_RESULT_CSV,
               "line,point,x,y,z,along,level\r\n0,0,0,0,0,0,0.1\r\n0,1,0.5,0.5,0,0."
               "7071067811865476,0.1\r\n"
               "1,0,1,1,0,0,0.1\r\n1,1,0,0,0,1.4142135623730951,0.1\r\n2,0,3,4,0,0,2\r\n");
    size_t size;
    char *bytes = written(&result, GD_RESULT_GLB, &size);
    static const char last[] =
        "{\"attributes\":{\"POSITION\":2},\"mode\":3,\"material\":1,\"extras\":{\"level\":2}}";
    assert_non_null(memmem(bytes, size, last, sizeof last - 1));
    free(bytes);
}

/* The distance is a vertex property after the coordinates, in the last eight bytes of a vertex.
 * Mesh readers skip it. */
static void writes_distances_into_ply(void **state)
{
    (void)state;
    size_t size;
    char *bytes =
        written(&(struct gd_result){.mesh = &square, .distances = distances}, GD_RESULT_PLY, &size);
    struct gd_polygons back;
    assert_int_equal(read_copy(bytes, size, GD_FORMAT_ANY, NULL, &back, NULL), GD_OK);
    assert_memory_equal(back.positions, corners, sizeof corners);
    assert_memory_equal(back.corners, faces, sizeof faces);
    gd_polygons_free(&back);
    static const char property[] = "property double z\nproperty double distance\n";
    /* four vertices and two faces follow the header */
    const char *body = bytes + size - (4 * 32 + 2 * 13);
    assert_non_null(memmem(bytes, size, property, sizeof property - 1));
    for (int i = 0; i < 4; i++) {
        double distance;
        memcpy(&distance, body + 32 * i + 24, sizeof distance);
        assert_true(i < 3 ? distance == distances[i] : isnan(distance));
    }
    free(bytes);
}

/* The binary chunk has 4 positions of 12 bytes, 6 indices, 4 colours of 8 bytes, 4 distances. */
static void writes_colours_into_glb(void **state)
{
    (void)state;
    size_t size;
    char *bytes =
        written(&(struct gd_result){.mesh = &square, .distances = distances}, GD_RESULT_GLB, &size);
    const char *binary = bytes + size - (48 + 24 + 32 + 16), *colours = binary + 72,
               *numbers = colours + 32;
    for (int i = 0; i < 4; i++) {
        uint16_t colour[4];
        float distance;
        memcpy(colour, colours + 8 * i, sizeof colour);
        memcpy(&distance, numbers + 4 * i, sizeof distance);
        struct gd_colour expected =
            i < 3 ? gd_colour_map(distances[i]) : (struct gd_colour){0.5, 0.5, 0.5};
        assert_true(fabs(colour[0] / 65535.0 - expected.red) < 1e-5);
        assert_true(fabs(colour[1] / 65535.0 - expected.green) < 1e-5);
        assert_true(fabs(colour[2] / 65535.0 - expected.blue) < 1e-5 && colour[3] == 65535);
        assert_true(distance == (i < 3 ? (float)distances[i] : -1));
    }
    free(bytes);
}

static void check_glb_mesh(const struct gd_result *result, const struct gd_polygons *mesh,
                           double error)
{
    size_t size;
    char *bytes = written(result, GD_RESULT_GLB, &size);
    struct gd_polygons back;
    assert_int_equal(read_copy(bytes, size, GD_FORMAT_GLB, NULL, &back, NULL), GD_OK);
    assert_int_equal(back.position_count, mesh->position_count);
    assert_int_equal(back.polygon_count, mesh->polygon_count);
    assert_memory_equal(back.corners, mesh->corners,
                        3 * mesh->polygon_count * sizeof *mesh->corners);
    for (uint32_t i = 0; i < mesh->position_count; i++)
        for (int axis = 0; axis < 3; axis++)
            assert_true(fabs(back.positions[i][axis] - mesh->positions[i][axis]) <= error);
    gd_polygons_free(&back);
    free(bytes);
}

/* Lines add no faces to the mesh. A line of one point is written as two equal points. */
static void writes_meshes_beside_lines(void **state)
{
    (void)state;
    check_glb_mesh(&(struct gd_result){.mesh = &square,
                                       .distances = distances,
                                       .points = points,
                                       .first = first,
                                       .line_count = 2},
                   &square, 1e-8);
    check_glb_mesh(
        &(struct gd_result){.mesh = &square, .points = points, .first = single, .line_count = 1},
        &square, 1e-8);
    size_t size;
    char *bytes = written(&(struct gd_result){.points = points, .first = single, .line_count = 1},
                          GD_RESULT_GLB, &size);
    static const float twice[6] = {3, 4, 0, 3, 4, 0};
    assert_memory_equal(bytes + size - sizeof twice, twice, sizeof twice);
    free(bytes);
}

/* Several accessors share a buffer view, which therefore needs byteStride (glTF 2.0, 3.6.2.4). */
static void writes_the_stride_of_lines(void **state)
{
    (void)state;
    size_t size;
    char *bytes = written(&(struct gd_result){.points = points, .first = first, .line_count = 2},
                          GD_RESULT_GLB, &size);
    assert_non_null(memmem(bytes, size, ",\"byteStride\":12,", 17));
    free(bytes);
}

/* Positions lose at most 2^-23 of the mesh's size, at any scale and distance from the origin.
 * Positions that are floats lose nothing. */
static void keeps_far_meshes(void **state)
{
    (void)state;
    static const double scales[] = {1e-6, 1, 1e6}, distances_away[] = {0, 1, 1e6};
    for (size_t s = 0; s < COUNT_OF(scales); s++) {
        for (size_t d = 0; d < COUNT_OF(distances_away); d++) {
            struct gd_polygons sphere;
            assert_int_equal(sample_icosphere(3, scales[s], &sphere), GD_OK);
            for (uint32_t i = 0; i < sphere.position_count; i++)
                for (int axis = 0; axis < 3; axis++)
                    sphere.positions[i][axis] += distances_away[d] * scales[s] * (axis + 1);
            double rounding = 4e-16 * 3 * distances_away[d] * scales[s];
            check_glb_mesh(&(struct gd_result){.mesh = &sphere}, &sphere,
                           scales[s] * 0x1p-23 + rounding);
            for (uint32_t i = 0; i < sphere.position_count; i++)
                for (int axis = 0; axis < 3; axis++) {
                    volatile float rounded = (float)sphere.positions[i][axis];
                    sphere.positions[i][axis] = rounded;
                }
            if (distances_away[d] < 2)
                check_glb_mesh(&(struct gd_result){.mesh = &sphere}, &sphere, 0);
            gd_polygons_free(&sphere);
        }
    }
}

static void refuses_unsupported_results(void **state)
{
    (void)state;
    char *bytes = NULL;
    size_t size;
    const struct gd_result nothing = {0}, bare = {.distances = distances}, mesh = {.mesh = &square};
    const struct gd_result lines = {.points = points, .first = first, .line_count = 2};
    for (int format = GD_RESULT_PLY; format <= GD_RESULT_GLB; format++) {
        assert_int_equal(gd_write_result(&nothing, (enum gd_result_format)format, &bytes, &size),
                         GD_INVALID_ARGUMENT);
        assert_int_equal(gd_write_result(&bare, (enum gd_result_format)format, &bytes, &size),
                         GD_INVALID_ARGUMENT);
    }
    assert_int_equal(gd_write_result(&lines, GD_RESULT_PLY, &bytes, &size), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_write_result(&mesh, GD_RESULT_OBJ, &bytes, &size), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_write_result(&mesh, GD_RESULT_CSV, &bytes, &size), GD_INVALID_ARGUMENT);
    double huge[3][3] = {{0, 0, 0}, {1e300, 0, 0}, {0, 1e300, 0}};
    uint32_t three[3] = {0, 1, 2}, quad[4] = {0, 1, 2, 3}, offsets[2] = {0, 4};
    const struct gd_polygons wide = {huge, 3, 1, three, NULL},
                             polygon = {corners, 4, 1, quad, offsets};
    assert_int_equal(
        gd_write_result(&(struct gd_result){.mesh = &wide}, GD_RESULT_GLB, &bytes, &size),
        GD_EXTENT);
    assert_int_equal(
        gd_write_result(&(struct gd_result){.mesh = &polygon}, GD_RESULT_GLB, &bytes, &size),
        GD_NOT_TRIANGLES);
    assert_null(bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(writes_rows),
        cmocka_unit_test(writes_lines),
        cmocka_unit_test(writes_levels),
        cmocka_unit_test(writes_distances_into_ply),
        cmocka_unit_test(writes_colours_into_glb),
        cmocka_unit_test(writes_meshes_beside_lines),
        cmocka_unit_test(writes_the_stride_of_lines),
        cmocka_unit_test(keeps_far_meshes),
        cmocka_unit_test(refuses_unsupported_results),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
