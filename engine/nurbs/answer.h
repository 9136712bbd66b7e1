/* Answer: converts a refined candidate to the caller's struct. */
#pragma once

#include "nurbs/candidate.h"

/* Converts a candidate. Errors: GD_NO_MEMORY, GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__answer_make(const struct gd__candidate *candidate,
                                           const struct gd_domain_curve *const ends[2],
                                           struct gd_geodesic *out);

/* Frees the memory that gd__answer_make has allocated. */
void gd__answer_free(struct gd_geodesic *geodesic);
