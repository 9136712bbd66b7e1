/* Meetings: detects where a line meets itself. Segments are indexed by face. The vertices that the
 * line passes are marked separately. */
#pragma once

#include "gd/control.h"
#include "mesh/local.h"

struct gd__meetings;

/* Creates the index of a line that begins at `start`. Errors: GD_NO_MEMORY, GD_BUDGET. O(faces). */
GD_MUST_USE enum gd_status gd__meetings_create(const struct gd_mesh *mesh,
                                               const struct gd_point *start,
                                               const struct gd_control *control,
                                               struct gd__meetings **out);
void gd__meetings_destroy(struct gd__meetings *meetings); /* NULL is allowed */

/* Adds the line's next segment, which lies in `face`. Sets *part to the fraction of the segment, in
 * (0, 1], at which it first meets an earlier segment, or to 2 if it meets none. The end of the
 * previous segment, where this segment begins, does not count. Errors: GD_NO_MEMORY, GD_BUDGET.
 * O(segments in the face). */
GD_MUST_USE enum gd_status gd__meetings_add(struct gd__meetings *meetings, uint32_t face,
                                            const struct gd_point *from, const struct gd_point *to,
                                            double *part);
