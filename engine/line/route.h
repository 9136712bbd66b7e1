/* Route: a polyline on the surface while it is worked on: points that follow each other within one
 * face. Inside unit. */
#ifndef GD_LINE_ROUTE_H
#define GD_LINE_ROUTE_H

#include "gd/control.h"
#include "gd/path.h"
#include "mesh/topology.h"

/* All zero is an empty route. */
struct gd__route {
    struct gd_point *points; /* owned; no two consecutive ones are equal */
    uint32_t count, capacity;
    double length;
};

void gd__route_free(struct gd__route *route); /* leaves an empty route */

/* Makes it empty, and keeps its memory. */
static inline void gd__route_clear(struct gd__route *route)
{
    route->count = 0;
    route->length = 0;
}

/* One more point, `run` behind the last one; left out when it is that one. GD_NO_MEMORY,
 * GD_BUDGET. */
GD_MUST_USE enum gd_status gd__route_add(struct gd__route *route, const struct gd_point *point,
                                         double run, const struct gd_control *control);

/* More points, in their order or backwards, that lie `length` along. */
GD_MUST_USE enum gd_status gd__route_join(struct gd__route *route, const struct gd_point *points,
                                          uint32_t count, double length, bool backwards,
                                          const struct gd_control *control);

/* An order of points that has nothing to do with where they are: does a come after b? Lines between
 * two points are made in one order of them, so that a line and its reverse are the same. */
bool gd__point_follows(const struct gd_point *a, const struct gd_point *b);

void gd__points_reverse(struct gd_point *points, uint32_t count);

/* The length of the segment between two points that follow each other. */
double gd__route_run(const struct gd_mesh *mesh, const struct gd_point *a,
                     const struct gd_point *b);

/* The point of that segment that is `part` of the way along. */
struct gd_point gd__route_between(const struct gd_mesh *mesh, const struct gd_point *a,
                                  const struct gd_point *b, double part);

/* The point `part` of the way along, in [0, 1], put between the others: its number. Of a point
 * alone it is that point. GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__route_split(const struct gd_mesh *mesh, struct gd__route *route,
                                           double part, const struct gd_control *control,
                                           uint32_t *out);

/* Where the straight part of a geodesic that begins at point i < count - 1 ends: at its next
 * vertex, or its last point. */
static inline uint32_t gd__route_bend(const struct gd_point *points, uint32_t count, uint32_t i)
{
    do i++;
    while (i + 1 < count && points[i].kind == GD_POINT_EDGE);
    return i;
}

/* The turn (turn.h) in which a geodesic of at least two points leaves its first one; at the last
 * one, the turn to where it came from. It is laid flat up to its next vertex, so that the turn is
 * as exact as that is far. GD_INTERNAL: two points have no face in common. */
GD_MUST_USE enum gd_status gd__route_ahead(const struct gd_mesh *mesh,
                                           const struct gd_point *points, uint32_t count,
                                           double *out);
GD_MUST_USE enum gd_status gd__route_back(const struct gd_mesh *mesh, const struct gd_point *points,
                                          uint32_t count, double *out);

/* Gives the points away as a path in the caller's unit; leaves an empty route. */
struct gd_path gd__route_take(const struct gd_mesh *mesh, struct gd__route *route);

#endif
