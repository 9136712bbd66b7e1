/* Pieces: converts the regions of a refined mesh to the result of a cut. */
#ifndef GD_CUT_PIECES_H
#define GD_CUT_PIECES_H

#include "cut/refine.h"
#include "gd/cut.h"

/* Fills in the requested pieces, `separates` and `bytes`. Errors: GD_INVALID_ARGUMENT (`inside`
 * lies on the curve), GD_NO_MEMORY, GD_BUDGET. Linear time. */
GD_MUST_USE enum gd_status gd__pieces_make(struct gd__refined *refined,
                                           const struct gd_cut_request *request,
                                           struct gd__budget *budget, struct gd_cut *out,
                                           struct gd_detail *detail);

#endif
