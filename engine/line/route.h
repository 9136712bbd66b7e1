/* Route: a polyline on the surface under construction. Consecutive points lie in one face.
 * Normalised unit. */
#pragma once

#include "gd/control.h"
#include "gd/path.h"
#include "mesh/topology.h"

/* A struct that is all zero is an empty route. */
struct gd__route {
    struct gd_point *points; /* owned; no two consecutive points are equal */
    uint32_t count, capacity;
    double length;
};

void gd__route_free(struct gd__route *route); /* frees the points; the route is empty afterwards */

/* Empties the route and keeps its memory. */
static inline void gd__route_clear(struct gd__route *route)
{
    route->count = 0;
    route->length = 0;
}

/* Appends a point at distance `run` from the last point, unless the two are equal. Errors:
 * GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__route_add(struct gd__route *route, const struct gd_point *point,
                                         double run, const struct gd_control *control);

/* Appends points, in their order or reversed. `length` is their total length. */
GD_MUST_USE enum gd_status gd__route_join(struct gd__route *route, const struct gd_point *points,
                                          uint32_t count, double length, bool backwards,
                                          const struct gd_control *control);

/* Returns true if `a` comes after `b` in a fixed order of all points. A line between two points is
 * always computed from the point that comes first in this order. So the line from a to b has the
 * same points as the line from b to a. */
bool gd__point_follows(const struct gd_point *a, const struct gd_point *b);

void gd__points_reverse(struct gd_point *points, uint32_t count);

/* Returns the length of the segment between two consecutive points. */
double gd__route_run(const struct gd_mesh *mesh, const struct gd_point *a,
                     const struct gd_point *b);

/* Returns the point at the fraction `part` of the segment from a to b. */
struct gd_point gd__route_between(const struct gd_mesh *mesh, const struct gd_point *a,
                                  const struct gd_point *b, double part);

/* Inserts a point at the fraction `part`, in [0, 1], of the route's length, and sets *out to its
 * index. In a route of one point, *out is the index of this point. Errors: GD_NO_MEMORY,
 * GD_BUDGET. */
GD_MUST_USE enum gd_status gd__route_split(const struct gd_mesh *mesh, struct gd__route *route,
                                           double part, const struct gd_control *control,
                                           uint32_t *out);

/* Returns the index of the end of the straight piece of a geodesic that begins at point i < count -
 * 1. This end is the next vertex on the geodesic, or the last point if there is none. */
static inline uint32_t gd__route_bend(const struct gd_point *points, uint32_t count, uint32_t i)
{
    do i++;
    while (i + 1 < count && points[i].kind == GD_POINT_EDGE);
    return i;
}

/* Compute the directions at the ends of a geodesic, as turns (turn.h). The geodesic has at least
 * two points. gd__route_ahead computes the turn in which the geodesic leaves its first point.
 * gd__route_back computes the turn at its last point that leads back along the geodesic. For
 * precision, both functions unfold the geodesic from this end to the nearest vertex on it. Error:
 * GD_INTERNAL (two points have no common face). */
GD_MUST_USE enum gd_status gd__route_ahead(const struct gd_mesh *mesh,
                                           const struct gd_point *points, uint32_t count,
                                           double *out);
GD_MUST_USE enum gd_status gd__route_back(const struct gd_mesh *mesh, const struct gd_point *points,
                                          uint32_t count, double *out);

/* Moves the points into a path in the caller's unit and empties the route. */
struct gd_path gd__route_take(const struct gd_mesh *mesh, struct gd__route *route);
