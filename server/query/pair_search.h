/* Pair search: distance and path of one pair for an exchange, without a field, within the byte
 * budget; and pairs that are legs of one route. */
#ifndef SERVER_QUERY_PAIR_SEARCH_H
#define SERVER_QUERY_PAIR_SEARCH_H

#include "gd/query.h"
#include "server/http/exchange.h"

/* Searches on behalf of the part's exchange, whose deadline, drain and client end it early.
 * `landmarks` may be NULL. Errors: those of gd_pair_solve; GD_BUDGET: not even all that could be
 * had was enough. */
GD_MUST_USE enum gd_status
server_pair_search(struct server_monitor *part, const struct gd_mesh *mesh,
                   const struct gd_point *from, const struct gd_point *to, enum gd_pair_wish wish,
                   const struct gd_landmarks *landmarks, struct gd_pair_answer *out);

/* Makes a route (all zero at first) longer by a leg that begins where it ends: distances and
 * lengths are summed, the paths become one polyline. The leg is used up in any case. A leg without
 * a path (INFINITY) leaves a route without. GD_NO_MEMORY. O(points of the leg). */
GD_MUST_USE enum gd_status server_pair_append(struct gd_pair_answer *route,
                                              struct gd_pair_answer *leg);

#endif
