/* Builder: collects the triangles of a mesh. A failed allocation is remembered and reported by
 * sample_finish, so that generators need no checks. */
#pragma once

#include <stdbool.h>

#include "gd/polygons.h"
#include "gd/status.h"

/* If all members are zero, the mesh is empty. */
struct sample_builder {
    struct gd_polygons mesh; /* the triangles added so far */
    uint32_t position_capacity, triangle_capacity;
    bool failed;
};

/* Returns the index of the new vertex, or 0 if out of memory. */
uint32_t sample_add_vertex(struct sample_builder *builder, double x, double y, double z);
void sample_add_triangle(struct sample_builder *builder, uint32_t a, uint32_t b, uint32_t c);
void sample_add_quad(struct sample_builder *builder, uint32_t a, uint32_t b, uint32_t c,
                     uint32_t d);

/* The topology of the vertices first + row * columns + column. */
struct sample_lattice {
    uint32_t first, columns, rows;
    bool wrap_columns, wrap_rows; /* the last column (row) is joined to the first */
};

/* Adds two triangles for each cell of the lattice. The triangles are counter-clockwise if columns
 * are numbered to the right and rows upwards. */
void sample_add_lattice(struct sample_builder *builder, struct sample_lattice lattice);

/* A block of size[0] x size[1] x size[2] voxels. `solid` returns whether a cell is solid. */
struct sample_voxels {
    uint32_t size[3];
    bool (*solid)(const struct sample_voxels *voxels, const uint32_t cell[3]);
};

/* Adds the surface of the solid cells, which are unit cubes. It is a 2-manifold unless solid cells
 * meet only in an edge or a corner. */
void sample_add_voxels(struct sample_builder *builder, const struct sample_voxels *voxels);

/* Moves the mesh to *out; the caller frees it by gd_polygons_free. If an allocation failed, frees
 * it and returns GD_NO_MEMORY. */
GD_MUST_USE enum gd_status sample_finish(struct sample_builder *builder, struct gd_polygons *out);
