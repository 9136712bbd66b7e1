/* Pair search: distance and path of one pair for an exchange, without a field, within the byte budget. */
#ifndef SERVER_PAIR_SEARCH_H
#define SERVER_PAIR_SEARCH_H

#include "gd/query.h"
#include "server/exchange.h"

/* Searches on behalf of the exchange, whose deadline, drain and client end it early. Errors: those of gd_pair_solve;
 * GD_BUDGET: not even all that could be had was enough. */
GD_MUST_USE enum gd_status server_pair_search(struct server_exchange *exchange, const struct gd_mesh *mesh,
                                              const struct gd_point *from, const struct gd_point *to, bool want_path,
                                              const struct gd_landmarks *landmarks, struct gd_pair_answer *out);

#endif
