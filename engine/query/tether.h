/* Tether: the way between two points that a guide found, pulled tight, since its length is what
 * bounds a search. */
#ifndef GD_QUERY_TETHER_H
#define GD_QUERY_TETHER_H

#include "guide/guide.h"

/* Its length, but for rounding; of a guide that was aimed from `from` at `to`. GD_INTERNAL (the way
 * can't be laid flat: it bounds nothing then), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE.
 * Cost: some ten rounds over the faces along the way. */
GD_MUST_USE enum gd_status gd__tether_length(const struct gd__guide *guide,
                                             const struct gd_point *from, const struct gd_point *to,
                                             const struct gd_control *control, double *out);

#endif
