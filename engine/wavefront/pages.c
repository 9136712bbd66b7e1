#include "wavefront/pages.h"

#include <stdlib.h>

/* Number of buckets after which an idle page is reused. Together, these buckets are about as wide
 * as a few edges are long. With a lower number, pages that are needed again soon would be reused.
 * With a higher number, more memory would be idle. */
#define REST       4
#define SLAB_PAGES 32

struct gd__page_slab {
    struct gd__page_slab *next;
    char pages[]; /* SLAB_PAGES pages */
};

enum gd_status gd__pages_open(struct gd__pages *pages, uint32_t count, size_t size,
                              uint32_t made_most, struct gd__budget *budget)
{
    enum gd_status status =
        gd__budget_take(budget, count * (sizeof *pages->page + sizeof *pages->made));
    if (status) return status;
    *pages =
        (struct gd__pages){.count = count, .size = size, .made_most = made_most, .budget = budget};
    pages->page = calloc(count, sizeof *pages->page);
    pages->made = calloc(count, sizeof *pages->made);
    if (pages->page && pages->made) return GD_OK;
    gd__pages_close(pages);
    return GD_NO_MEMORY;
}

void gd__pages_close(struct gd__pages *pages)
{
    while (pages->slab) {
        struct gd__page_slab *next = pages->slab->next;
        free(pages->slab);
        pages->slab = next;
    }
    free(pages->page);
    free(pages->made);
    *pages = (struct gd__pages){0};
}

static void page_line_up(struct gd__pages *pages, struct gd__page *page, uint32_t now)
{
    page->in_line = true;
    page->entered = now;
    page->next = NULL;
    if (pages->first)
        pages->last->next = page;
    else
        pages->first = page;
    pages->last = page;
}

void gd__pages_rest(struct gd__pages *pages, struct gd__page *page, uint32_t now)
{
    page->rested = now;
    if (!page->in_line) page_line_up(pages, page, now);
}

/* Removes a page that has been idle long enough from the line, and returns it. Returns NULL if
 * there is none. Pages that were used after they entered the line are removed too, or moved to the
 * end of the line. */
static struct gd__page *take_rested(struct gd__pages *pages, uint32_t now)
{
    while (pages->first && pages->first->entered + REST < now) {
        struct gd__page *page = pages->first;
        pages->first = page->next;
        page->in_line = false;
        if (page->waiting || page->stays) continue;
        if (page->rested + REST < now) {
            pages->page[page->number] = NULL;
            return page;
        }
        page_line_up(pages, page, now);
    }
    return NULL;
}

static enum gd_status add_slab(struct gd__pages *pages)
{
    size_t bytes = sizeof(struct gd__page_slab) + SLAB_PAGES * pages->size;
    enum gd_status status = gd__budget_take(pages->budget, bytes);
    struct gd__page_slab *slab = status ? NULL : malloc(bytes);
    if (!slab) return status ? status : GD_NO_MEMORY;
    slab->next = pages->slab;
    pages->slab = slab;
    pages->fresh = SLAB_PAGES;
    return GD_OK;
}

static struct gd__page *take_new(struct gd__pages *pages, enum gd_status *status)
{
    if (!pages->fresh) *status = add_slab(pages);
    return *status ? NULL : (struct gd__page *)(pages->slab->pages + --pages->fresh * pages->size);
}

enum gd_status gd__pages_make(struct gd__pages *pages, uint32_t number, uint32_t now)
{
    enum gd_status status = GD_OK;
    struct gd__page *page = take_rested(pages, now);
    if (!page) page = take_new(pages, &status);
    if (!page) return status;
    if (pages->made[number] < UINT8_MAX) pages->made[number]++;
    *page = (struct gd__page){
        .number = number, .rested = now, .stays = pages->made[number] > pages->made_most};
    pages->page[number] = page;
    return GD_OK;
}
