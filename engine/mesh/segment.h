/* Segment: a straight line between two different points of one face. */
#pragma once

#include "mesh/local.h"

/* Returns true if the point lies on the edge or at one of its ends. */
bool gd__point_is_on_edge(const struct gd_mesh *mesh, const struct gd_point *point, uint32_t edge);

/* Returns true if the point lies in the face or on its border. */
bool gd__face_contains(const struct gd_mesh *mesh, uint32_t face, const struct gd_point *point);

/* Returns a face that contains both points, so that the straight segment in the face is their
 * shortest path. Returns GD_NONE if there is none. Walks the fan of a vertex only if both points
 * are vertices. */
uint32_t gd__common_face(const struct gd_mesh *mesh, const struct gd_point *p,
                         const struct gd_point *q);

/* Returns the only edge on which both points can lie, or GD_NONE if no edge can contain both. Walks
 * the fan of a vertex if both points are vertices. */
uint32_t gd__edge_between(const struct gd_mesh *mesh, const struct gd_point *a,
                          const struct gd_point *b);

/* Location of a segment: along an edge, or across a face. */
struct gd__segment_location {
    uint32_t edge; /* GD_NONE if not along an edge */
    uint32_t face; /* GD_NONE if along an edge */
};

/* Returns the common face of two different edges, from their sides alone, or GD_NONE if there is
 * none. Branchless, because the branch is unpredictable. */
static inline uint32_t gd__face_of_edges(const struct gd_mesh *mesh, uint32_t p, uint32_t q)
{
    const uint32_t *of_p = &mesh->side_face[2 * p], *of_q = &mesh->side_face[2 * q];
    bool first = (of_p[0] != GD_NONE) & ((of_p[0] == of_q[0]) | (of_p[0] == of_q[1])),
         second = (of_p[1] == of_q[0]) | (of_p[1] == of_q[1]);
    uint32_t otherwise = second ? of_p[1] : GD_NONE;
    return first ? of_p[0] : otherwise;
}

/* Like gd__segment_locate, for a segment that does not join two edges. */
bool gd__segment_locate_elsewhere(const struct gd_mesh *mesh, const struct gd_point *a,
                                  const struct gd_point *b, struct gd__segment_location *out);

/* Finds the edge or the face of the segment from a to b. Returns false and leaves `out` unchanged
 * if a and b are the same point or no face contains both. O(1); O(fan) between vertices. Only the
 * case of two points on different edges is inline, because most segments of a curve join two
 * different edges. */
static inline bool gd__segment_locate(const struct gd_mesh *mesh, const struct gd_point *a,
                                      const struct gd_point *b, struct gd__segment_location *out)
{
    bool join_edges =
        a->kind == GD_POINT_EDGE && b->kind == GD_POINT_EDGE && a->element != b->element;
    if (!join_edges) return gd__segment_locate_elsewhere(mesh, a, b, out);
    uint32_t face = gd__face_of_edges(mesh, a->element, b->element);
    if (face != GD_NONE) *out = (struct gd__segment_location){.edge = GD_NONE, .face = face};
    return face != GD_NONE;
}

/* Returns the parameter of a point on an edge (one of its ends or a point inside), from the origin
 * of the edge's side 0. */
double gd__edge_parameter(const struct gd_mesh *mesh, uint32_t edge, const struct gd_point *point);

/* A segment across a face, in the frame of the face's side k. */
struct gd__chord {
    struct gd__local from, to, along; /* `along` has length 1 */
    double length;
};
struct gd__chord gd__chord(const struct gd_mesh *mesh, uint32_t face, int k,
                           const struct gd_point *a, const struct gd_point *b);

/* Computes the chord in the frames of all three sides. */
void gd__chords(const struct gd_mesh *mesh, uint32_t face, const struct gd_point *a,
                const struct gd_point *b, struct gd__chord out[3]);

/* Projects a point onto the chord's line. Returns the length along the chord to this projection. */
static inline double gd__chord_foot(const struct gd__chord *chord, struct gd__local at)
{
    return (at.x - chord->from.x) * chord->along.x + (at.y - chord->from.y) * chord->along.y;
}

/* Returns the distance of a point to the left of the chord's line. */
static inline double gd__chord_height(const struct gd__chord *chord, struct gd__local at)
{
    return chord->along.x * (at.y - chord->from.y) - chord->along.y * (at.x - chord->from.x);
}
