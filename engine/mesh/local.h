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

/* gd__point_weights of a vertex or a point inside a face. */
void gd__point_weights_off_edges(const struct gd_mesh *mesh, const struct gd_point *point, uint32_t face,
                                 double weight[3]);

/* Barycentric coordinates (by corner, corner 0 = origin of face_side[0]) of a point in one of the faces that contain it; all 0 in any other. Which side an
 * edge is, and which way round, can't be foretold, so that of a point of an edge nothing is branched on. */
static inline void gd__point_weights(const struct gd_mesh *mesh, const struct gd_point *point, uint32_t face,
                                     double weight[3])
{
    if (point->kind != GD_POINT_EDGE) {
        gd__point_weights_off_edges(mesh, point, face, weight);
        return;
    }
    const uint32_t *side = mesh->face_side[face];
    bool on[3] = {side[0] >> 1 == point->element, side[1] >> 1 == point->element, side[2] >> 1 == point->element};
    double is[3] = {on[0], on[1], on[2]}, t = point->weight[0];
    double turned = ((side[0] & on[0]) | (side[1] & on[1]) | (side[2] & on[2])); /* the edge's side 1 is the face's */
    double forth = t - 2 * turned * t, of_destination = turned + forth, of_origin = (1 - turned) - forth;
    for (int k = 0; k < 3; k++) weight[k] = is[k] * of_origin + is[(k + 2) % 3] * of_destination;
}

#endif
