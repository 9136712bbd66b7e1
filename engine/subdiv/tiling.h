/* Tiling: the level of each base face and edge, and the numbering of all vertices.
 *
 * The base points are the first vertices. The inner points of each edge follow, in the direction of
 * the side that owns the edge. The inner points of each face are last, row by row. */
#pragma once

#include "base/pace.h"
#include "subdiv/surface.h"

struct gd__tiling {
    const struct gd_subdivision *surface; /* borrowed */
    uint8_t *face_level, *edge_level;     /* an edge has the level of its finer face */
    /* for each base point, its vertex, or GD_NONE if no face uses the point */
    uint32_t *point;
    uint32_t *edge_first, *face_first;
    /* numbers of vertices and of triangles; gd__tiling_number fails beyond 2^32 - 1 */
    uint64_t vertices, triangles;
    struct gd__arena arena; /* freed by the caller, also after a failure */
};

/* Creates a tiling in which all faces have `level`. Error: GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__tiling_create(const struct gd_subdivision *surface, uint32_t level,
                                             struct gd__tiling *out);

/* Computes the levels of edges and all numbers from face_level. Error: GD_TOO_LARGE (more than
 * `most` triangles). */
GD_MUST_USE enum gd_status gd__tiling_number(struct gd__tiling *tiling, uint64_t most);

/* Returns the finest of the levels of a face and its edges. */
uint32_t gd__tiling_finest(const struct gd__tiling *tiling, uint32_t face);

/* Returns vertex `m` of the 2^level + 1 vertices along a side. */
uint32_t gd__tiling_on_side(const struct gd__tiling *tiling, uint32_t side, uint32_t m);

/* Returns vertex (i,j) inside a face with `cells` = 2^level cells along a side: 0 < i, j < cells
 * (Loop: i + j < cells). */
uint32_t gd__tiling_inside(const struct gd__tiling *tiling, uint32_t face, uint32_t cells,
                           uint32_t i, uint32_t j);

/* Computes (i,j) of point `m` on side `k` of a face with `cells` cells along a side. */
void gd__side_place(uint32_t arity, uint32_t k, uint32_t cells, uint32_t m, uint32_t out[2]);

/* Writes the triangles of a face to `corners`, and returns the end of the written entries.
 * `positions` contains the positions of all vertices of the tiling. Each cell is a step of the
 * pace. If the pace stops, the function returns early. */
uint32_t *gd__tile(const struct gd__tiling *tiling, uint32_t face, const double (*positions)[3],
                   uint32_t *corners, struct gd__pace *pace);
