/* Limit grid: the positions of a grid over each base face, and the triangles between these
 * positions.
 *
 * A vertex is a place (i, j) of a base face, 0 <= i, j <= cells (Loop: i + j <= cells). A vertex on
 * the border of a face is also a place of the neighbours, with the same position. An edge is
 * directed, from vertex p to vertex q of one face; its triangle lies to its left. */
#pragma once

#include "gd/limit_grid.h"
#include "subdiv/surface.h"

struct gd_limit_grid {
    struct gd_subdivision *surface; /* one reference is owned */
    uint32_t level, cells;
    uint32_t stride; /* number of positions of a face: (cells + 1)^2 */
    /* place (i, j) of a face is at index face * stride + i (cells + 1) + j */
    struct gd_vec3 *positions;
};

struct gd__grid_edge {
    uint32_t face;
    int32_t p[2], q[2];
};

static inline struct gd_vec3 gd__grid_position(const struct gd_limit_grid *grid, uint32_t face,
                                               const int32_t at[2])
{
    return grid->positions[(size_t)face * grid->stride +
                           (uint32_t)at[0] * (grid->cells + (size_t)1) + (uint32_t)at[1]];
}

/* If the triangle to the left of an edge is outside the edge's face, converts the edge to the
 * neighbouring face. Returns false at the boundary of the surface. */
bool gd__grid_settle(const struct gd_limit_grid *grid, struct gd__grid_edge *edge);

/* Computes the third corner of the triangle to the left of an edge that lies inside the face. */
void gd__grid_apex(const struct gd_limit_grid *grid, const struct gd__grid_edge *edge,
                   int32_t apex[2]);

/* Finds the triangle that contains a place of a base face. Computes its corners, counter-clockwise,
 * and the place's barycentric coordinates. */
void gd__grid_triangle(const struct gd_limit_grid *grid, const struct gd__face_place *place,
                       int32_t corners[3][2], double weights[3]);
