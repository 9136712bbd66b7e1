/* Interval: finds the best triangulation of a small ring among all triangulations without forbidden
 * diagonals. */
#pragma once

#include "construction/ring.h"

#define GD_INTERVAL_MAX_CORNERS 64

/* The best triangulation of each interval of corners. An interval runs from corner i to corner j
 * along the ring. The table has the cost, and the corner that forms a triangle with corners i and
 * j. */
struct gd__interval_table {
    double cost[GD_INTERVAL_MAX_CORNERS][GD_INTERVAL_MAX_CORNERS];
    uint8_t apex[GD_INTERVAL_MAX_CORNERS][GD_INTERVAL_MAX_CORNERS];
};

/* Triangulates the ring of `count` corners, at most GD_INTERVAL_MAX_CORNERS, that starts at
 * corner[first], into count - 2 triangles. Prefers triangulations without flipped triangles, then
 * well-shaped triangles. Returns false if there is no triangulation. O(count^3). */
bool gd__interval_cut(struct gd__interval_table *table, const struct gd__ring_corner *corner,
                      uint32_t first, uint32_t count, const struct gd__edge_set *edges,
                      uint32_t (*triangle)[3]);
