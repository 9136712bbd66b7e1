#include "tests/samples/zoo.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/samples/builder.h"
#include "tests/samples/random.h"
#include "tests/samples/samples.h"
#include "tests/samples/transform.h"

void zoo_shape_free(struct zoo_shape *shape)
{
    gd_polygons_free(&shape->mesh);
    free(shape->chart);
    *shape = (struct zoo_shape){0};
}

static uint32_t whole(double value)
{
    return (uint32_t)value;
}

static enum gd_status finish(struct sample_builder *builder, uint32_t centre, struct zoo_shape *out)
{
    struct zoo_shape shape = {.centre = centre};
    enum gd_status status = sample_finish(builder, &shape.mesh);
    if (status == GD_OK) *out = shape;
    return status;
}

/* Makes a shape from the generated mesh if the generator succeeded. */
static enum gd_status adopt(enum gd_status status, struct gd_polygons mesh, uint32_t centre,
                            struct zoo_shape *out)
{
    if (status == GD_OK) *out = (struct zoo_shape){.mesh = mesh, .centre = centre};
    return status;
}

/* Stores the positions as the chart, before they are changed in a way that keeps all edge
 * lengths. */
static enum gd_status remember_chart(struct zoo_shape *shape)
{
    size_t bytes = shape->mesh.position_count * sizeof *shape->chart;
    shape->chart = malloc(bytes);
    if (!shape->chart) {
        zoo_shape_free(shape);
        return GD_NO_MEMORY;
    }
    memcpy(shape->chart, shape->mesh.positions, bytes);
    return GD_OK;
}

/* --- refused shapes --------------------------------------------------------------------------- */

enum gd_status zoo_twin_vertices(const double *values, struct zoo_shape *out)
{
    (void)values;
    struct gd_polygons mesh = {0};
    enum gd_status status = sample_grid(3, 3, 1, 1, &mesh);
    if (status == GD_OK) memcpy(mesh.positions[6], mesh.positions[5], sizeof mesh.positions[6]);
    return adopt(status, mesh, 5, out);
}

/* Makes triangles over five points in general position. The result may be non-manifold. */
static enum gd_status from_corners(const uint32_t (*corners)[3], uint32_t count,
                                   struct zoo_shape *out)
{
    struct sample_builder builder = {0};
    static const double positions[5][3] = {
        {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, -1, -1}};
    for (int i = 0; i < 5; i++)
        sample_add_vertex(&builder, positions[i][0], positions[i][1], positions[i][2]);
    for (uint32_t i = 0; i < count; i++)
        sample_add_triangle(&builder, corners[i][0], corners[i][1], corners[i][2]);
    return finish(&builder, 0, out);
}

enum gd_status zoo_repeated_corner(const double *values, struct zoo_shape *out)
{
    (void)values;
    return from_corners((const uint32_t[][3]){{0, 1, 2}, {0, 0, 3}}, 2, out);
}

enum gd_status zoo_duplicate_face(const double *values, struct zoo_shape *out)
{
    uint32_t b = values[0] != 0 ? 2 : 1;
    return from_corners((const uint32_t[][3]){{0, 1, 2}, {0, b, 3 - b}}, 2, out);
}

