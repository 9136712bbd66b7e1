/* Local coordinates: points in the plane of a face, in the frame of one of its sides (topology.h).
 * Normalised unit. */
#pragma once

#include <math.h>

#include "mesh/topology.h"

struct gd__local {
    double x, y;
};

static inline struct gd__local gd__local_minus(struct gd__local a, struct gd__local b)
{
    return (struct gd__local){a.x - b.x, a.y - b.y};
}

static inline double gd__local_dot(struct gd__local a, struct gd__local b)
{
    return a.x * b.x + a.y * b.y;
}

static inline double gd__local_cross(struct gd__local a, struct gd__local b)
{
    return a.x * b.y - a.y * b.x;
}

/* Converts a point from its barycentric coordinates at the side's destination and apex. */
static inline struct gd__local gd__side_local(const struct gd_side *s, double destination,
                                              double apex)
{
    return (struct gd__local){destination * s->length + apex * s->left_length * s->left_x,
                              apex * s->left_length * s->left_y};
}

/* Converts a point from its barycentric coordinates at the three corners. The first corner is the
 * side's origin. */
static inline struct gd__local gd__face_local(const struct gd_mesh *mesh, uint32_t side,
                                              const double weight[3])
{
    return gd__side_local(&mesh->side[side], weight[1], weight[2]);
}

/* Returns the index of the face's side that lies on the edge, or 0 if none does. Branchless,
 * because the branch is unpredictable. */
static inline int gd__place_of_edge(const uint32_t side[3], uint32_t edge)
{
    return (side[1] >> 1 == edge) + 2 * (side[2] >> 1 == edge);
}

/* Returns the index of one of a face's sides. */
static inline int gd__place_of_side(const uint32_t sides[3], uint32_t side)
{
    return (sides[1] == side) + 2 * (sides[2] == side);
}

/* Like gd__point_weights, but only for a vertex or a point inside a face. */
void gd__point_weights_off_edges(const struct gd_mesh *mesh, const struct gd_point *point,
                                 uint32_t face, double weight[3]);

/* Computes the barycentric coordinates of a point in a face that contains it, one for each corner
 * (corner 0 is the origin of face_side[0]). All are 0 in a face that does not contain the point.
 * Branchless for a point of an edge, because the edge's side and orientation are unpredictable. */
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
    /* true if the face has the edge's side 1 */
    bool turned = ((side[0] & on[0]) | (side[1] & on[1]) | (side[2] & on[2]));
    const double of_end[2] = {gd__edge_rest(point), point->weight[0]};
    double of_origin = of_end[turned], of_destination = of_end[!turned];
    for (int k = 0; k < 3; k++) weight[k] = is[k] * of_origin + is[(k + 2) % 3] * of_destination;
}

/* Returns a point of a face in the frame of the face's side 0. */
static inline struct gd__local gd__point_local(const struct gd_mesh *mesh, uint32_t face,
                                               const struct gd_point *point)
{
    double weight[3];
    gd__point_weights(mesh, point, face, weight);
    return gd__face_local(mesh, mesh->face_side[face][0], weight);
}

/* Returns the corner with the largest weight. */
static inline int gd__main_corner(const double weight[3])
{
    int k = weight[1] > weight[0];
    return weight[2] > weight[k] ? 2 : k;
}

/* Returns the vector between two points of a face in the frame of the side that begins at corner k.
 * Computes it from the points' barycentric weights, except those of corner k. So the vector between
 * two points near this corner has full precision, however short it is. */
static inline struct gd__local gd__leg_key_in_face(const struct gd_mesh *mesh, uint32_t face, int k,
                                                   const double from[3], const double to[3])
{
    int l = (k + 1) % 3, m = (k + 2) % 3;
    return gd__side_local(&mesh->side[mesh->face_side[face][k]], to[l] - from[l], to[m] - from[m]);
}

static inline double gd__local_length(struct gd__local way)
{
    return sqrt(way.x * way.x + way.y * way.y);
}
