/* Circle: the points of a face at a level's distance from one source, and which of them no other
 * source is nearer to.
 *
 * Of a linear source they form a line, a circle that never comes round: in place of an angle at its
 * centre it has one whose half has the way along the line for its tangent. So the whole line has
 * the angles from -pi to pi, too, in the order in which a circle has them, counter-clockwise. */
#ifndef GD_FIELD_CIRCLE_H
#define GD_FIELD_CIRCLE_H

#include "field/sources.h"
#include "field/spans.h"

struct gd__circle {
    bool straight;           /* a line */
    struct gd__local centre; /* of a line its place that is nearest to the face's middle */
    double radius;           /* of a line the way, the face's size, that has the angle pi / 2 */
    /* the direction towards the face's middle: angles are counted from it, so that those that
       matter are small; of a line 0 */
    double zero;
    /* unit vector in that direction; of a line away from its source, at right angles */
    struct gd__local towards;
};

/* Unit vector in which the circle passes the angle 0, and a line runs. */
static inline struct gd__local gd__circle_along(const struct gd__circle *circle)
{
    return (struct gd__local){-circle->towards.y, circle->towards.x};
}

/* The circle of source `i` at a level above its nearest distance. */
struct gd__circle gd__circle_of(const struct gd__sources *sources, uint32_t i, double level);

struct gd__local gd__circle_place(const struct gd__circle *circle, double angle);

/* Angle at which a place is seen from the centre, in [-pi, pi]; of a line that of the place's foot
 * on it. */
double gd__circle_angle(const struct gd__circle *circle, struct gd__local at);

/* The spans of source i's circle in the face on which the distance is the level: which the source
 * sees and where no other is nearer. Sorted and disjoint; the last may reach beyond pi. `covered`
 * is scratch. GD_NO_MEMORY. O(k log k) of k sources. */
GD_MUST_USE enum gd_status gd__circle_arcs(const struct gd__sources *sources, uint32_t i,
                                           double level, struct gd__spans *covered,
                                           struct gd__spans *arcs);

#endif
