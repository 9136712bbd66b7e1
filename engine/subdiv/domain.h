/* Domain: the square or triangle in which a face's own coordinates (s,t) lie. Side k runs from
 * corner k to the next corner. */
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

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

/* A cell of a grid over a face, and a place (x,y) in [0,1]^2 in the cell. */
struct gd__grid_cell {
    uint32_t i, j;
    double x, y;
};

/* Returns the cell that contains (s,t). The grid has `cells` cells along a side. */
static inline struct gd__grid_cell gd__grid_cell_of(uint32_t arity, uint32_t cells, double s,
                                                    double t)
{
    double u = fmax(s, 0) * cells, v = fmax(t, 0) * cells;
    uint32_t i = (uint32_t)fmin(u, cells - 1), last = arity == 3 ? cells - 1 - i : cells - 1,
             j = (uint32_t)fmin(v, last);
    /* rounding can move a place beyond the diagonal */
    double x = fmin(u - i, 1), most = arity == 3 && j == last ? 1 - x : 1;
    return (struct gd__grid_cell){i, j, x, fmin(v - j, most)};
}

/* Halves of a cell, named by their corners. The cell's corners are a (0,0), b (1,0), c (1,1), d
 * (0,1). */
enum gd__half { GD__HALF_ABC, GD__HALF_ACD, GD__HALF_ABD, GD__HALF_BCD };

static const uint8_t gd__cell_corners[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}},
                     gd__half_corners[4][3] = {[GD__HALF_ABC] = {0, 1, 2},
                                               [GD__HALF_ACD] = {0, 2, 3},
                                               [GD__HALF_ABD] = {0, 1, 3},
                                               [GD__HALF_BCD] = {1, 2, 3}};

/* Returns the half that contains the place, and computes the barycentric coordinates in that half.
 * The cell is divided from a to c, or else from b to d. */
static inline enum gd__half gd__grid_cell_split(const struct gd__grid_cell *cell, bool from_a,
                                                double weight[3])
{
    double x = cell->x, y = cell->y;
    const double weights[4][3] = {[GD__HALF_ABC] = {1 - x, x - y, y},
                                  [GD__HALF_ACD] = {1 - y, x, y - x},
                                  [GD__HALF_ABD] = {1 - x - y, x, y},
                                  [GD__HALF_BCD] = {1 - y, x + y - 1, 1 - x}};
    enum gd__half first = from_a ? GD__HALF_ABC : GD__HALF_ABD;
    enum gd__half half = first + !(from_a ? x >= y : x + y <= 1);
    memcpy(weight, weights[half], sizeof weights[half]);
    return half;
}
