/* Builder: triangles under construction. A failed allocation is remembered and reported once, by
 * sample_finish, so that generators read as recipes. */
#ifndef TESTS_SAMPLES_BUILDER_H
#define TESTS_SAMPLES_BUILDER_H

#include <stdbool.h>

#include "gd/polygons.h"
#include "gd/status.h"

/* Starts all-zero. */
struct sample_builder {
    struct gd_polygons mesh; /* triangles; what was added so far */
    uint32_t position_capacity, triangle_capacity;
    bool failed;
};

/* The index of the new vertex, or 0 when memory is out. */
uint32_t sample_add_vertex(struct sample_builder *builder, double x, double y, double z);
void sample_add_triangle(struct sample_builder *builder, uint32_t a, uint32_t b, uint32_t c);
void sample_add_quad(struct sample_builder *builder, uint32_t a, uint32_t b, uint32_t c,
                     uint32_t d);

/* How the vertices first + row * columns + column hang together. */
struct sample_lattice {
    uint32_t first, columns, rows;
    bool wrap_columns, wrap_rows; /* the last one is joined to column 0, row 0 */
};

/* Two triangles for each cell of the lattice; counter-clockwise is from columns to rows. */
void sample_add_lattice(struct sample_builder *builder, struct sample_lattice lattice);

/* The cells of a block of size[0] x size[1] x size[2] voxels that are solid. */
struct sample_voxels {
    uint32_t size[3];
    bool (*solid)(const struct sample_voxels *voxels, const uint32_t cell[3]);
};

/* The outside of the solid cells, each cell a unit cube. A 2-manifold unless solid cells meet in an
 * edge or a corner alone. */
void sample_add_voxels(struct sample_builder *builder, const struct sample_voxels *voxels);

/* Hands the mesh over, to be freed by gd_polygons_free, or frees it and returns GD_NO_MEMORY. */
GD_MUST_USE enum gd_status sample_finish(struct sample_builder *builder, struct gd_polygons *out);

#endif
