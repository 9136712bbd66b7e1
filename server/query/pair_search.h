/* Pair search: distance and shortest path between two points, without building a field. */
#ifndef SERVER_QUERY_PAIR_SEARCH_H
#define SERVER_QUERY_PAIR_SEARCH_H

#include "gd/query.h"
#include "server/exchange/exchange.h"
#include "server/surfaces/surface.h"

struct server_pair {
    const struct gd_point *from, *to;
    enum gd_pair_wish wish;
};

/* Searches on behalf of the part's exchange, with the mesh's landmarks, within the memory budget.
 * Distance INFINITY: there is no path. Errors: those of gd_pair_solve; GD_BUDGET: all memory that
 * could be had was too little. Thread-safe. */
GD_MUST_USE enum gd_status server_pair_search(struct server_monitor *part,
                                              struct server_surface *surface,
                                              const struct server_pair *pair,
                                              struct gd_pair_answer *out);

/* The cached field of either point, pinned, or NULL. */
const struct server_cached *server_pair_find_field(struct server_surface *surface,
                                                   const struct server_pair *pair);

/* Answers from the cached field of either point, else by a search. */
GD_MUST_USE enum gd_status server_pair_solve(struct server_monitor *part,
                                             struct server_surface *surface,
                                             const struct server_pair *pair,
                                             struct gd_pair_answer *out);

/* Appends to a route (all zero at first) a leg that begins where the route ends: adds distances and
 * lengths, and joins the polylines. Frees the leg. A leg without a path (INFINITY) leaves a route
 * without. GD_NO_MEMORY. O(points of the leg). */
GD_MUST_USE enum gd_status server_pair_append(struct gd_pair_answer *route,
                                              struct gd_pair_answer *leg);

#endif
