/* Window: a wedge in flight, on one side of an edge (Definition 1 of the paper; "wedge" is kept for
 * the final stage).
 *
 * In the frame of its side (mesh/topology.h) the window sees its pseudo-source at (x, -y), y > 0,
 * straight through [b0, b1]; the distance at parameter t of the edge is sigma + |(t, 0) - (x, -y)|.
 * It propagates into the side's face.
 *
 * A linear window is of a segment source (Bommes and Kobbelt 2007): it sees a line at right angles,
 * that is a source infinitely far away in the direction (x, -y), a unit vector, y > 0. The distance
 * at (t, h) of the frame is sigma - x t + y h: its sigma is the distance at the frame's origin,
 * which may lie outside the window, so that it may be negative, and changes from frame to frame. In
 * homogeneous coordinates both are one: the source (x, -y, 1) or (x, -y, 0). */
#ifndef GD_WINDOW_WINDOW_H
#define GD_WINDOW_WINDOW_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/tolerance.h"

/* Tags of a window that is handled by itself. FAR_SIDE: of side 1 of an edge, in the frame of side
 * 0. Bits from SERIAL upwards number windows that must not be joined. */
enum { GD__WINDOW_FAR_SIDE = 1, GD__WINDOW_SERIAL = 4 };

/* Set in a source's number: the window is linear. The rest is vertex_count + number of the seed. */
#define GD__SOURCE_LINEAR (UINT32_C(1) << 31)

struct gd__window {
    double b0, b1;
    double x, y;
    /* distance of the pseudo-source; of a linear window that at the frame's origin */
    double sigma;
    uint32_t source; /* pseudo-source: a vertex, or vertex_count + number of the seed */
    uint32_t tags;
};

/* Of a source that is one: not of a gap's (GD_NONE). */
static inline bool gd__source_is_linear(uint32_t source)
{
    return (source & GD__SOURCE_LINEAR) != 0;
}

static inline bool gd__window_is_linear(const struct gd__window *w)
{
    return gd__source_is_linear(w->source);
}

/* Distance at (t, h) of the frame, straight through the edge's line, h >= 0. */
static inline double gd__window_distance_beyond(const struct gd__window *w, double t, double h)
{
    if (gd__window_is_linear(w)) return w->sigma - w->x * t + w->y * h;
    double dx = t - w->x, dy = h + w->y;
    return w->sigma + sqrt(dx * dx + dy * dy);
}

/* Distance at parameter t of the edge, of a window that is not linear; */
static inline double gd__window_distance_of_point(const struct gd__window *w, double t)
{
    double d = t - w->x;
    return w->sigma + sqrt(d * d + w->y * w->y);
}

/* of any; */
static inline double gd__window_distance(const struct gd__window *w, double t)
{
    return gd__window_is_linear(w) ? w->sigma - w->x * t : gd__window_distance_of_point(w, t);
}

/* in the middle of its interval. */
static inline double gd__window_distance_in_middle(const struct gd__window *w)
{
    return gd__window_distance(w, 0.5 * (w->b0 + w->b1));
}

/* Shortest distance that the window gives anywhere on its interval. */
static inline double gd__window_nearest(const struct gd__window *w)
{
    if (gd__window_is_linear(w)) return gd__window_distance(w, w->x > 0 ? w->b1 : w->b0);
    double t = w->x < w->b0 ? w->b0 : w->x > w->b1 ? w->b1 : w->x;
    return gd__window_distance(w, t);
}

/* The source sees an edge of that length end on: on its line, beyond its ends. No window is made;
 * the candidate through the end point covers what it would see. A source beside the edge itself
 * sees it at all angles, however small y is. */
static inline bool gd__window_grazes(double x, double y, double length)
{
    if (y > GD_TOL_GRAZING * length) return false;
    return y < 0 || x < -GD_TOL_BESIDE * length || x > (1 + GD_TOL_BESIDE) * length ||
           (y == 0 && (x <= 0 || x >= length));
}

/* One source seen through two windows: they differ in their intervals only. */
static inline bool gd__window_same_source(const struct gd__window *a, const struct gd__window *b)
{
    if (a->source != b->source || a->tags != b->tags) return false;
    double apart = fabs(a->sigma - b->sigma), tolerance = GD_TOL_SAME_SOURCE * (a->y + fabs(a->x));
    if (apart > (gd__window_is_linear(a) ? GD_TOL_SAME_SOURCE * (fabs(a->sigma) + fabs(a->b1)) : 0))
        return false;
    return fabs(a->x - b->x) <= tolerance && fabs(a->y - b->y) <= tolerance;
}

/* A window that goes on where the last one of its list ends, from the same source: both are one. */
static inline bool gd__window_joins(const struct gd__window *last, const struct gd__window *w,
                                    double min_width)
{
    return last->b1 >= w->b0 - GD_TOL_ADJACENT * (w->b1 - w->b0) - min_width && last->b0 <= w->b0 &&
           gd__window_same_source(last, w);
}

/* The same window seen from the other side of an edge of that length: used to compare, never to
 * propagate. */
static inline struct gd__window gd__window_mirrored(const struct gd__window *w, double length)
{
    struct gd__window m = *w;
    m.b0 = length - w->b1;
    m.b1 = length - w->b0;
    m.x = gd__window_is_linear(w) ? -w->x : length - w->x;
    if (gd__window_is_linear(w)) m.sigma = w->sigma - w->x * length;
    return m;
}

#endif
