/* Meetings: where a line meets itself. Its segments are kept by the face that they lie in, and its
 * vertices by themselves. */
#ifndef GD_TRANSPORT_MEETINGS_H
#define GD_TRANSPORT_MEETINGS_H

#include "gd/control.h"
#include "mesh/local.h"

struct gd__meetings;

/* Of a line that begins at `start`. GD_NO_MEMORY, GD_BUDGET. O(faces). */
GD_MUST_USE enum gd_status gd__meetings_create(const struct gd_mesh *mesh,
                                               const struct gd_point *start,
                                               const struct gd_control *control,
                                               struct gd__meetings **out);
void gd__meetings_destroy(struct gd__meetings *meetings); /* NULL is harmless */

/* Adds the line's next segment, in a face. `*part`: the part of it after which it first meets one
 * before, in (0, 1]; 2: it meets none. What it has in common with the segment before is its
 * beginning, which doesn't count. GD_NO_MEMORY, GD_BUDGET. O(segments in the face). */
GD_MUST_USE enum gd_status gd__meetings_add(struct gd__meetings *meetings, uint32_t face,
                                            const struct gd_point *from, const struct gd_point *to,
                                            double *part);

#endif
