#include "wavefront/paged.h"

#include <stdlib.h>
#include <string.h>

#include "base/large.h"

/* A page of sides that was created more than this number of times is not reused. So its lists
 * continue to count visits, as gd__prune_by_stored requires. */
#define SIDES_MADE_MOST 4

static uint32_t pages_of(uint32_t count, uint32_t records)
{
    return count / records + 1;
}

static enum gd_status open_distances(struct gd__paged *paged, uint32_t vertices,
                                     struct gd__budget *budget)
{
    enum gd_status status = gd__budget_take(budget, vertices * sizeof *paged->distance);
    if (status) return status;
    paged->distance = gd__large_array(vertices, sizeof *paged->distance);
    if (!paged->distance) return GD_NO_MEMORY;
    for (uint32_t v = 0; v < vertices; v++) paged->distance[v] = GD__FAR;
    return GD_OK;
}

enum gd_status gd__paged_open(struct gd__paged *paged, const struct gd_mesh *mesh,
                              struct gd__budget *budget)
{
    uint32_t sides = pages_of(2 * mesh->edge_count, GD__PAGE_SIDES),
             vertices = pages_of(mesh->vertex_count, GD__PAGE_VERTICES);
    enum gd_status status = open_distances(paged, mesh->vertex_count, budget);
    if (!status)
        status = gd__pages_open(&paged->sides, sides, sizeof(struct gd__side_page), SIDES_MADE_MOST,
                                budget);
    if (!status)
        status = gd__pages_open(&paged->vertices, vertices, sizeof(struct gd__vertex_page),
                                UINT8_MAX, budget);
    if (status) gd__paged_close(paged);
    return status;
}

void gd__paged_close(struct gd__paged *paged)
{
    gd__pages_close(&paged->sides);
    gd__pages_close(&paged->vertices);
    free(paged->distance);
    paged->distance = NULL;
}

enum gd_status gd__paged_need_side(struct gd__paged *paged, uint32_t side, uint32_t now)
{
    if (gd__paged_side(paged, side)) return GD_OK;
    enum gd_status status = gd__pages_make(&paged->sides, side / GD__PAGE_SIDES, now);
    if (status) return status;
    struct gd__side_page *page = gd__paged_side(paged, side);
    /* `touched` is true, because a page needs no cleaning */
    for (uint32_t i = 0; i < GD__PAGE_SIDES; i++)
        page->list[i] = (struct gd__list){.bucket = GD_NONE, .touched = true};
    memset(page->newest, 0xff, sizeof page->newest);
    return GD_OK;
}

enum gd_status gd__paged_need_vertex(struct gd__paged *paged, const struct gd_mesh *mesh,
                                     uint32_t vertex, uint32_t now)
{
    if (gd__paged_vertex(paged, vertex)) return GD_OK;
    enum gd_status status = gd__pages_make(&paged->vertices, vertex / GD__PAGE_VERTICES, now);
    if (status) return status;
    struct gd__vertex_page *page = gd__paged_vertex(paged, vertex);
    uint32_t first = vertex - vertex % GD__PAGE_VERTICES;
    for (uint32_t i = 0; i < GD__PAGE_VERTICES && first + i < mesh->vertex_count; i++) {
        page->waiting[i] = GD_NONE;
        page->valid_from[i] = 0;
        page->emitted[i] =
            mesh->vertex_kind[first + i] == GD_VERTEX_CONVEX ? GD__FAR : paged->distance[first + i];
    }
    gd__pages_rest(&paged->vertices, &page->page, now);
    return GD_OK;
}
