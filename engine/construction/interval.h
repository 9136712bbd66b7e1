/* Interval: the best triangulation of a small ring among all that its forbidden diagonals allow. */
#ifndef GD_CONSTRUCTION_INTERVAL_H
#define GD_CONSTRUCTION_INTERVAL_H

#include "construction/ring.h"

#define GD_INTERVAL_MAX_CORNERS 64

/* Of the corners from the i-th to the j-th around the ring: the least cost of triangulating them,
 * and the corner that makes a triangle with both. */
struct gd__interval_table {
    double cost[GD_INTERVAL_MAX_CORNERS][GD_INTERVAL_MAX_CORNERS];
    uint8_t apex[GD_INTERVAL_MAX_CORNERS][GD_INTERVAL_MAX_CORNERS];
};

/* Triangulates the ring of `count` corners, at most GD_INTERVAL_MAX_CORNERS, that starts at
 * corner[first], into (count - 2) triangles: none turned over in the plane if that can be, then as
 * well-shaped as can be. False: there is no triangulation. O(count^3). */
bool gd__interval_cut(struct gd__interval_table *table, const struct gd__ring_corner *corner,
                      uint32_t first, uint32_t count, const struct gd__edge_set *edges,
                      uint32_t (*triangle)[3]);

#endif
