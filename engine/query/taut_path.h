/* Taut path: the path that a guide found between two points, after straightening. Its length is the
 * upper bound of a search. */
#pragma once

#include "guide/guide.h"

/* Computes the length of the taut path from `from` to `to`, up to rounding. gd__guide_aim must have
 * been called for these points. Errors: GD_INTERNAL (the faces of the path cannot be unfolded;
 * there is no bound), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Cost: about ten rounds
 * over the faces along the path. */
GD_MUST_USE enum gd_status gd__taut_path_length(const struct gd__guide *guide,
                                                const struct gd_point *from,
                                                const struct gd_point *to,
                                                const struct gd_control *control, double *out);
