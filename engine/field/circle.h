/* Circle: the points of a face at a level's distance from one source, and which of them no other source is nearer to. */
#ifndef GD_FIELD_CIRCLE_H
#define GD_FIELD_CIRCLE_H

#include "field/sources.h"
#include "field/spans.h"

struct gd__circle {
    struct gd__local centre;
    double radius;
    double
        zero; /* the direction towards the face's middle: angles are counted from it, so that those that matter are small */
    struct gd__local towards; /* unit vector in that direction */
};

/* The circle of source `i` at a level above its sigma. */
struct gd__circle gd__circle_of(const struct gd__sources *sources, uint32_t i, double level);

struct gd__local gd__circle_place(const struct gd__circle *circle, double angle);

/* Angle at which a place is seen from the centre, in [-pi, pi]. */
double gd__circle_angle(const struct gd__circle *circle, struct gd__local at);

/* The spans of source i's circle in the face on which the distance is the level: which the source sees and where no other is nearer. Sorted and
 * disjoint; the last may reach beyond pi. `covered` is scratch. GD_NO_MEMORY. O(k log k) of k sources. */
GD_MUST_USE enum gd_status gd__circle_arcs(const struct gd__sources *sources, uint32_t i, double level,
                                           struct gd__spans *covered, struct gd__spans *arcs);

#endif
