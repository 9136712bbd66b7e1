/* Topology: the internal mesh. The rooms mesh, repair and construction build it. All later rooms
 * read it.
 *
 * Elements have internal numbers. Vertices and faces are numbered in the Morton order of their
 * positions, so that neighbours share cache lines. Edges are numbered in the order in which the
 * faces first use them. Each edge exists once. 2e and 2e+1 are its two sides; h ^ 1 is the other
 * side of h.
 *
 * Frame of side h: origin vertex at (0,0), destination at (length,0), the side's face at y > 0. A
 * face runs counter-clockwise along its three sides. A side without a face is a boundary side; its
 * `left` and `right` are GD_NONE.
 *
 * Internal lengths are in the normalised unit: scaled by the exact power of two 1/unit, so that
 * squares neither overflow nor underflow. External length = unit x internal length. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/references.h"
#include "base/tolerance.h"
#include "gd/locate.h"
#include "gd/mesh.h"
#include "gd/point.h"

/* All data for a propagation across the side's face, in one cache line. p is the apex, the corner
 * opposite to the side. */
struct gd_side {
    double length; /* length of the edge */
    /* lengths of the edges from the origin to p, and from p to the destination */
    double left_length, right_length;
    double left_x, left_y;   /* unit vector from the origin to p, in the side's frame */
    double right_x, right_y; /* unit vector from p to the destination */
    /* The sides of the other two edges of this face, in the neighbouring faces. `left` runs from
     * the origin to p, `right` from p to the destination. Each is the opposite of a side of this
     * face. If this side is a boundary side, both are GD_NONE. */
    uint32_t left, right;
};

enum gd_vertex_kind {
    /* interior, total angle <= 2 pi: no shortest path passes through the vertex */
    GD_VERTEX_CONVEX = 0,
    GD_VERTEX_SADDLE = 1, /* interior, total angle > 2 pi */
    GD_VERTEX_BOUNDARY = 2
};

/* The faces around a vertex, one entry for each, counter-clockwise. The first entry begins at the
 * boundary side if there is one. */
struct gd_fan {
    /* angle at which the face begins, from the first entry's side; at a boundary vertex that side
     * is a boundary edge */
    double angle;
    uint32_t side; /* the side of this face that begins at the vertex */
    uint32_t tip;  /* vertex at the other end of `side` */
};

struct gd_component {
    uint32_t faces, vertices, edges, boundaries;
    /* mean, over the component's faces, of each face's shortest edge; normalised unit */
    double grain;
};

struct gd_bvh; /* bvh.h */

struct gd_mesh {
    atomic_uint references;
    struct gd_mesh_summary summary;
    double unit; /* a power of two: external length = unit x internal length */

    /* number of elements; only referenced vertices have internal numbers */
    uint32_t vertex_count, face_count, edge_count;

    struct gd_vec3 *position; /* normalised unit, per vertex */
    double *total_angle;      /* per vertex */
    uint8_t *vertex_kind;     /* enum gd_vertex_kind */
    uint32_t *vertex_component;
    uint32_t *fan_first; /* for each vertex, its first entry in `fan`; vertex_count + 1 entries */
    struct gd_fan *fan;  /* 3 face_count entries */
    /* For each fan entry, let e be the edge of its face opposite to the vertex. The item is the
       apex of the face on the other side of e, or GD_NONE if e is a boundary edge. */
    uint32_t *beyond;

    struct gd_side *side; /* 2 edge_count entries, 64-byte aligned */
    /* for each side, its origin; the destination of side h is origin[h ^ 1] */
    uint32_t *origin;
    uint32_t *side_face; /* per side; GD_NONE at the boundary */
    /* for each face, its sides; side k runs from corner k to corner k + 1, and corner 0 is the
       input's corner 0 */
    uint32_t (*face_side)[3];

    struct gd_component *component;
    struct gd_boundary *boundary; /* in the unit of the input */
    uint32_t *boundary_side;      /* for each loop, one of its boundary sides */

