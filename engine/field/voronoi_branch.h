/* Branch: the points of a face's plane that are equally far from two sources. Between two points it
 * is a line or a branch of a hyperbola. Between a point and a segment's line it is a parabola.
 * Between two segments' lines it is a line.
 *
 * DESIGN. A branch has the polar form 1/r = w u + q about a centre. Here u is the unit vector of an
 * angle, and w u is a dot product. The branch exists where the right side is positive.
 * - About a point s, against a point at s + a that is farther by k:
 *   1/r = 2 (a u - k) / (a a - k^2).
 * - About a point s, against a line with gradient g that is farther by k: r = k + r g u, that is
 *   1/r = (1 - g u) / k.
 * - A line has this form about any position that is not on the line. For two linear sources the
 *   centre is a chosen position, not a source.
 *
 * So 1/r is linear in u. There are two tests of a position c + r u of the branch: on which side of
 * a line it lies, and whether a third source is nearer. Divided by r, each test is linear in u too:
 * m u >= h. The solution of a test is a span of angles. Only the test of a third point against two
 * linear sources is quadratic along their line. */
#pragma once

#include "field/sources.h"

/* A source without its sector. */
struct gd__focus {
    struct gd__local at; /* position of a point source */
    /* distance of the source; for a linear source, the distance at the frame's origin */
    double sigma;
    bool linear;
    struct gd__local gradient; /* for a linear source, a unit vector */
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
    struct gd__focus source; /* one of the two sources */
    struct gd__local centre; /* the source, if it is a point */
    struct gd__local slope;  /* w */
    double rest;             /* q */
    /* the direction from which angles are counted: towards the face's middle, or towards the
       line */
    double zero;
    struct gd__local towards; /* unit vector in the direction `zero` */
};

/* Computes the branch between two sources, in polar form about the first, which must be a point
 * unless both are linear. Returns false if one source is nearer everywhere. `size` is the face's
 * size around `middle`; the centre of a line lies at that distance. */
bool gd__branch_between(const struct gd__focus *source, const struct gd__focus *other,
                        struct gd__local middle, double size, struct gd__branch *out);

/* Returns the distance of the directrix from the centre. If the distance is nearly zero, the branch
 * folds back along a ray. This happens if one source is hidden behind the other, or is the end of
 * the other's segment. */
double gd__branch_width(const struct gd__branch *branch);

struct gd__local gd__branch_place(const struct gd__branch *branch, double angle);

/* Return spans of angles. gd__branch_turn returns the angles where the branch exists.
 * gd__branch_beyond returns the angles where the branch lies on one side of the line through
 * `through`: the side to which `normal` points. gd__branch_lost_to returns the angles where a third
 * source is nearer by more than `slack`. If `slack` is negative, the third source may also be
 * farther, by less than -slack. */
struct gd__turn gd__branch_turn(const struct gd__branch *branch);
struct gd__turn gd__branch_beyond(const struct gd__branch *branch, struct gd__local normal,
                                  struct gd__local through);
struct gd__turn gd__branch_lost_to(const struct gd__branch *branch, const struct gd__focus *third,
                                   double slack);

/* Return the position nearest to `at` that is equally far from two or three sources. Return `at`
 * itself if no such position is within `reach`. If the bisectors of three sources meet at a tiny
 * angle (for instance those of a segment's line and its end), only the first two sources are
 * used. */
struct gd__local gd__between_two(const struct gd__focus focus[2], struct gd__local at,
                                 double reach);
struct gd__local gd__between_three(const struct gd__focus focus[3], struct gd__local at,
                                   double reach);
