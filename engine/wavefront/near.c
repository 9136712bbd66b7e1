#include "wavefront/near.h"

#include <stdlib.h>
#include <string.h>

#include "base/large.h"

#define SIDES_MADE_MOST                                                                            \
    4 /* then the visits of its sides are counted for good, see gd__prune_by_stored */

static uint32_t pages_of(uint32_t count, uint32_t records)
{
    return count / records + 1;
}

static enum gd_status open_distances(struct gd__near *near, uint32_t vertices,
                                     struct gd__budget *budget)
{
    enum gd_status status = gd__budget_take(budget, vertices * sizeof *near->distance);
    if (status) return status;
    near->distance = gd__large_array(vertices, sizeof *near->distance);
    if (!near->distance) return GD_NO_MEMORY;
    for (uint32_t v = 0; v < vertices; v++) near->distance[v] = GD__FAR;
    return GD_OK;
}

enum gd_status gd__near_open(struct gd__near *near, const struct gd_mesh *mesh,
                             struct gd__budget *budget)
{
    uint32_t sides = pages_of(2 * mesh->edge_count, GD__PAGE_SIDES),
             vertices = pages_of(mesh->vertex_count, GD__PAGE_VERTICES);
    enum gd_status status = open_distances(near, mesh->vertex_count, budget);
    if (!status)
        status = gd__pages_open(&near->sides, sides, sizeof(struct gd__side_page), SIDES_MADE_MOST,
                                budget);
    if (!status)
        status = gd__pages_open(&near->vertices, vertices, sizeof(struct gd__vertex_page),
                                UINT8_MAX, budget);
    if (status) gd__near_close(near);
    return status;
}

void gd__near_close(struct gd__near *near)
{
    gd__pages_close(&near->sides);
    gd__pages_close(&near->vertices);
    free(near->distance);
    near->distance = NULL;
}

enum gd_status gd__near_need_side(struct gd__near *near, uint32_t side, uint32_t now)
{
    if (gd__near_side(near, side)) return GD_OK;
    enum gd_status status = gd__pages_make(&near->sides, side / GD__PAGE_SIDES, now);
    if (status) return status;
    struct gd__side_page *page = gd__near_side(near, side);
    for (uint32_t i = 0; i < GD__PAGE_SIDES; i++) /* there is nothing to clean later */
        page->list[i] = (struct gd__list){.bucket = GD_NONE, .touched = true};
    memset(page->newest, 0xff, sizeof page->newest);
    return GD_OK;
}

enum gd_status gd__near_need_vertex(struct gd__near *near, const struct gd_mesh *mesh,
                                    uint32_t vertex, uint32_t now)
{
    if (gd__near_vertex(near, vertex)) return GD_OK;
    enum gd_status status = gd__pages_make(&near->vertices, vertex / GD__PAGE_VERTICES, now);
    if (status) return status;
    struct gd__vertex_page *page = gd__near_vertex(near, vertex);
    uint32_t first = vertex - vertex % GD__PAGE_VERTICES;
    for (uint32_t i = 0; i < GD__PAGE_VERTICES && first + i < mesh->vertex_count; i++) {
        page->waiting[i] = GD_NONE;
        page->since[i] = 0;
        page->emitted[i] =
            mesh->vertex_kind[first + i] == GD_VERTEX_CONVEX ? GD__FAR : near->distance[first + i];
    }
    gd__pages_rest(&near->vertices, &page->page, now);
    return GD_OK;
}
