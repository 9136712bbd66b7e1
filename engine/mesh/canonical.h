/* Canonical points: what lies on a vertex or an edge up to rounding is made a point of that vertex
 * or edge. */
#ifndef GD_MESH_CANONICAL_H
#define GD_MESH_CANONICAL_H

#include "mesh/topology.h"

struct gd_point gd__point_of_vertex(uint32_t vertex);

/* `t` in [0,1] from the origin of the edge's side 0. */
struct gd_point gd__point_of_edge(const struct gd_mesh *mesh, uint32_t edge, double t);

/* `t` of a side's length from its origin; `rest` = 1 - t, with digits that t near 1 has not. */
struct gd_point gd__point_on_side(const struct gd_mesh *mesh, uint32_t side, double t, double rest);

/* The same where `t` is known to be neither end. */
static inline struct gd_point gd__point_within_side(uint32_t side, double t)
{
    bool turned = side & 1;
    return (struct gd_point){.kind = GD_POINT_EDGE,
                             .element = side >> 1,
                             .weight = {turned ? 1 - t : t, turned ? t : 1 - t}};
}

/* `weight` >= 0, of sum 1 up to rounding, by the corners of the face inside (face_side). */
struct gd_point gd__point_of_face(const struct gd_mesh *mesh, uint32_t face,
                                  const double weight[3]);

/* The point, or, where barycentric coordinates or an edge's parameter are within `border` of there,
 * the one beside it on an edge or a vertex. */
struct gd_point gd__point_settled(const struct gd_mesh *mesh, const struct gd_point *point,
                                  double border);

#endif
