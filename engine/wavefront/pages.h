/* Pages: the records of sides and of vertices where only those near the wavefront are kept.
 *
 * A field of distances only needs nothing of what lies behind the front but the distances. So
 * records lie in pages of some neighbours (numbers follow places, mesh/topology.h), made when one
 * of them is first asked for. A page on which nothing has waited for some buckets is used again for
 * another place; should the front come back there, its records begin anew. What must not be
 * forgotten keeps its page: wedges that were stored, and places that the front comes back to again
 * and again, where the visits of a side have to be counted for gd__prune_by_stored. One owner, one
 * thread. */
#ifndef GD_WAVEFRONT_PAGES_H
#define GD_WAVEFRONT_PAGES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/budget.h"

struct gd__page {
    uint32_t number;  /* of the page among all */
    uint32_t waiting; /* of its records, in the queue */
    uint32_t rested;  /* bucket of the queue since which none of them does */
    uint32_t entered; /* bucket in which it entered the line */
    bool in_line;
    bool stays;
    struct gd__page *next; /* in the line */
};

struct gd__pages {
    struct gd__page **page; /* NULL where there is none */
    uint8_t *made;          /* how often, saturating */
    uint32_t made_most;     /* a page that is made more often stays */
    uint32_t count;
    size_t size; /* of a page, what follows the header counted */
    /* their memory, the newest first: side by side, as the heap would scatter them */
    struct gd__page_slab *slab;
    uint32_t fresh; /* pages of the newest slab that were not used yet */
    /* the line: pages that rest, or did when they entered; the first came first */
    struct gd__page *first, *last;
    struct gd__budget *budget;
};

/* None are made yet; the budget pays for those that will be. A page that is made more than
 * `made_most` times stays; from UINT8_MAX on: however often. All zero before. GD_NO_MEMORY,
 * GD_BUDGET. */
GD_MUST_USE enum gd_status gd__pages_open(struct gd__pages *pages, uint32_t count, size_t size,
                                          uint32_t made_most, struct gd__budget *budget);

/* Frees all; all zero then. */
void gd__pages_close(struct gd__pages *pages);

/* Makes a page that is not there, at bucket `now` of the queue; its records are undefined. Pages on
 * which something waits, or did a few buckets ago, are where they were. GD_NO_MEMORY, GD_BUDGET.
 * Amortised O(1). */
GD_MUST_USE enum gd_status gd__pages_make(struct gd__pages *pages, uint32_t number, uint32_t now);

/* Nothing waits on the page, at bucket `now`: it may be used again later. */
void gd__pages_rest(struct gd__pages *pages, struct gd__page *page, uint32_t now);

#endif
