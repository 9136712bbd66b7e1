/* Tessellation: the grid, and the faces of each grid cell. */
#pragma once

#include "base/arena.h"
#include "nurbs/grid.h"

/* Node (i, j) of the grid has the number i * (steps[1] + 1) + j. In a closed direction the last
 * nodes are copies of the first. The nodes of a trimmed surface are grid nodes and places of the
 * loops, in any order. */
struct gd_tessellation {
    const struct gd_parametric *surface;
    struct gd__arena arena; /* those of the grid, the polygons and this struct */
    struct gd__grid grid;
    struct gd_polygons polygons;
    struct gd_mesh *mesh;
    uint32_t *vertex_of;    /* for each node, its vertex */
    uint32_t *node_of;      /* for each vertex, its first node */
    uint32_t (*corners)[3]; /* for each face, the nodes that are its corners */
    /* for each cell, its first face, and one more entry at the end; a cell at a pole has one face,
       others have two */
    uint32_t *first_face;
    /* Trimmed surfaces only: the parameters of each node. `first_face` is then NULL. */
    uint32_t node_count;
    double (*node_uv)[2];
};

static inline uint32_t gd__node_count(const struct gd__grid *grid)
{
    return (grid->steps[0] + 1) * (grid->steps[1] + 1);
}

static inline void gd__node_parameters(const struct gd_tessellation *t, uint32_t node, double uv[2])
{
    const struct gd__grid *grid = &t->grid;
    uv[0] = t->node_uv ? t->node_uv[node][0] : grid->at[0][node / (grid->steps[1] + 1)];
    uv[1] = t->node_uv ? t->node_uv[node][1] : grid->at[1][node % (grid->steps[1] + 1)];
}

/* From the grid, computes the nodes, vertices and faces for a trimmed surface. The boundary edges
 * deviate from the loops by at most GD__LOOPS_SAG. Errors: GD_TOO_LARGE, GD_INTERNAL, GD_NO_MEMORY,
 * GD_BUDGET, GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__tessellation_trim(struct gd_tessellation *tessellation,
                                                 const struct gd_control *control);

/* Allocates the arrays for at most that many nodes, and those for that many faces. */
void gd__tessellation_take_nodes(struct gd_tessellation *tessellation, size_t nodes);
void gd__tessellation_take_faces(struct gd_tessellation *tessellation, size_t faces);
