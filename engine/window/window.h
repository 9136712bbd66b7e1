/* Window: an interval of an edge, and a source on one side of the edge from which straight paths
 * lead to the interval (Definition 1 of the paper). Windows exist during propagation. A wedge is
 * the final form of a window. In the frame of its side (mesh/topology.h) the window has its
 * pseudo-source at (x, -y), y > 0. Straight lines from the source through [b0, b1] are shortest
 * paths. The distance at parameter t of the edge is sigma + |(t, 0) - (x, -y)|. The window
 * propagates into the side's face.
 *
 * A linear window belongs to a segment source (Bommes and Kobbelt 2007). Its rays are parallel, as
 * if the source were infinitely far away in the direction (x, -y), which is a unit vector with y >
 * 0. The distance at (t, h) of the frame is sigma - x t + y h. So sigma is the distance at the
 * frame's origin, and each frame has its own sigma. Sigma may be negative, because the origin may
 * lie outside the window. In homogeneous coordinates the source of a window is (x, -y, 1), and the
 * source of a linear window is (x, -y, 0). */
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/tolerance.h"

/* Tags of a window that is not in a list. FAR_SIDE: the window belongs to side 1 of an edge, but is
 * in the frame of side 0. The bits from SERIAL upwards prevent joining: windows in which these bits
 * differ are not joined. */
enum { GD__WINDOW_FAR_SIDE = 1, GD__WINDOW_SERIAL = 4 };

/* This bit of a source's number is set if the source is linear. The other bits are then
 * vertex_count + number of the seed. */
#define GD__SOURCE_LINEAR (UINT32_C(1) << 31)

struct gd__window {
    double b0, b1;
    double x, y;
    /* distance of the pseudo-source; of a linear window, the distance at the frame's origin */
    double sigma;
    uint32_t source; /* the pseudo-source: a vertex, or vertex_count + number of the seed */
    uint32_t tags;
};

/* Returns true if the source is linear. It is also true for GD_NONE (a gap), so callers must test
 * for GD_NONE first. */
static inline bool gd__source_is_linear(uint32_t source)
{
    return (source & GD__SOURCE_LINEAR) != 0;
}

static inline bool gd__window_is_linear(const struct gd__window *w)
{
    return gd__source_is_linear(w->source);
}

/* Returns the distance at (t, h) of the frame, h >= 0, along a straight path across the edge's
 * line. */
static inline double gd__window_distance_beyond(const struct gd__window *w, double t, double h)
{
    if (gd__window_is_linear(w)) return w->sigma - w->x * t + w->y * h;
    double dx = t - w->x, dy = h + w->y;
    return w->sigma + sqrt(dx * dx + dy * dy);
}

/* Returns the distance at parameter t of the edge, for a window that is not linear. */
static inline double gd__window_distance_of_point(const struct gd__window *w, double t)
{
    double d = t - w->x;
    return w->sigma + sqrt(d * d + w->y * w->y);
}

/* Returns the distance at parameter t of the edge, for any window. */
static inline double gd__window_distance(const struct gd__window *w, double t)
{
    return gd__window_is_linear(w) ? w->sigma - w->x * t : gd__window_distance_of_point(w, t);
}

/* Returns the distance in the middle of the window's interval. */
static inline double gd__window_distance_in_middle(const struct gd__window *w)
{
    return gd__window_distance(w, 0.5 * (w->b0 + w->b1));
}

/* Returns the parameter in the window's interval at which the distance is smallest. */
static inline double gd__window_nearest_at(const struct gd__window *w)
{
    if (gd__window_is_linear(w)) return w->x > 0 ? w->b1 : w->b0;
    return w->x < w->b0 ? w->b0 : w->x > w->b1 ? w->b1 : w->x;
}

/* Returns the smallest distance in the window's interval. */
static inline double gd__window_nearest(const struct gd__window *w)
{
    return gd__window_distance(w, gd__window_nearest_at(w));
}

/* Returns true if the source lies on the line of an edge of that length, up to rounding, but not on
 * the edge itself. Such a source casts no window, because the paths along the edge from its end
 * give the same distances. A source on the edge itself sees the edge at all angles, however small y
 * is. */
static inline bool gd__window_grazes(double x, double y, double length)
{
    if (y > GD_TOL_GRAZING * length) return false;
    return y < 0 || x < -GD_TOL_BESIDE * length || x > (1 + GD_TOL_BESIDE) * length ||
           (y == 0 && (x <= 0 || x >= length));
}

/* Returns true if two windows have the same unfolded source, so that they differ only in their
 * intervals. */
static inline bool gd__window_same_source(const struct gd__window *a, const struct gd__window *b)
{
    if (a->source != b->source || a->tags != b->tags) return false;
    double apart = fabs(a->sigma - b->sigma), tolerance = GD_TOL_SAME_SOURCE * (a->y + fabs(a->x));
    if (apart > (gd__window_is_linear(a) ? GD_TOL_SAME_SOURCE * (fabs(a->sigma) + fabs(a->b1)) : 0))
        return false;
    return fabs(a->x - b->x) <= tolerance && fabs(a->y - b->y) <= tolerance;
}

/* Returns true if the window starts where the last window of its list ends, and both have the same
 * source: they can be joined. */
static inline bool gd__window_joins(const struct gd__window *last, const struct gd__window *w,
                                    double min_width)
{
    return last->b1 >= w->b0 - GD_TOL_ADJACENT * (w->b1 - w->b0) - min_width && last->b0 <= w->b0 &&
           gd__window_same_source(last, w);
}

/* Returns the window in the frame of the edge's other side. `length` is the length of the edge. The
 * result is only used for comparisons and never propagated. */
static inline struct gd__window gd__window_mirrored(const struct gd__window *w, double length)
{
    struct gd__window m = *w;
    m.b0 = length - w->b1;
    m.b1 = length - w->b0;
    m.x = gd__window_is_linear(w) ? -w->x : length - w->x;
    if (gd__window_is_linear(w)) m.sigma = w->sigma - w->x * length;
    return m;
}
