/* Small meshes, and checks that the tests of meshes share. */
#pragma once

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "gd/mesh.h"

#define COUNT(array) ((uint32_t)(sizeof(array) / sizeof *(array)))

/* Polygons that use constant arrays. These arrays are not freed. */
#define TRIANGLES(p, c)                                                                            \
    ((struct gd_polygons){.positions = (p),                                                        \
                          .position_count = COUNT(p),                                              \
                          .corners = (c),                                                          \
                          .polygon_count = COUNT(c) / 3})
#define POLYGONS(p, c, f)                                                                          \
    ((struct gd_polygons){.positions = (p),                                                        \
                          .position_count = COUNT(p),                                              \
                          .corners = (c),                                                          \
                          .first = (f),                                                            \
                          .polygon_count = COUNT(f) - 1})

static double tetrahedron_positions[][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
static uint32_t tetrahedron_corners[] = {0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2};

static double cube_positions[][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                     {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
static uint32_t cube_corners[] = {0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4,
                                  1, 2, 6, 5, 2, 3, 7, 6, 3, 0, 4, 7};
static uint32_t cube_first[] = {0, 4, 8, 12, 16, 20, 24};

static inline struct gd_polygons tetrahedron(void)
{
    return TRIANGLES(tetrahedron_positions, tetrahedron_corners);
}

static inline struct gd_polygons cube(void)
{
    return POLYGONS(cube_positions, cube_corners, cube_first);
}

static inline struct gd_mesh *build(const struct gd_polygons *polygons)
{
    struct gd_mesh *mesh = NULL;
    struct gd_detail detail = {0};
    enum gd_status status = gd_mesh_build(polygons, NULL, NULL, &mesh, &detail);
    if (status) fail_msg("%s: %s", gd_status_name(status), detail.text);
    return mesh;
}

/* Checks that the build fails with `status` and writes no mesh. Returns its detail. */
static inline struct gd_detail refuse(const struct gd_polygons *polygons, enum gd_status status)
{
    struct gd_mesh *mesh = NULL;
    struct gd_detail detail = {0};
    assert_string_equal(gd_status_name(gd_mesh_build(polygons, NULL, NULL, &mesh, &detail)),
                        gd_status_name(status));
    assert_null(mesh);
    assert_int_equal(gd_mesh_build(polygons, NULL, NULL, &mesh, NULL), status);
    return detail;
}

/* Checks a detail's total, its elements in order, and that its message contains `words`. */
static inline void expect_elements(const struct gd_detail *detail, enum gd_element kind,
                                   uint64_t total, uint32_t count, const uint64_t elements[][2],
                                   const char *words)
{
    assert_int_equal(detail->kind, kind);
    assert_int_equal(detail->total, total);
    assert_int_equal(detail->count, count);
    for (uint32_t i = 0; i < count; i++) {
        assert_int_equal(detail->elements[i][0], elements[i][0]);
        assert_int_equal(detail->elements[i][1], elements[i][1]);
    }
    if (!strstr(detail->text, words)) fail_msg("\"%s\" does not say \"%s\"", detail->text, words);
}

/* Builds with `options`, which must succeed. Checks the properties that every repair report has. */
static inline struct gd_mesh *build_with(const struct gd_polygons *polygons,
                                         struct gd_mesh_options options)
{
    struct gd_mesh *mesh = NULL;
    struct gd_detail detail = {0};
    enum gd_status status = gd_mesh_build(polygons, &options, NULL, &mesh, &detail);
    if (status) fail_msg("%s: %s", gd_status_name(status), detail.text);
    const struct gd_mesh_summary *summary = gd_mesh_summary(mesh);
    const struct gd_mesh_repair *repair = gd_mesh_repair(mesh);
    assert_int_equal(summary->index_count, polygons->position_count + repair->copies);
    assert_int_equal(summary->faces + repair->duplicate_faces.count +
                         repair->degenerate_faces.count,
                     summary->face_index_count);
    return mesh;
}

static inline struct gd_mesh *mend(const struct gd_polygons *polygons)
{
    return build_with(polygons, (struct gd_mesh_options){.repair_split = true});
}

/* Checks the count and the listed elements of one kind of repair. */
static inline void expect_mended(const struct gd_mended *mended, uint32_t count,
                                 const uint32_t elements[][2])
{
    assert_int_equal(mended->count, count);
    assert_int_equal(mended->listed, count < GD_MENDED_LISTED ? count : GD_MENDED_LISTED);
    for (uint32_t i = 0; i < mended->listed; i++) {
        assert_int_equal(mended->elements[i][0], elements[i][0]);
        assert_int_equal(mended->elements[i][1], elements[i][1]);
    }
}

#define MENDED(...)                                                                                \
    (sizeof((uint32_t[][2]){__VA_ARGS__}) / 8), (const uint32_t[][2])                              \
    {                                                                                              \
        __VA_ARGS__                                                                                \
    }
#define UNTOUCHED 0, NULL

static inline void expect_near(double actual, double expected, double tolerance)
{
    if (!(fabs(actual - expected) <= tolerance))
        fail_msg("%.17g instead of %.17g", actual, expected);
}

#define ONE_ELEMENT(a, b)                                                                          \
    1, (const uint64_t[][2])                                                                       \
    {                                                                                              \
        {                                                                                          \
            (a), (b)                                                                               \
        }                                                                                          \
    }
