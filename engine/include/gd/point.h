/* Surface point: a point of a mesh, which is a vertex, or lies on an edge or in a face. The
 * constructors determine its `kind`.
 *
 * If a point lies on a vertex or an edge up to rounding, the constructors move the point onto this
 * vertex or edge. So later computations need no such test. `element` is an internal number of the
 * mesh; gd_point_describe converts a point to the caller's numbering. */
#ifndef GD_POINT_H
#define GD_POINT_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "gd/mesh.h"

GD_EXTERN_C_BEGIN

enum gd_point_kind { GD_POINT_VERTEX, GD_POINT_EDGE, GD_POINT_FACE };

struct gd_point {
    enum gd_point_kind kind;
    uint32_t element; /* internal number of the vertex, edge or face */
    /* Edge: weight[0] = t in (0,1), from the origin of the edge's side 0, and weight[1] = 1 - t,
       each accurate to its last digit. Face: barycentric coordinates, all > 0, with sum 1. */
    double weight[3];
};

/* Computes the point at a vertex. All constructors leave `out` untouched on failure, are
 * thread-safe, and take O(1); gd_point_on_edge takes O(faces around a vertex). Errors, with a
 * sentence in `detail`, which may be NULL: GD_OUT_OF_RANGE (no such element),
 * GD_UNREFERENCED_VERTEX, GD_NO_SUCH_EDGE, GD_NOT_ON_SURFACE (barycentrics whose sum is not 1, or t
 * outside [0,1], by more than 1e-9), GD_INVALID_ARGUMENT (not finite). */
GD_MUST_USE enum gd_status gd_point_at_vertex(const struct gd_mesh *mesh, struct gd_vertex vertex,
                                              struct gd_point *out, struct gd_detail *detail);

/* Computes the point (1-t) ends[0] + t ends[1] of the edge between two vertices. */
GD_MUST_USE enum gd_status gd_point_on_edge(const struct gd_mesh *mesh,
                                            const struct gd_vertex ends[2], double t,
                                            struct gd_point *out, struct gd_detail *detail);

/* Computes the point of a face with the given barycentric coordinates, which follow the input's
 * order of corners even if the face was flipped. */
GD_MUST_USE enum gd_status gd_point_in_face(const struct gd_mesh *mesh, struct gd_face face,
                                            const double barycentric[3], struct gd_point *out,
                                            struct gd_detail *detail);

/* A point in the caller's numbering. */
struct gd_point_description {
    struct gd_vec3 xyz;
    struct gd_face face;   /* the lowest-numbered face that contains the point */
    double barycentric[3]; /* coordinates in this face, with corners in the input's order */
    enum gd_point_kind kind;
    struct gd_vertex vertex;  /* valid if kind == GD_POINT_VERTEX */
    struct gd_vertex edge[2]; /* valid if kind == GD_POINT_EDGE; edge[0].index < edge[1].index */
    double t;                 /* fraction of the edge, from edge[0] */
};

void gd_point_describe(const struct gd_mesh *mesh, const struct gd_point *point,
                       struct gd_point_description *out);

struct gd_vec3 gd_point_position(const struct gd_mesh *mesh, const struct gd_point *point);

/* Computes x, y, z of `count` points. The results equal those of gd_point_position to the last
 * bit. */
void gd_points_positions(const struct gd_mesh *mesh, const struct gd_point *points, uint32_t count,
                         double (*out)[3]);

/* Returns the number of the point's component, below summary.components. No path joins different
 * components. O(1). */
uint32_t gd_point_component(const struct gd_mesh *mesh, const struct gd_point *point);

/* Returns true if both points are equal to the last bit. The points must come from the
 * constructors. */
static inline bool gd_point_equal(const struct gd_point *a, const struct gd_point *b)
{
    return a->kind == b->kind && a->element == b->element &&
           memcmp(a->weight, b->weight, sizeof a->weight) == 0;
}

GD_EXTERN_C_END

#endif
