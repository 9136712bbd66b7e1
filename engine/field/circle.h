/* Circle: the points of a face's plane whose distance from one source is the level, and the arcs of
 * this circle where no other source is nearer.
 *
 * For a linear source (a segment) the circle is a straight line. An angle parametrises the line
 * too: the tangent of half the angle is the length along the line, divided by `radius`. The whole
 * line has the angles from -pi to pi, in the order of a counter-clockwise circle. */
#pragma once

#include "field/sources.h"

struct gd__circle {
    bool straight;           /* the circle is a line */
    struct gd__local centre; /* for a line, the point nearest to the face's middle */
    double radius;           /* for a line, the length whose angle is pi / 2: the face's size */
    /* Direction towards the face's middle, from which angles are counted, so that angles in the
       face are small. 0 for a line. */
    double zero;
    /* unit vector in the direction `zero`; for a line: perpendicular to the line, away from its
       source */
    struct gd__local towards;
};

/* Returns the unit tangent at the angle 0. */
static inline struct gd__local gd__circle_along(const struct gd__circle *circle)
{
    return (struct gd__local){-circle->towards.y, circle->towards.x};
}

/* Returns the circle around source `i` at `level`. */
struct gd__circle gd__circle_of(const struct gd__sources *sources, uint32_t i, double level);

struct gd__local gd__circle_place(const struct gd__circle *circle, double angle);

/* Returns the angle of a position seen from the centre, in [-pi, pi]; for a line, the angle of the
 * position's projection onto the line. */
double gd__circle_angle(const struct gd__circle *circle, struct gd__local at);

/* Sets sources->spans to the spans of source i's circle that lie in the face, that the source sees,
 * and on which no other source is nearer. The distance of their points is the level. The spans are
 * sorted and disjoint; the last may extend beyond pi. Error: GD_NO_MEMORY. O(k log k) for k
 * sources. */
GD_MUST_USE enum gd_status gd__circle_arcs(struct gd__sources *sources, uint32_t i, double level);
