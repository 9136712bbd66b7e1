/* Branch: the points of a face's plane that two sources are equally near to, a branch of a hyperbola or a line.
 *
 * DESIGN. Seen from the source s, the other one at s + a and farther by k, the branch is r(u) = (a a - k^2) / (2 (a u - k)) for unit vectors u with
 * a u > k. So 1/r is linear in u, and whatever is asked of a place s + r u of the branch (on which side of a line it lies, whether a third
 * source is nearer), is linear too once it is divided by r: w u >= q, a span of angles. */
#ifndef GD_FIELD_VORONOI_BRANCH_H
#define GD_FIELD_VORONOI_BRANCH_H

#include "field/sources.h"
#include "field/spans.h"

/* A source without its sector. */
struct gd__focus {
    struct gd__local at;
    double sigma;
};

static inline double gd__focus_distance(const struct gd__focus *focus, struct gd__local at)
{
    double dx = at.x - focus->at.x, dy = at.y - focus->at.y;
    return focus->sigma + sqrt(dx * dx + dy * dy);
}

struct gd__branch {
    struct gd__local focus, other; /* the source; and from it to the other one */
    double sigma, later;           /* of the source; how much farther the other one is */
    double scale;                  /* 2 / (a a - k^2) */
    double zero;                   /* the direction that angles are counted from: to the face's middle */
    struct gd__local towards;      /* unit vector in it */
};

/* The branch between two sources as seen from the first. False: there is none, as one of them is nearer everywhere. */
bool gd__branch_between(const struct gd__focus *source, const struct gd__focus *other, struct gd__local middle,
                        struct gd__branch *out);

struct gd__local gd__branch_place(const struct gd__branch *branch, double angle);

/* Parts of the turn: where the branch is at all; where it is beyond a line through a place, on the side of the unit normal; where a third source is
 * nearer, by more than `slack` (less than nothing: or farther by no more than that). */
struct gd__turn gd__branch_turn(const struct gd__branch *branch);
struct gd__turn gd__branch_beyond(const struct gd__branch *branch, struct gd__local normal, struct gd__local through);
struct gd__turn gd__branch_lost_to(const struct gd__branch *branch, const struct gd__focus *third, double slack);

/* The place next to `at` that two sources, or three, are equally near to; `at` itself if there is none within `reach`. */
struct gd__local gd__between_two(const struct gd__focus focus[2], struct gd__local at, double reach);
struct gd__local gd__between_three(const struct gd__focus focus[3], struct gd__local at, double reach);

#endif
