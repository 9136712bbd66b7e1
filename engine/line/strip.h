/* Strip: the faces that a line runs through, from a point to another, over sides that are known one
 * by one; and the shortest line in it. Inside unit. */
#ifndef GD_LINE_STRIP_H
#define GD_LINE_STRIP_H

#include "mesh/local.h"
#include "line/route.h"

/* A side over which the strip enters the side's face, and how it lies in the plane into which all
 * are laid. Left of the way is the side's origin. */
struct gd__gate {
    uint32_t side;
    struct gd__local left, right;
    struct gd__local along; /* unit vector of the side */
};

/* All zero is an empty strip. */
struct gd__strip {
    struct gd_point from, to;
    uint32_t face;          /* in which it begins, laid into the frame of its side 0 */
    struct gd__gate *gates; /* owned */
    uint32_t count, capacity;
    /* a way back over a gate is another gate; else it takes that away */
    bool keeps_ways_back;
    struct gd__local begin, end; /* of the line, in the plane */
};

void gd__strip_free(struct gd__strip *strip);

/* One more gate; a way back over the last one takes that away instead, unless the strip keeps it.
 * GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__strip_push(struct gd__strip *strip, uint32_t side,
                                          const struct gd_control *control);

/* Gates around a vertex, from one of its faces to another, counter-clockwise (the vertex is at
 * their left) or clockwise. GD_INTERNAL: the boundary is between. O(gates). */
GD_MUST_USE enum gd_status gd__strip_wind(const struct gd_mesh *mesh, struct gd__strip *strip,
                                          uint32_t vertex, uint32_t from_face, uint32_t to_face,
                                          bool counter_clockwise, const struct gd_control *control);

/* The strip along a route of at least two points. Around a vertex of the route it goes the way of
 * fewer faces. The strip's memory is used again. GD_INTERNAL: two points that follow each other
 * have no face in common. O(points, and faces around its vertices). */
GD_MUST_USE enum gd_status gd__strip_along(const struct gd_mesh *mesh,
                                           const struct gd__route *route, struct gd__strip *strip,
                                           const struct gd_control *control);

/* Leaves out gates at the ends on which `from` or `to` lie, and lays the strip flat. GD_INTERNAL:
 * it is none. O(count). */
GD_MUST_USE enum gd_status gd__strip_lay(const struct gd_mesh *mesh, struct gd__strip *strip);

/* The side from which the first face of a strip is laid, as if it were a gate; and where a point of
 * the face behind a gate lies in the plane. */
struct gd__gate gd__strip_entrance(const struct gd_mesh *mesh, const struct gd__strip *strip);
struct gd__local gd__gate_place(const struct gd_mesh *mesh, const struct gd__gate *gate,
                                const struct gd_point *point);

/* A vertex at which the shortest line in a strip bends: the left or right end of a gate; of several
 * gates in a row the last. */
struct gd__corner {
    uint32_t gate;
    bool is_left;
    struct gd__local at;
};

/* The corners, in order, into an array of strip->count; their number is the result. Lee and
 * Preparata's funnel, as it is known from path finding: O(count) but for what is looked at again
 * behind a corner. The strip must have been laid. */
uint32_t gd__strip_corners(const struct gd__strip *strip, struct gd__corner *out);

/* The line through the corners, into an empty route. GD_NO_MEMORY, GD_BUDGET. O(count). */
GD_MUST_USE enum gd_status gd__strip_line(const struct gd_mesh *mesh, const struct gd__strip *strip,
                                          const struct gd__corner *corners, uint32_t corner_count,
                                          struct gd__route *out, const struct gd_control *control);

#endif
