/* Paged records: records of sides and vertices in pages (wavefront/pages.h), for a propagation that
 * computes distances only. They replace the workspace's arrays: a few bytes a face for the whole
 * mesh, and full records only near the front. A new record of a vertex where paths may bend states
 * that the vertex has emitted with its present distance (GD__FAR: not yet). */
#ifndef GD_WAVEFRONT_PAGED_H
#define GD_WAVEFRONT_PAGED_H

#include "mesh/topology.h"
#include "window/predecessor.h"
#include "window/list.h"
#include "wavefront/pages.h"

#define GD__PAGE_SIDES    64
#define GD__PAGE_VERTICES 32

struct gd__side_page {
    struct gd__page page;
    struct gd__list list[GD__PAGE_SIDES];
    uint32_t newest[GD__PAGE_SIDES / 2]; /* for each edge, as workspace->newest */
};

struct gd__vertex_page {
    struct gd__page page;
    uint32_t waiting[GD__PAGE_VERTICES];
    uint32_t valid_from[GD__PAGE_VERTICES];
    double emitted[GD__PAGE_VERTICES];
    struct gd__predecessor predecessor[GD__PAGE_VERTICES];
};

struct gd__paged {
    struct gd__pages sides, vertices;
    double *distance; /* Per vertex, GD__FAR at first. A sink may take this array and leave NULL. */
};

/* Allocates the pages. The struct must be all zero. Errors: GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__paged_open(struct gd__paged *paged, const struct gd_mesh *mesh,
                                          struct gd__budget *budget);

/* Frees everything and zeroes the struct. */
void gd__paged_close(struct gd__paged *paged);

/* Returns the page of a side or of a vertex, or NULL if there is none. */
static inline struct gd__side_page *gd__paged_side(const struct gd__paged *paged, uint32_t side)
{
    return (struct gd__side_page *)paged->sides.page[side / GD__PAGE_SIDES];
}

static inline struct gd__vertex_page *gd__paged_vertex(const struct gd__paged *paged,
                                                       uint32_t vertex)
{
    return (struct gd__vertex_page *)paged->vertices.page[vertex / GD__PAGE_VERTICES];
}

/* Creates the page if there is none, at bucket `now` of the queue. Errors: GD_NO_MEMORY,
 * GD_BUDGET. */
GD_MUST_USE enum gd_status gd__paged_need_side(struct gd__paged *paged, uint32_t side,
                                               uint32_t now);
GD_MUST_USE enum gd_status gd__paged_need_vertex(struct gd__paged *paged,
                                                 const struct gd_mesh *mesh, uint32_t vertex,
                                                 uint32_t now);

#endif
