/* Segment: a straight piece of a curve, between two different points of one face. */
#ifndef GD_MESH_SEGMENT_H
#define GD_MESH_SEGMENT_H

#include "mesh/local.h"

/* Does the point lie in the face or on its border? */
bool gd__face_contains(const struct gd_mesh *mesh, uint32_t face, const struct gd_point *point);

/* A face that both points lie in or on, where the shortest path between them is straight; GD_NONE:
 * there is none. Walks the fan of a vertex only when both are vertices. */
uint32_t gd__common_face(const struct gd_mesh *mesh, const struct gd_point *p,
                         const struct gd_point *q);

/* The only edge that two points might have in common; GD_NONE: none. Walks the fan of a vertex when
 * both are vertices. */
uint32_t gd__edge_between(const struct gd_mesh *mesh, const struct gd_point *a,
                          const struct gd_point *b);

/* Where a segment lies: along an edge, or across a face. */
struct gd__home {
    uint32_t edge; /* GD_NONE: not along an edge */
    uint32_t face; /* GD_NONE: along an edge */
};

/* A face that two different edges have in common, without looking at faces; GD_NONE: there is none.
 * Without branches: either face is as likely. */
static inline uint32_t gd__face_of_edges(const struct gd_mesh *mesh, uint32_t p, uint32_t q)
{
    const uint32_t *of_p = &mesh->side_face[2 * p], *of_q = &mesh->side_face[2 * q];
    bool first = (of_p[0] != GD_NONE) & ((of_p[0] == of_q[0]) | (of_p[0] == of_q[1])),
         second = (of_p[1] == of_q[0]) | (of_p[1] == of_q[1]);
    uint32_t otherwise = second ? of_p[1] : GD_NONE;
    return first ? of_p[0] : otherwise;
}

/* gd__segment_home of one that does not join two edges. */
bool gd__segment_home_elsewhere(const struct gd_mesh *mesh, const struct gd_point *a,
                                const struct gd_point *b, struct gd__home *out);

/* The home of the segment from a to b; false, and `out` untouched, where they are one point or no
 * face contains both. O(1), O(fan) between vertices. Most segments of a curve join two edges. */
static inline bool gd__segment_home(const struct gd_mesh *mesh, const struct gd_point *a,
                                    const struct gd_point *b, struct gd__home *out)
{
    bool join_edges =
        a->kind == GD_POINT_EDGE && b->kind == GD_POINT_EDGE && a->element != b->element;
    if (!join_edges) return gd__segment_home_elsewhere(mesh, a, b, out);
    uint32_t face = gd__face_of_edges(mesh, a->element, b->element);
    if (face != GD_NONE) *out = (struct gd__home){.edge = GD_NONE, .face = face};
    return face != GD_NONE;
}

/* A point of an edge's segment, or of an edge: its place on the edge, from the origin of the edge's
 * side 0. */
double gd__edge_parameter(const struct gd_mesh *mesh, uint32_t edge, const struct gd_point *point);

/* A segment across a face, laid into the frame of side k of it. */
struct gd__chord {
    struct gd__local from, to, along; /* along: of unit length */
    double length;
};
struct gd__chord gd__chord(const struct gd_mesh *mesh, uint32_t face, int k,
                           const struct gd_point *a, const struct gd_point *b);

/* The same in the frames of all three sides. */
void gd__chords(const struct gd_mesh *mesh, uint32_t face, const struct gd_point *a,
                const struct gd_point *b, struct gd__chord out[3]);

/* How far along the chord the foot of a place's perpendicular lies. */
static inline double gd__chord_foot(const struct gd__chord *chord, struct gd__local at)
{
    return (at.x - chord->from.x) * chord->along.x + (at.y - chord->from.y) * chord->along.y;
}

/* How far a place lies to the left of the chord's line. */
static inline double gd__chord_height(const struct gd__chord *chord, struct gd__local at)
{
    return chord->along.x * (at.y - chord->from.y) - chord->along.y * (at.x - chord->from.x);
}

#endif
