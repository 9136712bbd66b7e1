/* Answer: from a finished way to what the caller gets. */
#ifndef GD_NURBS_ANSWER_H
#define GD_NURBS_ANSWER_H

#include "nurbs/way.h"

/* GD_NO_MEMORY, GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__answer_make(const struct gd__way *way, struct gd_geodesic *out);

#endif
