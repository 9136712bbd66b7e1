/* Lattice: places of the parameter plane are rounded to integers, so that predicates are exact. */
#ifndef GD_LOOPS_LATTICE_H
#define GD_LOOPS_LATTICE_H

#include <math.h>
#include <stdint.h>

/* Largest coordinate of a point. The triangle around all points has coordinates up to 4 times as
 * large. So an in-circle determinant is less than 2^127. */
#define GD__LATTICE_EXTENT (INT64_C(1) << 26)

struct gd__lattice {
    double low[2], scale[2];
};

struct gd__lattice_node {
    int64_t x, y;
};

static inline struct gd__lattice_node gd__lattice_round(const struct gd__lattice *lattice,
                                                        const double at[2])
{
    return (struct gd__lattice_node){llround((at[0] - lattice->low[0]) * lattice->scale[0]),
                                     llround((at[1] - lattice->low[1]) * lattice->scale[1])};
}

/* Returns the sign of the area of a triangle: 1 if it is counter-clockwise, 0 if it is flat. */
static inline int gd__lattice_turn(struct gd__lattice_node a, struct gd__lattice_node b,
                                   struct gd__lattice_node c)
{
    __int128 area = (__int128)(b.x - a.x) * (c.y - a.y) - (__int128)(b.y - a.y) * (c.x - a.x);
    return (area > 0) - (area < 0);
}

#endif
