/* Domain: the square or triangle in which a face's own coordinates (s,t) lie. Side k runs from
 * corner k to the next corner. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

/* Returns the distance of (s,t) from the line of side k, up to a factor; positive inside, negative
 * outside. */
static inline double gd__line_at(uint32_t arity, uint32_t k, double s, double t)
{
    if (arity == 3) return k == 0 ? t : k == 1 ? 1 - s - t : s;
    return k == 0 ? t : k == 1 ? 1 - s : k == 2 ? 1 - t : s;
}

/* Returns the derivative of gd__line_at along (ds,dt). On a large surface, ds and dt are much
 * smaller than the rounding error of gd__line_at. */
static inline double gd__line_slope(uint32_t arity, uint32_t k, double ds, double dt)
{
    if (arity == 3) return k == 0 ? dt : k == 1 ? -ds - dt : ds;
    return k == 0 ? dt : k == 1 ? -ds : k == 2 ? -dt : ds;
}

/* Computes (s,t) at the parameter m in [0,1] along side k. */
static inline void gd__place_on_side(uint32_t arity, uint32_t k, double m, double out[2])
{
    const double quad[4][2] = {{m, 0}, {1, m}, {1 - m, 1}, {0, 1 - m}};
    const double triangle[3][2] = {{m, 0}, {1 - m, m}, {0, 1 - m}};
    out[0] = arity == 4 ? quad[k][0] : triangle[k][0];
    out[1] = arity == 4 ? quad[k][1] : triangle[k][1];
}

/* Returns the parameter along side k of a place (s,t) on this side. */
static inline double gd__along_side(uint32_t arity, uint32_t k, double s, double t)
{
    if (arity == 3) return k == 0 ? s : k == 1 ? t : 1 - t;
    return k == 0 ? s : k == 1 ? t : k == 2 ? 1 - s : 1 - t;
}

/* Returns the corner nearest to (s,t). */
static inline uint32_t gd__nearest_corner(uint32_t arity, double s, double t)
{
    bool right = s > 0.5, up = t > 0.5;
    if (arity == 3) return right ? 1 : up ? 2 : 0;
    return up ? (right ? 2 : 3) : right ? 1 : 0;
}
