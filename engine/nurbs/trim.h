/* Trim: shortens a path between two curves if the path crosses one of them. */
#pragma once

#include "nurbs/candidate.h"

/* Step 3 of the paper's algorithm 2: if the path meets one of the curves between its ends, makes an
 * initial path from a part of the path. This part begins at the last place on the first curve, and
 * ends at the next place on the second curve. If the path meets a curve, sets *crosses to true and
 * writes `out`. Ignores ends that are points, because a path may pass through such a point. Errors:
 * GD_NO_MEMORY, GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__trim(const struct gd__task *task,
                                    const struct gd_domain_curve *const ends[2],
                                    const struct gd__candidate *candidate, bool *crosses,
                                    struct gd__path_seed *out);
