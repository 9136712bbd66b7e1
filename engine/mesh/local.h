/* Local: places in the plane of a face, in the frame of one of its sides (topology.h). Inside unit. */
#ifndef GD_MESH_LOCAL_H
#define GD_MESH_LOCAL_H

#include "mesh/topology.h"

struct gd__local {
    double x, y;
};

/* From barycentric coordinates: those of the side's destination and of its apex; the origin has the rest. */
static inline struct gd__local gd__side_local(const struct gd_side *s, double destination, double apex)
{
    return (struct gd__local){destination * s->length + apex * s->left_length * s->left_x,
                              apex * s->left_length * s->left_y};
}

/* From barycentric coordinates by corner, the side's origin first. */
static inline struct gd__local gd__face_local(const struct gd_mesh *mesh, uint32_t side, const double weight[3])
{
    return gd__side_local(&mesh->side[side], weight[1], weight[2]);
}

/* Which of a face's three sides lies on an edge; 0 where none does. Without branches: it is as likely any. */
static inline int gd__place_of_edge(const uint32_t side[3], uint32_t edge)
{
    return (side[1] >> 1 == edge) + 2 * (side[2] >> 1 == edge);
}

/* The place of one of a face's sides among them. */
static inline int gd__place_of_side(const uint32_t sides[3], uint32_t side)
{
    return (sides[1] == side) + 2 * (sides[2] == side);
}

/* Barycentric coordinates (by corner, corner 0 = origin of face_side[0]) of a point in one of the faces that contain it; all 0 in any other. */
void gd__point_weights(const struct gd_mesh *mesh, const struct gd_point *point, uint32_t face, double weight[3]);

#endif
