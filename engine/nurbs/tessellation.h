/* Tessellation: the grid, and the faces of each grid cell. */
#ifndef GD_NURBS_TESSELLATION_H
#define GD_NURBS_TESSELLATION_H

#include "base/references.h"
#include "nurbs/grid.h"

/* Node (i, j) of the grid has the number i * (steps[1] + 1) + j. In a closed direction the last
 * nodes are copies of the first. */
struct gd_tessellation {
    const struct gd_parametric *surface;
    struct gd__grid grid;
    struct gd_polygons polygons;
    struct gd_mesh *mesh;
    uint32_t *vertex_of;    /* node -> vertex */
    uint32_t *node_of;      /* vertex -> its first node */
    uint32_t (*corners)[3]; /* face -> nodes of its cell */
    /* cell -> its first face, with one more entry; a cell at a pole has one face, others have
       two */
    uint32_t *first_face;
    atomic_uint references;
};

static inline uint32_t gd__node_count(const struct gd__grid *grid)
{
    return (grid->steps[0] + 1) * (grid->steps[1] + 1);
}

static inline void gd__node_parameters(const struct gd__grid *grid, uint32_t node, double uv[2])
{
    uv[0] = grid->at[0][node / (grid->steps[1] + 1)];
    uv[1] = grid->at[1][node % (grid->steps[1] + 1)];
}

#endif
