/* Search: one pair of points from nothing, by windows that are kept on the way to the target. */
#ifndef GD_QUERY_SEARCH_H
#define GD_QUERY_SEARCH_H

#include "gd/query.h"

/* As gd_pair_solve. */
GD_MUST_USE enum gd_status gd__search(const struct gd_mesh *mesh,
                                      const struct gd_pair_request *request,
                                      const struct gd_control *control, struct gd_pair_answer *out);

#endif
