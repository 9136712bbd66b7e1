/* Unfold: the faces that a line crosses, laid flat one after the other. */
#ifndef GD_LINE_UNFOLD_H
#define GD_LINE_UNFOLD_H

#include "gd/path.h"
#include "line/turn.h"

/* The straight line from the first to the last of some points. Inside unit. */
struct gd__straight {
    /* 0: the points are apart by less than rounding; the turns are of one direction then, and of
       its opposite */
    double length;
    double ahead, back; /* at the first point to the last, and the other way round */
};

/* Of at least two points of a path, of which only the first and the last may be anything but points
 * of edges. GD_INTERNAL: two that follow each other have no face in common. O(count). */
GD_MUST_USE enum gd_status gd__unfold(const struct gd_mesh *mesh, const struct gd_point *points,
                                      uint32_t count, struct gd__straight *out);

#endif
