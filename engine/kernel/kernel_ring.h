/* Part of kernel_lanes.h: bounds of paths through the points of a ring. Single precision is enough
 * for bounds. */

/* Consider the distance in space between a point of one part of an edge and a point of another
 * part. This distance may be smaller than the bilinear interpolation of the distances between the
 * ends of the parts. Returns a bound on the difference. Reason: along a part of length s, consider
 * the distance from a point that is at distance d from one of the part's ends. Its second
 * derivative along the part is at most 1 / (d (1 - (s/d)^2)), so the distance is below its linear
 * interpolation by at most this value times s^2 / 8. If the parts are at least as long as their
 * distance, half of the sum of their lengths is a bound. */
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
