/* Branch: the points of a face's plane that two sources are equally near to: between points a
 * branch of a hyperbola or a line, between a point and a segment's line a parabola, between two
 * such lines a line.
 *
 * DESIGN. It is kept in polar form about a centre: 1/r = w u + q for the unit vector u of an angle,
 * where that is more than 0.
 * - About a point s, the other point at s + a and farther by k: 1/r = 2 (a u - k) / (a a - k^2).
 * - About a point s, of which a line with the gradient g is farther away by k: r = k + r g u, that
 *   is 1/r = (1 - g u) / k.
 * - A line has that form about any place beside it: of two linear sources the centre is no source,
 *   but chosen.
 * So 1/r is linear in u, and whatever is asked of a place c + r u of the branch (on which side of a
 * line it lies, whether a third source is nearer) is linear too once it is divided by r: m u >= h,
 * a span of angles. Only whether a point is nearer than two linear sources is quadratic, along
 * their line. */
#ifndef GD_FIELD_VORONOI_BRANCH_H
#define GD_FIELD_VORONOI_BRANCH_H

#include "field/sources.h"
#include "field/spans.h"

/* A source without its sector. */
struct gd__focus {
    struct gd__local at; /* of a point */
    double sigma;        /* of a linear one: the distance at the frame's origin */
    bool linear;
    struct gd__local gradient; /* of a linear one, a unit vector */
};

static inline struct gd__focus gd__focus_of(const struct gd__source *source)
{
    return (struct gd__focus){source->at, source->sigma, source->linear, source->gradient};
}

static inline double gd__focus_distance(const struct gd__focus *focus, struct gd__local at)
{
    double dx = at.x - focus->at.x, dy = at.y - focus->at.y;
    if (focus->linear) return focus->sigma + (focus->gradient.x * at.x + focus->gradient.y * at.y);
    return focus->sigma + sqrt(dx * dx + dy * dy);
}

struct gd__branch {
    struct gd__focus source; /* one of the two */
    struct gd__local centre; /* the source, if it is a point */
    struct gd__local slope;  /* w: of 1/r */
    double rest;             /* q */
    /* the direction that angles are counted from: to the face's middle, or to the line */
    double zero;
    struct gd__local towards; /* unit vector in it */
};

/* The branch between two sources as seen from the first, which is a point if one of them is. False:
 * there is none, as one of them is nearer everywhere. `size`: of the face about `middle`, the
 * distance that a line is seen from. */
bool gd__branch_between(const struct gd__focus *source, const struct gd__focus *other,
                        struct gd__local middle, double size, struct gd__branch *out);

/* How far the directrix lies from the centre. A branch for which that is next to nothing bends back
 * round a ray: of the two sources one hides behind the other, or is the end of the other's
 * segment. */
double gd__branch_width(const struct gd__branch *branch);

struct gd__local gd__branch_place(const struct gd__branch *branch, double angle);

/* Parts of the turn: where the branch is at all; where it is beyond a line through a place, on the
 * side of the normal; where a third source is nearer, by more than `slack` (less than nothing: or
 * farther by no more than that). */
struct gd__turn gd__branch_turn(const struct gd__branch *branch);
struct gd__turn gd__branch_beyond(const struct gd__branch *branch, struct gd__local normal,
                                  struct gd__local through);
struct gd__turn gd__branch_lost_to(const struct gd__branch *branch, const struct gd__focus *third,
                                   double slack);

/* The place next to `at` that two sources, or three, are equally near to; `at` itself if there is
 * none within `reach`. Where bisectors of three sources meet at next to no angle, as those do of a
 * line and of its end, that of the first two alone. */
struct gd__local gd__between_two(const struct gd__focus focus[2], struct gd__local at,
                                 double reach);
struct gd__local gd__between_three(const struct gd__focus focus[3], struct gd__local at,
                                   double reach);

#endif
