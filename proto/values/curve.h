/* Curve: points joined by shortest paths, vertices joined by edges, a boundary loop, or a spline.
 * Decoding needs no mesh. Locating puts the points on a mesh. Resolving computes the polyline,
 * which takes long. */
#ifndef PROTO_CURVE_H
#define PROTO_CURVE_H

#include <jansson.h>

#include "gd/curve.h"
#include "proto/values/points.h"
#include "proto/values/spline.h"

#define PROTO_CURVE_POINTS   4096 /* each point costs a search */
#define PROTO_CURVE_VERTICES (1 << 20)

/* All zero is an empty curve. */
struct proto_curve {
    enum gd_curve_kind kind; /* unused by splines */
    bool closed;
    char place[PROTO_POINT_PLACE]; /* its place in the request */
    struct proto_points points;
    struct gd_vertex *vertices; /* owned, vertex_count of them */
    uint32_t vertex_count;
    uint32_t boundary;
    struct proto_spline *spline; /* owned; NULL: not a spline */
};

/* Decodes a curve. `pointer`: the JSON Pointer of `value`, copied. Problems: invalid_request,
 * too_large, insufficient_memory. The caller frees the curve by proto_curve_free. */
bool proto_curve_decode(const json_t *value, const char *pointer, struct proto_curve *out,
                        struct proto_problem *problem);
/* leaves an empty curve; idempotent */
void proto_curve_free(struct proto_curve *curve);

/* A curve on its mesh, all zero: none. */
struct proto_located_curve {
    struct gd_curve_request request; /* points into the memory below */
    char place[PROTO_POINT_PLACE];
    struct proto_located_points points;
    struct gd_vertex *vertices;
    struct proto_spline *spline; /* NULL: not a spline, and `request` is used */
    struct proto_located_spline located_spline;
};

/* Locates each point by proto_point_locate; gd_curve_resolve later checks vertices and boundary.
 * Moves the vertices and the spline out of the curve, which the caller still frees. Problems: those
 * of proto_point_locate, and insufficient_memory. */
bool proto_curve_locate(const struct gd_mesh *mesh, struct proto_curve *curve,
                        struct proto_located_curve *out, struct proto_problem *problem);
void proto_located_curve_free(struct proto_located_curve *located); /* leaves none */

/* Moves the vertices and the spline back to the curve that they were taken from, and empties the
 * located curve. */
void proto_located_curve_return(struct proto_located_curve *located, struct proto_curve *curve);

/* Computes the polyline by gd_curve_resolve or gd_spline_curve. `detail` must be all zero. */
GD_MUST_USE enum gd_status proto_curve_resolve(const struct gd_mesh *mesh,
                                               const struct proto_located_curve *located,
                                               const struct gd_landmarks *landmarks,
                                               const struct gd_control *control,
                                               struct gd_curve *out, struct gd_detail *detail);

/* Converts a failure of proto_curve_resolve into a problem at the curve's place. Returns false. */
bool proto_curve_fail(const struct proto_located_curve *located, enum gd_status status,
                      struct gd_detail *detail, struct proto_problem *problem);

#endif
