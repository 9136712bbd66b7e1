/* Shortest: the shortest path between two points for queries that need one and no more: from a
 * cached field of either, or by a search. */
#ifndef SERVER_QUERY_SHORTEST_H
#define SERVER_QUERY_SHORTEST_H

#include "gd/query.h"
#include "server/query/query.h"

/* `part` is for the search. Distance INFINITY and no path: there is none. Errors: those of
 * server_pair_search. */
GD_MUST_USE enum gd_status server_shortest_path(const struct server_query *query,
                                                struct server_monitor *part,
                                                const struct gd_point *from,
                                                const struct gd_point *to, enum gd_pair_wish wish,
                                                struct gd_pair_answer *out);

#endif
