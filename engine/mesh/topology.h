/* The mesh from the inside: what mesh builds and what the wedge, field and query rooms read.
 *
 * Everything is numbered anew inside: vertices and faces in Morton order of their positions (cache
 * lines are shared by neighbours), edges in order of first use by the faces in that order. Each
 * edge exists once; 2e and 2e+1 name its two sides, h ^ 1 is the other side of h.
 *
 * Frame of side h: origin vertex at (0,0), destination at (length,0), the side's face at y > 0. A
 * face runs counter-clockwise along its three sides. A side without a face is a boundary side:
 * `left` and `right` are GD_NONE there.
 *
 * Lengths inside are scaled by the exact power of two 1/unit, so that squares neither overflow nor
 * vanish; multiply by unit going out. */
#ifndef GD_MESH_TOPOLOGY_H
#define GD_MESH_TOPOLOGY_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/tolerance.h"
#include "gd/locate.h"
#include "gd/mesh.h"
#include "gd/point.h"

/* One cache line: all that propagation across the face of a side needs. p is the apex, the corner
 * opposite to the side. */
struct gd_side {
    double length;                    /* of the edge */
    double left_length, right_length; /* |origin p|, |p destination| */
    double left_x, left_y;            /* unit vector origin -> p in the side's frame */
    double right_x, right_y;          /* unit vector p -> destination */
    /* sides across: twin of the face's side (p -> origin), runs origin -> p; twin of the side
       (destination -> p), runs p -> destination. Both GD_NONE on the boundary */
    uint32_t left, right;
};

enum gd_vertex_kind {
    GD_VERTEX_CONVEX = 0, /* interior, total angle <= 2 pi: no shortest path passes */
    GD_VERTEX_SADDLE = 1, /* interior, total angle > 2 pi */
    GD_VERTEX_BOUNDARY = 2
};

/* One entry a face corner: the faces around a vertex, counter-clockwise, starting at the boundary
 * side if there is one. */
struct gd_fan {
    /* where the face begins, from the first entry's side; at a boundary vertex the first side is a
       boundary edge */
    double angle;
    uint32_t side; /* outgoing side, whose face this is */
    uint32_t tip;  /* its other end */
};

struct gd_component {
    uint32_t faces, vertices, edges, boundaries;
    double grain; /* mean of the shortest edges of its faces, inside unit */
};

struct gd_bvh; /* locate.c */

struct gd_mesh {
    atomic_uint references;
    struct gd_mesh_summary summary;
    double unit; /* a power of two: length outside = unit x length inside */

    uint32_t vertex_count, face_count, edge_count; /* inside: referenced vertices only */

    struct gd_vec3 *position; /* inside unit, per vertex */
    double *total_angle;      /* per vertex */
    uint8_t *vertex_kind;     /* enum gd_vertex_kind */
    uint32_t *vertex_component;
    uint32_t *fan_first; /* vertex_count + 1 */
    struct gd_fan *fan;  /* 3 face_count */
    /* per entry of a fan: the corner behind the edge opposite to the vertex; GD_NONE: that is
       boundary */
    uint32_t *beyond;

    struct gd_side *side; /* 2 edge_count, 64-byte aligned */
    uint32_t *origin;     /* per side; destination = origin[h ^ 1] */
    uint32_t *side_face;  /* per side; GD_NONE: boundary */
    uint32_t *side_fan;   /* per side with a face: its entry in `fan` */
    /* per face: side k runs from corner k to corner k+1; corner 0 is the input's corner 0 */
    uint32_t (*face_side)[3];

    struct gd_component *component;
    struct gd_boundary *boundary; /* outside unit */
    uint32_t *boundary_side;      /* per loop one of its boundary sides */

    /* numbering */
    /* index_count entries: input index -> vertex, GD_NONE if unreferenced */
    uint32_t *vertex_of_index;
    uint32_t *index_of_vertex;
    /* face_index_count entries: input triangle -> face, GD_NONE if repair removed it */
    uint32_t *face_of_index;
    uint32_t *index_of_face;
    uint8_t *face_flipped;          /* per face: corners 1 and 2 are swapped against the input */
    uint32_t *source_polygon;       /* per input triangle; NULL when the input had only triangles */
    struct gd_vec3 *input_position; /* per input index, as given: to the last bit */

    struct gd_mesh_repair *repair; /* NULL: neither repair nor weld was asked for */
    /* per vertex index that repair appended: the input index of its original; NULL: none */
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

/* The next and the previous side around the face of `side`, which has one. */
static inline uint32_t gd__side_next(const struct gd_mesh *mesh, uint32_t side)
{
    return mesh->side[side].right ^ 1;
}

static inline uint32_t gd__side_previous(const struct gd_mesh *mesh, uint32_t side)
{
    return mesh->side[side].left ^ 1;
}

/* The corner opposite to `side` in its face. */
static inline uint32_t gd__side_apex(const struct gd_mesh *mesh, uint32_t side)
{
    return mesh->origin[mesh->side[side].right];
}

/* A vertex' neighbours have the numbers [fan_first[vertex], gd__neighbours_end): those of its fan's
 * entries, and at the boundary one more. */
static inline uint32_t gd__neighbours_end(const struct gd_mesh *mesh, uint32_t vertex)
{
    return mesh->fan_first[vertex + 1] + (mesh->vertex_kind[vertex] == GD_VERTEX_BOUNDARY);
}

static inline uint32_t gd__neighbour(const struct gd_mesh *mesh, uint32_t vertex, uint32_t number)
{
    return number < mesh->fan_first[vertex + 1] ? mesh->fan[number].tip
                                                : gd__side_apex(mesh, mesh->fan[number - 1].side);
}

/* What is left of an edge beyond a point of it, as a part of its length. Stored points of older
 * fields have t alone. */
static inline double gd__edge_rest(const struct gd_point *point)
{
    return point->weight[1] > 0 ? point->weight[1] : 1 - point->weight[0];
}

/* Some edge is so much shorter than another that places on the longer one, as they are stored, do
 * not tell the shorter one's ends apart well. */
static inline bool gd__mesh_is_graded(const struct gd_mesh *mesh)
{
    return mesh->summary.edge_length.min < GD_TOL_GRADED * mesh->summary.edge_length.max;
}

/* The side that runs from vertex a to vertex b, or GD_NONE. Walks the fan of a. */
uint32_t gd__side_between(const struct gd_mesh *mesh, uint32_t a, uint32_t b);

#endif
