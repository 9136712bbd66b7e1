/* Strip: the sequence of faces that a line between two points crosses, stored as the crossed sides.
 * Also computes the shortest line in a strip. Normalised unit. */
#pragma once

#include "line/portal.h"
#include "line/route.h"

/* A struct that is all zero is an empty strip. */
struct gd__strip {
    struct gd_point from, to;
    uint32_t face;              /* the first face, placed in the frame of its side 0 */
    struct gd__portal *portals; /* owned */
    uint32_t count, capacity;
    /* Determines what happens if the strip crosses its last portal in the opposite direction. If
       true, a new portal is added. If false, the last portal is removed. */
    bool keeps_ways_back;
    struct gd__local begin, end; /* the line's ends in the plane */
};

void gd__strip_free(struct gd__strip *strip);

/* Appends a portal. If `side` crosses the last portal in the opposite direction, removes the last
 * portal instead, unless keeps_ways_back is set. Errors: GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__strip_push(struct gd__strip *strip, uint32_t side,
                                          const struct gd_control *control);

/* Appends the portals around a vertex from one of its faces to another. Counter-clockwise, the
 * vertex is the left end of these portals; clockwise, it is their right end. Error: GD_INTERNAL
 * (the mesh's boundary is between the two faces). O(portals). */
GD_MUST_USE enum gd_status gd__strip_wind(const struct gd_mesh *mesh, struct gd__strip *strip,
                                          uint32_t vertex, uint32_t from_face, uint32_t to_face,
                                          bool counter_clockwise, const struct gd_control *control);

/* Builds the strip along a route of at least two points. At a vertex of the route, the strip passes
 * the vertex on the side with fewer faces. Reuses the strip's memory. Error: GD_INTERNAL (two
 * consecutive points have no common face). O(points + faces around the vertices). */
GD_MUST_USE enum gd_status gd__strip_along(const struct gd_mesh *mesh,
                                           const struct gd__route *route, struct gd__strip *strip,
                                           const struct gd_control *control);

/* Removes unnecessary portals at both ends of the strip: those at the beginning that contain the
 * line's first point, and those at the end that contain its last point. Then unfolds the strip.
 * Error: GD_INTERNAL (not a valid strip). O(count). */
GD_MUST_USE enum gd_status gd__strip_lay(const struct gd_mesh *mesh, struct gd__strip *strip);

/* Returns side 0 of the strip's first face as a portal. The plane has the frame of this side. */
static inline struct gd__portal gd__strip_entrance(const struct gd_mesh *mesh,
                                                   const struct gd__strip *strip)
{
    return gd__portal_entrance(mesh, strip->face);
}

/* A vertex where the shortest line in a strip bends: the left or right end of a portal. If several
 * consecutive portals end there, `portal` is the last one. */
struct gd__corner {
    uint32_t portal;
    bool is_left;
    struct gd__local at;
};

/* Writes the corners in order to an array of strip->count items and returns their number. Uses the
 * funnel algorithm of Lee and Preparata. The time is O(count), plus the time for portals that are
 * scanned again, because the algorithm restarts at the portal of each corner. The strip must be
 * unfolded. */
uint32_t gd__strip_corners(const struct gd__strip *strip, struct gd__corner *out);

/* Appends the line through the corners to an empty route. Errors: GD_NO_MEMORY, GD_BUDGET.
 * O(count). */
GD_MUST_USE enum gd_status gd__strip_line(const struct gd_mesh *mesh, const struct gd__strip *strip,
                                          const struct gd__corner *corners, uint32_t corner_count,
                                          struct gd__route *out, const struct gd_control *control);
