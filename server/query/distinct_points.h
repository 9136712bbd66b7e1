/* Distinct points: each point of a list once, so that what is asked for twice is computed once. */
#ifndef SERVER_QUERY_DISTINCT_POINTS_H
#define SERVER_QUERY_DISTINCT_POINTS_H

#include <stdbool.h>

#include "gd/point.h"

struct server_distinct { /* all zero is an empty one */
    struct gd_point *points;
    uint32_t count;
    uint32_t *number; /* per point of the list: which of `points` it is. In their memory */
};

/* In an order of their own. False without memory. O(n log n). */
bool server_distinct_find(const struct gd_point *points, uint32_t count,
                          struct server_distinct *out);
void server_distinct_free(struct server_distinct *distinct); /* a second time is harmless */

#endif
