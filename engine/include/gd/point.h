/* Surface point: a point of a mesh, one sum type for vertex, edge and face, decided once when the
 * point is made.
 *
 * A point that lies on a vertex or an edge up to rounding IS there: the constructors canonicalise,
 * so that the geometry behind them never asks again. The fields are numbered inside the mesh that
 * made the point; gd_point_describe turns them back into the caller's terms. */
#ifndef GD_POINT_H
#define GD_POINT_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "gd/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

enum gd_point_kind { GD_POINT_VERTEX, GD_POINT_EDGE, GD_POINT_FACE };

struct gd_point {
    enum gd_point_kind kind;
    uint32_t element; /* vertex, edge or face inside the mesh, by kind */
    /* Edge: weight[0] = t in (0,1), from the origin of side 0, and weight[1] = 1 - t, each to its
     * last digit. Face: barycentric coordinates, all > 0, of sum 1. */
    double weight[3];
};

/* All constructors: `out` untouched on failure; thread-safe; O(1) but for gd_point_on_edge, which
 * walks the fan of a vertex. Errors: GD_OUT_OF_RANGE (no such element), GD_UNREFERENCED_VERTEX,
 * GD_NO_SUCH_EDGE, GD_NOT_ON_SURFACE (barycentrics that do not sum to 1 or t outside [0,1], by more
 * than 1e-9), GD_INVALID_ARGUMENT (not finite). Each with a sentence in `detail`, which may be
 * NULL. */
GD_MUST_USE enum gd_status gd_point_at_vertex(const struct gd_mesh *mesh, struct gd_vertex vertex,
                                              struct gd_point *out, struct gd_detail *detail);

/* The point (1-t) ends[0] + t ends[1] of the edge between two vertices. */
GD_MUST_USE enum gd_status gd_point_on_edge(const struct gd_mesh *mesh,
                                            const struct gd_vertex ends[2], double t,
                                            struct gd_point *out, struct gd_detail *detail);

/* Barycentric coordinates by the face's corners in the input's order (whether or not the face was
 * turned over). */
GD_MUST_USE enum gd_status gd_point_in_face(const struct gd_mesh *mesh, struct gd_face face,
                                            const double barycentric[3], struct gd_point *out,
                                            struct gd_detail *detail);

/* All that is known of a point, in the caller's numbering. */
struct gd_point_description {
    struct gd_vec3 xyz;
    struct gd_face face;   /* the lowest-numbered one that contains it */
    double barycentric[3]; /* in that face, corners in the input's order */
    enum gd_point_kind kind;
    struct gd_vertex vertex;  /* kind == GD_POINT_VERTEX */
    struct gd_vertex edge[2]; /* kind == GD_POINT_EDGE: edge[0].index < edge[1].index */
    double t;                 /* from edge[0] */
};

void gd_point_describe(const struct gd_mesh *mesh, const struct gd_point *point,
                       struct gd_point_description *out);

struct gd_vec3 gd_point_position(const struct gd_mesh *mesh, const struct gd_point *point);

/* The same of `count` points at once, to the last bit; x, y, z of each. */
void gd_points_positions(const struct gd_mesh *mesh, const struct gd_point *points, uint32_t count,
                         double (*out)[3]);

/* Number of the component that the point lies on, below summary.components: between points of
 * different ones there is no path. */
uint32_t gd_point_component(const struct gd_mesh *mesh, const struct gd_point *point);

/* The same canonical point, to the last bit. */
static inline bool gd_point_equal(const struct gd_point *a, const struct gd_point *b)
{
    return a->kind == b->kind && a->element == b->element &&
           memcmp(a->weight, b->weight, sizeof a->weight) == 0;
}

#ifdef __cplusplus
}
#endif

#endif
