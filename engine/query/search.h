/* Search: computes the distance or path of one pair by a propagation towards the target, which is
 * not kept. */
#ifndef GD_QUERY_SEARCH_H
#define GD_QUERY_SEARCH_H

#include "gd/query.h"

/* As gd_pair_solve. */
GD_MUST_USE enum gd_status gd__search(const struct gd_mesh *mesh,
                                      const struct gd_pair_request *request,
                                      const struct gd_control *control, struct gd_pair_answer *out);

#endif