    /* numbering of the input */
    /* index_count entries: for each input index, its vertex, or GD_NONE if no face uses it */
    uint32_t *vertex_of_index;
    uint32_t *index_of_vertex;
    /* face_index_count entries: for each input triangle, its face, or GD_NONE if repair removed
       it */
    uint32_t *face_of_index;
    uint32_t *index_of_face;
    /* for each face, 1 if corners 1 and 2 are swapped relative to the input */
    uint8_t *face_flipped;
    /* for each input triangle, the input polygon that it is part of; NULL if the input had only
       triangles */
    uint32_t *source_polygon;
    /* For each input index, the exact position given by the caller. NULL if each index has a vertex
       of its own and `position` times `unit` gives its exact position. */
    struct gd_vec3 *input_position;

    struct gd_mesh_repair *repair; /* NULL without repair and weld */
    /* for each vertex that repair appended, the input index of its original; may be NULL */
    uint32_t *copy_of;

    struct gd_bvh *bvh;
    size_t bytes;
};

static inline bool gd__side_is_boundary(const struct gd_mesh *mesh, uint32_t side)
{
    return mesh->side[side].left == GD_NONE;
}

static inline uint32_t gd__side_destination(const struct gd_mesh *mesh, uint32_t side)
{
    return mesh->origin[side ^ 1];
}

/* Return the next and the previous side around the face of `side`, which must have a face. */
static inline uint32_t gd__side_next(const struct gd_mesh *mesh, uint32_t side)
{
    return mesh->side[side].right ^ 1;
}

static inline uint32_t gd__side_previous(const struct gd_mesh *mesh, uint32_t side)
{
    return mesh->side[side].left ^ 1;
}

/* Returns the corner opposite to `side` in its face. */
static inline uint32_t gd__side_apex(const struct gd_mesh *mesh, uint32_t side)
{
    return mesh->origin[mesh->side[side].right];
}

/* The neighbours of a vertex are numbered from fan_first[vertex] on. Each fan entry has one
 * neighbour, and a boundary vertex has one more. Returns the number after the last neighbour. */
static inline uint32_t gd__neighbours_end(const struct gd_mesh *mesh, uint32_t vertex)
{
    return mesh->fan_first[vertex + 1] + (mesh->vertex_kind[vertex] == GD_VERTEX_BOUNDARY);
}

static inline uint32_t gd__neighbour(const struct gd_mesh *mesh, uint32_t vertex, uint32_t number)
{
    return number < mesh->fan_first[vertex + 1] ? mesh->fan[number].tip
                                                : gd__side_apex(mesh, mesh->fan[number - 1].side);
}

/* Returns the exact position of a vertex that the caller gave, in the caller's unit. */
static inline struct gd_vec3 gd__vertex_position(const struct gd_mesh *mesh, uint32_t vertex)
{
    return mesh->input_position ? mesh->input_position[mesh->index_of_vertex[vertex]]
                                : gd_vec3_scale(mesh->position[vertex], mesh->unit);
}

/* Returns 1 - t for a point of an edge, with full precision. In points that an older version has
 * stored, 1 - t is missing and is computed from t. */
static inline double gd__edge_rest(const struct gd_point *point)
{
    return point->weight[1] > 0 ? point->weight[1] : 1 - point->weight[0];
}

/* Returns true if the mesh is graded: the rounding error of a position on the longest edge is not
 * small compared with the shortest edge. */
static inline bool gd__mesh_is_graded(const struct gd_mesh *mesh)
{
    return mesh->summary.edge_length.min < GD_TOL_GRADED * mesh->summary.edge_length.max;
}

/* Returns the index in `fan` of the entry of a side, which must have a face. Walks the fan of the
 * side's origin. */
uint32_t gd__fan_entry(const struct gd_mesh *mesh, uint32_t side);

/* Returns the side that runs from vertex a to vertex b, or GD_NONE. Walks the fan of a. */
uint32_t gd__side_between(const struct gd_mesh *mesh, uint32_t a, uint32_t b);
