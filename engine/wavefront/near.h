/* Near: what a propagation that keeps distances only knows of sides and vertices, by pages
 * (wavefront/pages.h): instead of the workspace's arrays some bytes a face for the whole mesh, and
 * records where the front is.
 *
 * A vertex whose record is not there has emitted if it is reached and paths may bend there: else it
 * would wait. */
#ifndef GD_WAVEFRONT_NEAR_H
#define GD_WAVEFRONT_NEAR_H

#include "mesh/topology.h"
#include "window/predecessor.h"
#include "window/list.h"
#include "wavefront/pages.h"

#define GD__PAGE_SIDES    64
#define GD__PAGE_VERTICES 32

struct gd__side_page {
    struct gd__page page;
    struct gd__list list[GD__PAGE_SIDES];
    uint32_t newest[GD__PAGE_SIDES / 2]; /* per edge */
};

struct gd__vertex_page {
    struct gd__page page;
    uint32_t waiting[GD__PAGE_VERTICES];
    uint32_t since[GD__PAGE_VERTICES];
    double emitted[GD__PAGE_VERTICES];
    struct gd__predecessor predecessor[GD__PAGE_VERTICES];
};

struct gd__near {
    struct gd__pages sides, vertices;
    double *distance; /* per vertex, GD__FAR at first; a sink may keep it, leaving NULL */
};

/* All zero before. GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__near_open(struct gd__near *near, const struct gd_mesh *mesh,
                                         struct gd__budget *budget);

/* Frees all; all zero then. */
void gd__near_close(struct gd__near *near);

/* The page of a side or of a vertex; NULL where there is none. */
static inline struct gd__side_page *gd__near_side(const struct gd__near *near, uint32_t side)
{
    return (struct gd__side_page *)near->sides.page[side / GD__PAGE_SIDES];
}

static inline struct gd__vertex_page *gd__near_vertex(const struct gd__near *near, uint32_t vertex)
{
    return (struct gd__vertex_page *)near->vertices.page[vertex / GD__PAGE_VERTICES];
}

/* Makes sure that there is one, at bucket `now` of the queue. GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__near_need_side(struct gd__near *near, uint32_t side, uint32_t now);
GD_MUST_USE enum gd_status gd__near_need_vertex(struct gd__near *near, const struct gd_mesh *mesh,
                                                uint32_t vertex, uint32_t now);

#endif
