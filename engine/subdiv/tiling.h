/* Tiling: how fine each base face and edge is cut, and the numbers of the vertices that this makes.
 *
 * Vertices are numbered: base points, then the inner points of edges, edge by edge in the direction
 * of the owning side, then those of faces, row by row. */
#ifndef GD_SUBDIV_TILING_H
#define GD_SUBDIV_TILING_H

#include "base/pace.h"
#include "subdiv/surface.h"

struct gd__tiling {
    const struct gd_subdivision *surface; /* borrowed */
    uint8_t *face_level, *edge_level;     /* edge: of the finer face beside it */
    /* per base point: its vertex, GD_NONE if no face has it */
    uint32_t *point;
    uint32_t *edge_first, *face_first;
    uint64_t vertices, triangles; /* at most 2^32 - 1 each, or gd__tiling_number fails */
};

/* With all levels `level`. GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__tiling_create(const struct gd_subdivision *surface, uint32_t level,
                                             struct gd__tiling *out);
void gd__tiling_free(struct gd__tiling *tiling);

/* Edges' levels and all numbers, from face_level. GD_TOO_LARGE: more than `most` triangles. */
GD_MUST_USE enum gd_status gd__tiling_number(struct gd__tiling *tiling, uint64_t most);

/* The finest level at a face or its edges. */
uint32_t gd__tiling_finest(const struct gd__tiling *tiling, uint32_t face);

/* Vertex `m` of the 2^level + 1 along a side. */
uint32_t gd__tiling_on_side(const struct gd__tiling *tiling, uint32_t side, uint32_t m);

/* Vertex (i,j) inside of a face of 2^level = `cells`: 0 < i, j < cells (Loop: i + j < cells). */
uint32_t gd__tiling_inside(const struct gd__tiling *tiling, uint32_t face, uint32_t cells,
                           uint32_t i, uint32_t j);

/* (i,j) of point `m` of side `k` of a face in `cells`. */
void gd__side_place(uint32_t arity, uint32_t k, uint32_t cells, uint32_t m, uint32_t out[2]);

/* Appends the triangles of a face at `corners` and returns its end. `positions` are all vertices'.
 * A step of the pace is a cell; where it ends, so do the triangles. */
uint32_t *gd__tile(const struct gd__tiling *tiling, uint32_t face, const double (*positions)[3],
                   uint32_t *corners, struct gd__pace *pace);

#endif