enum gd_status zoo_three_at_edge(const double *values, struct zoo_shape *out)
{
    (void)values;
    return from_corners((const uint32_t[][3]){{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}, 3, out);
}

enum gd_status zoo_bow_tie(const double *values, struct zoo_shape *out)
{
    (void)values;
    return from_corners((const uint32_t[][3]){{0, 1, 2}, {0, 3, 4}}, 2, out);
}

enum gd_status zoo_moebius(const double *values, struct zoo_shape *out)
{
    struct sample_builder builder = {0};
    uint32_t cells = whole(values[0]);
    for (uint32_t i = 0; i < cells; i++) {
        double turn = 2 * M_PI * i / cells;
        for (int side = -1; side <= 1; side += 2) {
            double r = 1 + 0.3 * side * cos(0.5 * turn);
            sample_add_vertex(&builder, r * cos(turn), r * sin(turn), 0.3 * side * sin(0.5 * turn));
        }
    }
    for (uint32_t i = 0; i + 1 < cells; i++)
        sample_add_quad(&builder, 2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2);
    sample_add_quad(&builder, 2 * cells - 2, 2 * cells - 1, 0, 1);
    return finish(&builder, 0, out);
}

enum gd_status zoo_not_finite(const double *values, struct zoo_shape *out)
{
    enum gd_status status = from_corners((const uint32_t[][3]){{0, 1, 2}}, 1, out);
    if (status == GD_OK) out->mesh.positions[1][1] = values[0];
    return status;
}

/* --- flat ------------------------------------------------------------------------------------- */

enum gd_status zoo_cap(const double *values, struct zoo_shape *out)
{
    struct sample_builder builder = {0};
    uint32_t a = sample_add_vertex(&builder, 0, 0, 0), b = sample_add_vertex(&builder, 1, 0, 0);
    uint32_t tip = sample_add_vertex(&builder, 0.4, values[0], 0);
    uint32_t below = sample_add_vertex(&builder, 0.5, -1, 0),
             above = sample_add_vertex(&builder, 0.5, 1, 0);
    sample_add_triangle(&builder, a, b, tip);
    sample_add_triangle(&builder, b, a, below);
    sample_add_triangle(&builder, a, tip, above);
    sample_add_triangle(&builder, tip, b, above);
    return finish(&builder, tip, out);
}

enum gd_status zoo_needles(const double *values, struct zoo_shape *out)
{
    uint32_t columns = whole(values[0]), rows = whole(values[1]);
    struct gd_polygons mesh = {0};
    enum gd_status status = sample_grid(columns, rows, values[2], rows, &mesh);
    for (uint32_t v = 0; status == GD_OK && v < mesh.position_count; v++)
        mesh.positions[v][0] += values[3] * mesh.positions[v][1];
    return adopt(status, mesh, rows / 2 * (columns + 1) + columns / 2, out);
}

enum gd_status zoo_wheel(const double *values, struct zoo_shape *out)
{
    uint32_t spokes = whole(values[0]);
    struct gd_polygons mesh = {0};
    enum gd_status status = sample_cone(1, 0, spokes, 1, &mesh);
    if (status == GD_OK) mesh.positions[spokes][0] = values[1];
    return adopt(status, mesh, spokes, out);
}

enum gd_status zoo_accordion(const double *values, struct zoo_shape *out)
{
    uint32_t columns = whole(values[0]), rows = whole(values[1]), folds = whole(values[3]);
    struct gd_polygons mesh = {0};
    enum gd_status status = sample_grid(columns, rows, values[2], rows, &mesh);
    status = adopt(status, mesh, columns / 2, out);
    if (status == GD_OK) status = remember_chart(out);
    double leaf = values[2] / columns * (columns / (folds + 1));
    for (uint32_t v = 0; status == GD_OK && v < mesh.position_count; v++) {
        double x = fmod(mesh.positions[v][0], 2 * leaf);
        mesh.positions[v][0] = x > leaf ? 2 * leaf - x : x;
    }
    return status;
}

/* Computes the i-th of 4 n points around the rectangle, counter-clockwise. */
static void rim_point(double width, double height, uint32_t i, uint32_t n, double out[2])
{
    static const double corners[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const double *a = corners[i / n], *b = corners[(i / n + 1) % 4];
    double t = (double)(i % n) / n;
    out[0] = width * (a[0] + t * (b[0] - a[0]));
    out[1] = height * (a[1] + t * (b[1] - a[1]));
}

enum gd_status zoo_pillow(const double *values, struct zoo_shape *out)
{
    struct sample_builder builder = {0};
    uint32_t n = whole(values[2]);
    for (uint32_t i = 0; i < 4 * n; i++) {
        double at[2];
        rim_point(values[0], values[1], i, n, at);
        sample_add_vertex(&builder, at[0], at[1], 0);
    }
    uint32_t above = sample_add_vertex(&builder, 0.5 * values[0], 0.5 * values[1], 1);
    uint32_t below = sample_add_vertex(&builder, 0.5 * values[0], 0.5 * values[1], -1);
    for (uint32_t i = 0; i < 4 * n; i++) {
        sample_add_triangle(&builder, i, (i + 1) % (4 * n), above);
        sample_add_triangle(&builder, (i + 1) % (4 * n), i, below);
    }
    enum gd_status status = finish(&builder, 0, out);
    if (status == GD_OK) status = remember_chart(out);
    if (status == GD_OK) out->mesh.positions[above][2] = out->mesh.positions[below][2] = 0;
    return status;
}

/* --- curved ----------------------------------------------------------------------------------- */

enum gd_status zoo_tube(const double *values, struct zoo_shape *out)
{
    struct gd_polygons mesh = {0};
    enum gd_status status =
        sample_cylinder(values[0], values[1], whole(values[2]), whole(values[3]), &mesh);
    return adopt(status, mesh, 0, out);
}

enum gd_status zoo_fan(const double *values, struct zoo_shape *out)
{
    uint32_t sectors = whole(values[3]);
    struct gd_polygons mesh = {0};
    enum gd_status status = values[2] != 0 ? sample_saddle(values[0], values[2], sectors, 1, &mesh)
                                           : sample_cone(values[0], values[1], sectors, 1, &mesh);
    return adopt(status, mesh, sectors, out);
}

enum gd_status zoo_box(const double *values, struct zoo_shape *out)
{
    struct gd_polygons mesh = {0};
    enum gd_status status = sample_box(values, (const uint32_t[3]){1, 1, 1}, &mesh);
    return adopt(status, mesh, 0, out);
}

enum gd_status zoo_octahedron(const double *values, struct zoo_shape *out)
{
    struct sample_builder builder = {0};
    for (int axis = 0; axis < 3; axis++)
        for (int sign = 1; sign >= -1; sign -= 2)
            sample_add_vertex(&builder, axis == 0 ? sign * values[0] : 0,
                              axis == 1 ? sign * values[1] : 0, axis == 2 ? sign * values[2] : 0);
    for (uint32_t corner = 0; corner < 8; corner++) {
        uint32_t x = corner & 1, y = 2 + (corner >> 1 & 1), z = 4 + (corner >> 2);
        bool mirrored = (x + y + z) % 2;
        sample_add_triangle(&builder, x, mirrored ? z : y, mirrored ? y : z);
    }
    return finish(&builder, 0, out);
}

enum gd_status zoo_crumpled(const double *values, struct zoo_shape *out)
{
    uint32_t columns = whole(values[2]), rows = whole(values[3]);
    struct rng rng = {(uint64_t)values[0]};
    struct gd_polygons mesh = {0};
    enum gd_status status = sample_grid(columns, rows, columns, rows, &mesh);
    for (uint32_t v = 0; status == GD_OK && v < mesh.position_count; v++)
        for (int axis = 0; axis < 3 && rng_below(&rng, 2); axis++)
            mesh.positions[v][axis] += rng_between(&rng, -1.5, 1.5);
    if (status == GD_OK) sample_scale(&mesh, values[1], 1, 1);
    return adopt(status, mesh, rows / 2 * (columns + 1) + columns / 2, out);
}

enum gd_status zoo_tangle(const double *values, struct zoo_shape *out)
{
    struct gd_polygons mesh = {0};
    enum gd_status status = sample_tangle(whole(values[1]), (uint64_t)values[0], &mesh);
    if (status == GD_OK) sample_scale(&mesh, values[2], values[2], values[2]);
    for (uint32_t v = 0; status == GD_OK && v < mesh.position_count; v++)
        for (int axis = 0; axis < 3; axis++) mesh.positions[v][axis] += values[3];
    status = adopt(status, mesh, status == GD_OK ? mesh.corners[0] : 0, out);
    if (status == GD_OK) out->offset = values[3];
    return status;
}

enum gd_status zoo_assembly(const double *values, struct zoo_shape *out)
{
    struct gd_polygons large = {0}, small = {0};
    enum gd_status status = sample_tangle(24, (uint64_t)values[0], &large);
    if (status == GD_OK) status = sample_tangle(24, (uint64_t)values[0] + 1, &small);
    if (status == GD_OK) sample_scale(&small, values[1], values[1], values[1]);
    uint32_t centre = status == GD_OK ? large.position_count + small.corners[0] : 0;
    if (status == GD_OK) status = sample_append(&large, &small);
    gd_polygons_free(&small);
    if (status != GD_OK) gd_polygons_free(&large);
    return adopt(status, large, centre, out);
}

enum gd_status zoo_spike(const double *values, struct zoo_shape *out)
{
    uint32_t columns = whole(values[0]), middle = columns / 2;
    struct sample_builder builder = {0};
    for (uint32_t row = 0; row <= columns; row++)
        for (uint32_t column = 0; column <= columns; column++)
            sample_add_vertex(&builder, (double)column / columns, (double)row / columns, 0);
    sample_add_lattice(&builder,
                       (struct sample_lattice){.columns = columns + 1, .rows = columns + 1});
    uint32_t tip = sample_add_vertex(&builder, values[1], 0.5, 0),
             last = middle * (columns + 1) + columns;
    sample_add_triangle(&builder, last, tip, last + columns + 1);
    return finish(&builder, tip, out);
}
