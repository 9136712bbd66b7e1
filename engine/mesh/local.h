/* Local: places in the plane of a face, in the frame of one of its sides (topology.h). Inside
 * unit. */
#ifndef GD_MESH_LOCAL_H
#define GD_MESH_LOCAL_H

#include <math.h>

#include "mesh/topology.h"

struct gd__local {
    double x, y;
};

/* From barycentric coordinates: those of the side's destination and of its apex; the origin has the
 * rest. */
static inline struct gd__local gd__side_local(const struct gd_side *s, double destination,
                                              double apex)
{
    return (struct gd__local){destination * s->length + apex * s->left_length * s->left_x,
                              apex * s->left_length * s->left_y};
}

/* From barycentric coordinates by corner, the side's origin first. */
static inline struct gd__local gd__face_local(const struct gd_mesh *mesh, uint32_t side,
                                              const double weight[3])
{
    return gd__side_local(&mesh->side[side], weight[1], weight[2]);
}

/* Which of a face's three sides lies on an edge; 0 where none does. Without branches: it is as
 * likely any. */
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
void gd__point_weights_off_edges(const struct gd_mesh *mesh, const struct gd_point *point,
                                 uint32_t face, double weight[3]);

/* Barycentric coordinates (by corner, corner 0 = origin of face_side[0]) of a point in one of the
 * faces that contain it; all 0 in any other. Which side an edge is, and which way round, can't be
 * foretold, so that of a point of an edge nothing is branched on. */
static inline void gd__point_weights(const struct gd_mesh *mesh, const struct gd_point *point,
                                     uint32_t face, double weight[3])
{
    if (point->kind != GD_POINT_EDGE) {
        gd__point_weights_off_edges(mesh, point, face, weight);
        return;
    }
    const uint32_t *side = mesh->face_side[face];
    bool on[3] = {side[0] >> 1 == point->element, side[1] >> 1 == point->element,
                  side[2] >> 1 == point->element};
    double is[3] = {on[0], on[1], on[2]};
    /* the edge's side 1 is the face's */
    bool turned = ((side[0] & on[0]) | (side[1] & on[1]) | (side[2] & on[2]));
    const double of_end[2] = {gd__edge_rest(point), point->weight[0]};
    double of_origin = of_end[turned], of_destination = of_end[!turned];
    for (int k = 0; k < 3; k++) weight[k] = is[k] * of_origin + is[(k + 2) % 3] * of_destination;
}

/* The corner of which a point has most, by its weights. */
static inline int gd__main_corner(const double weight[3])
{
    int k = weight[1] > weight[0];
    return weight[2] > weight[k] ? 2 : k;
}

/* The way from a point of a face to another, by their weights, in the frame of the side that begins
 * at corner k. The corner's own weights are not read: of two points near the corner the way has all
 * its digits, however short it is. */
static inline struct gd__local gd__way_in_face(const struct gd_mesh *mesh, uint32_t face, int k,
                                               const double from[3], const double to[3])
{
    int l = (k + 1) % 3, m = (k + 2) % 3;
    return gd__side_local(&mesh->side[mesh->face_side[face][k]], to[l] - from[l], to[m] - from[m]);
}

static inline double gd__local_length(struct gd__local way)
{
    return sqrt(way.x * way.x + way.y * way.y);
}

#endif
