/* Site: a position of the plane with integer coordinates, so that every orientation test is exact.
 * Determinants of 51-bit differences fit into 128 bits. */
#pragma once

#include <stdint.h>

struct gd__site {
    int64_t u, v;
};

/* Returns twice the signed area of a, b, c, exactly. */
static inline __int128 gd__site_area(struct gd__site a, struct gd__site b, struct gd__site c)
{
    return (__int128)(b.u - a.u) * (c.v - a.v) - (__int128)(b.v - a.v) * (c.u - a.u);
}

/* Returns the orientation of a, b, c: 1 for counter-clockwise, -1 for clockwise, 0 for
 * collinear. */
static inline int gd__site_turn(struct gd__site a, struct gd__site b, struct gd__site c)
{
    __int128 area = gd__site_area(a, b, c);
    return (area > 0) - (area < 0);
}

/* Returns true if segments a-b and c-d cross at a point that is not an end of either segment. */
static inline int gd__sites_cross(struct gd__site a, struct gd__site b, struct gd__site c,
                                  struct gd__site d)
{
    return gd__site_turn(a, b, c) * gd__site_turn(a, b, d) < 0 &&
           gd__site_turn(c, d, a) * gd__site_turn(c, d, b) < 0;
}
