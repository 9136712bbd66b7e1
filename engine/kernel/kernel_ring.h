/* Part of kernel_lanes.h: bounds of paths through the points of a ring. Single precision is enough
 * for bounds. */

/* Returns a bound on how far a distance in space between points of two parts of edges may lie below
 * the bilinear interpolation of the distances between their ends. For a part of length s and a
 * point at distance d from one of its ends, the second derivative is at most 1 / d (1 - (s/d)^2),
 * and the distance lies below its chord by at most s^2 / 8 times this derivative. If the parts are
 * as long as they are far apart, half of the sum of their lengths is a bound. */
static inline floats ring_sag(floats square, floats d, floats part, floats own)
{
    floats both = part + own, eighth = floats_all(0.125f),
           clear = floats_greater(square - both * both, both * d * eighth) +
                   floats_all((float)(GD_TOL_RING_NEAR * GD_TOL_RING_NEAR));
    return (part * part + own * own) * eighth * d / clear;
}

static float ring(const struct gd__ring_group *first, const struct gd__ring_group *end,
                  struct gd__place p, float own)
{
    const floats px = floats_all(p.x), py = floats_all(p.y), pz = floats_all(p.z),
                 o = floats_all(own);
    floats least = floats_all(GD__RING_NOWHERE);
    for (const struct gd__ring_group *g = first; g < end; g++)
        for (int i = 0; i < GD__RING_LANES; i += FLOATS) {
            floats x = floats_load(g->x + i) - px, y = floats_load(g->y + i) - py,
                   z = floats_load(g->z + i) - pz, square = x * x + y * y + z * z,
                   d = floats_greater(floats_root(square), floats_all((float)GD_TOL_RING_NEAR));
            least = floats_lesser(least, d + floats_load(g->lower + i) -
                                             ring_sag(square, d, floats_load(g->part + i), o));
        }
    return floats_least(least);
}
