/* Pages: records of sides and vertices that exist only near the wavefront. A propagation that
 * computes distances only needs no records behind the front. The records of neighbouring elements
 * share a page, because neighbours have similar numbers (mesh/topology.h). A page is created at its
 * first use. If none of its records has been in the queue for some buckets, its memory is reused
 * for another page. If the front returns, the page is created again, and its records have their
 * initial values. Two kinds of pages are never reused: pages with stored wedges, and pages that
 * were created repeatedly. The latter are kept because their lists must count visits for
 * gd__prune_by_stored. One owner, one thread. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/budget.h"

struct gd__page {
    uint32_t number;  /* number of the page */
    uint32_t waiting; /* number of its records that wait in the queue */
    uint32_t rested;  /* bucket of the queue at which the last of its records stopped waiting */
    /* bucket of the queue at which the page entered the line (see struct gd__pages) */
    uint32_t entered;
    bool in_line;
    bool stays;
    struct gd__page *next; /* next page in the line */
};

struct gd__pages {
    struct gd__page **page; /* for each number, the page, NULL if it does not exist */
    uint8_t *made;          /* number of times the page was created, saturating */
    uint32_t made_most;     /* a page that was created more often than this is not reused */
    uint32_t count;
    size_t size; /* bytes of a page with its header */
    /* Memory of the pages, newest first. Slabs hold pages side by side, because the heap would
     * scatter them. */
    struct gd__page_slab *slab;
    uint32_t fresh; /* number of unused pages of the newest slab */
    /* The line: pages whose memory may be reused, the oldest first. A page enters the line when it
     * becomes idle. */
    struct gd__page *first, *last;
    struct gd__budget *budget;
};

/* Initialises the struct, which must be all zero, without pages. Each new page is charged to the
 * budget. A page that was created more than `made_most` times is not reused. If `made_most` is
 * UINT8_MAX or more, every page may be reused. Errors: GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__pages_open(struct gd__pages *pages, uint32_t count, size_t size,
                                          uint32_t made_most, struct gd__budget *budget);

/* Frees everything and zeroes the struct. */
void gd__pages_close(struct gd__pages *pages);

/* Creates a missing page at bucket `now` of the queue. Its records are undefined. Does not reuse
 * the memory of pages whose records wait, or waited a few buckets ago. Errors: GD_NO_MEMORY,
 * GD_BUDGET. Amortised O(1). */
GD_MUST_USE enum gd_status gd__pages_make(struct gd__pages *pages, uint32_t number, uint32_t now);

/* Notes that no record of the page waits at bucket `now`. The page may be reused later. */
void gd__pages_rest(struct gd__pages *pages, struct gd__page *page, uint32_t now);
