/* Canonical points. A point that differs from a vertex or an edge only by rounding becomes a point
 * of that vertex or edge. */
#pragma once

#include "mesh/topology.h"

struct gd_point gd__point_of_vertex(uint32_t vertex);

/* Returns the point of an edge at the parameter `t` in [0,1], from the origin of the edge's side
 * 0. */
struct gd_point gd__point_of_edge(const struct gd_mesh *mesh, uint32_t edge, double t);

/* Returns the point at the fraction `t` of a side's length from its origin. `rest` is 1 - t. The
 * caller passes it because it cannot be computed precisely from a `t` close to 1. */
struct gd_point gd__point_on_side(const struct gd_mesh *mesh, uint32_t side, double t, double rest);

/* Like gd__point_on_side, for a `t` strictly between 0 and 1. */
static inline struct gd_point gd__point_within_side(uint32_t side, double t)
{
    bool turned = side & 1;
    return (struct gd_point){.kind = GD_POINT_EDGE,
                             .element = side >> 1,
                             .weight = {turned ? 1 - t : t, turned ? t : 1 - t}};
}

/* Returns the point of a face with the barycentric coordinates `weight`, one for each corner in
 * internal order (face_side). The weights are at least 0, and their sum is 1 up to rounding. */
struct gd_point gd__point_of_face(const struct gd_mesh *mesh, uint32_t face,
                                  const double weight[3]);

/* Moves a point of a face to an edge if one of its weights is at most `border`, and to a vertex if
 * one is at least 1 - 2 `border`. Moves a point of an edge to an end if its parameter is within
 * `border` of that end. */
struct gd_point gd__point_settled(const struct gd_mesh *mesh, const struct gd_point *point,
                                  double border);
