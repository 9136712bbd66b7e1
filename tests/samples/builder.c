#include "tests/samples/builder.h"

#include <stdlib.h>

/* Makes room for one more element in *array. Returns false if out of memory. */
static bool make_room(void **array, size_t element, uint32_t count, uint32_t *capacity)
{
    if (count < *capacity) return true;
    uint32_t wanted = *capacity ? 2 * *capacity : 64;
    void *grown = realloc(*array, wanted * element);
    if (!grown) return false;
    *array = grown;
    *capacity = wanted;
    return true;
}

uint32_t sample_add_vertex(struct sample_builder *builder, double x, double y, double z)
{
    struct gd_polygons *mesh = &builder->mesh;
    void *positions = mesh->positions;
    if (!make_room(&positions, sizeof *mesh->positions, mesh->position_count,
                   &builder->position_capacity)) {
        builder->failed = true;
        return 0;
    }
    mesh->positions = positions;
    double *position = mesh->positions[mesh->position_count];
    position[0] = x, position[1] = y, position[2] = z;
    return mesh->position_count++;
}

void sample_add_triangle(struct sample_builder *builder, uint32_t a, uint32_t b, uint32_t c)
{
    struct gd_polygons *mesh = &builder->mesh;
    void *corners = mesh->corners;
    if (!make_room(&corners, 3 * sizeof *mesh->corners, mesh->polygon_count,
                   &builder->triangle_capacity)) {
        builder->failed = true;
        return;
    }
    mesh->corners = corners;
    uint32_t *corner = &mesh->corners[3 * mesh->polygon_count++];
    corner[0] = a, corner[1] = b, corner[2] = c;
}

void sample_add_quad(struct sample_builder *builder, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    sample_add_triangle(builder, a, b, c);
    sample_add_triangle(builder, a, c, d);
}

void sample_add_lattice(struct sample_builder *builder, struct sample_lattice lattice)
{
    uint32_t columns = lattice.columns - !lattice.wrap_columns,
             rows = lattice.rows - !lattice.wrap_rows;
    for (uint32_t row = 0; row < rows; row++) {
        uint32_t here = lattice.first + row * lattice.columns;
        uint32_t above = lattice.first + (row + 1) % lattice.rows * lattice.columns;
        for (uint32_t column = 0; column < columns; column++) {
            uint32_t next = (column + 1) % lattice.columns;
            sample_add_quad(builder, here + column, here + next, above + next, above + column);
        }
    }
}

static bool is_solid(const struct sample_voxels *voxels, const uint32_t cell[3])
{
    for (int k = 0; k < 3; k++) /* a coordinate below zero wraps to a large number */
        if (cell[k] >= voxels->size[k]) return false;
    return voxels->solid(voxels, cell);
}

/* Returns the vertex at a lattice point. Adds the vertex at its first use. */
static uint32_t lattice_vertex(struct sample_builder *builder, const struct sample_voxels *voxels,
                               uint32_t *vertices, const uint32_t at[3])
{
    size_t slot = ((size_t)at[2] * (voxels->size[1] + 1) + at[1]) * (voxels->size[0] + 1) + at[0];
    if (vertices[slot] == GD_NONE) vertices[slot] = sample_add_vertex(builder, at[0], at[1], at[2]);
    return vertices[slot];
}

/* Adds the square between `cell` and its neighbour along `axis`, counter-clockwise seen from the
 * neighbour. `side` 0 selects the lower neighbour, 1 the upper neighbour. */
static void add_square(struct sample_builder *builder, const struct sample_voxels *voxels,
                       uint32_t *vertices, const uint32_t cell[3], int axis, uint32_t side)
{
    static const uint32_t around[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    uint32_t corner[4];
    for (int k = 0; k < 4; k++) {
        uint32_t at[3] = {cell[0], cell[1], cell[2]};
        at[axis] += side;
        at[(axis + 1) % 3] += around[k][!side];
        at[(axis + 2) % 3] += around[k][side];
        corner[k] = lattice_vertex(builder, voxels, vertices, at);
    }
    sample_add_quad(builder, corner[0], corner[1], corner[2], corner[3]);
}

void sample_add_voxels(struct sample_builder *builder, const struct sample_voxels *voxels)
{
    const uint32_t *size = voxels->size;
    size_t points = (size_t)(size[0] + 1) * (size[1] + 1) * (size[2] + 1);
    uint32_t *vertices = malloc(points * sizeof *vertices);
    if (!vertices) {
        builder->failed = true;
        return;
    }
    for (size_t i = 0; i < points; i++) vertices[i] = GD_NONE;
    for (size_t i = 0; i < (size_t)size[0] * size[1] * size[2]; i++) {
        uint32_t cell[3] = {(uint32_t)(i % size[0]), (uint32_t)(i / size[0] % size[1]),
                            (uint32_t)(i / size[0] / size[1])};
        if (!is_solid(voxels, cell)) continue;
        for (int face = 0; face < 6; face++) {
            uint32_t side = face & 1, neighbour[3] = {cell[0], cell[1], cell[2]};
            neighbour[face / 2] += side ? 1 : UINT32_MAX;
            if (!is_solid(voxels, neighbour))
                add_square(builder, voxels, vertices, cell, face / 2, side);
        }
    }
    free(vertices);
}

enum gd_status sample_finish(struct sample_builder *builder, struct gd_polygons *out)
{
    if (builder->failed) {
        gd_polygons_free(&builder->mesh);
        return GD_NO_MEMORY;
    }
    *out = builder->mesh;
    *builder = (struct sample_builder){0};
    return GD_OK;
}
