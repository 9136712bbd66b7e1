/* Family: equally long paths that can be moved continuously into each other, for example the
 * shortest paths between two parallel lines. */
#pragma once

#include "nurbs/candidate.h"

/* Sets *is_one to true if two minima belong to one family, that is, if they are equally long and
 * the path between them is also an equally long minimum. Errors: those of gd__newton. Cost: one
 * solution by Newton's method if the lengths are equal. */
GD_MUST_USE enum gd_status gd__is_one_family(const struct gd__task *task,
                                             const struct gd_domain_curve *const ends[2],
                                             const struct gd__candidate *const pair[2],
                                             bool *is_one);
