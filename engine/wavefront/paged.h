/* Paged records: records of sides and vertices in pages (wavefront/pages.h), for a propagation that
 * computes distances only. They replace the workspace's arrays: the whole mesh takes a few bytes a
 * face, and full records exist only near the front. In a new record of a vertex where paths may
 * bend, `emitted` is the vertex' present distance, as if the vertex had emitted with this distance.
 * If the distance is GD__FAR, the vertex has not emitted yet. */
#pragma once

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
    /* For each vertex, its distance, GD__FAR at first. A sink may take this array; it then sets the
       pointer to NULL. */
    double *distance;
};

/* Allocates the tables of pages, without pages. The struct must be all zero. Errors: GD_NO_MEMORY,
 * GD_BUDGET. */
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
