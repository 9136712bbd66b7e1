/* Curve: how a client says where a curve runs on a surface. One of
 *     {"points": [point…], "closed"?}   consecutive points joined by shortest paths
 *     {"vertices": [index…], "closed"?} consecutive vertices share an edge
 *     {"boundary": index}               a boundary loop, by its place in the description
 *     {"spline": {…}}                   a geodesic Hermite spline, see spline.h
 * Decoding needs no mesh; locating puts the points on one; resolving makes the polyline, which
 * takes its time. */
#ifndef PROTO_CURVE_H
#define PROTO_CURVE_H

#include <jansson.h>

#include "gd/curve.h"
#include "proto/values/points.h"
#include "proto/values/spline.h"

#define PROTO_CURVE_POINTS   4096 /* each is a search */
#define PROTO_CURVE_VERTICES (1 << 20)

/* All zero is an empty curve. */
struct proto_curve {
    enum gd_curve_kind kind; /* but of splines */
    bool closed;
    char place[PROTO_POINT_PLACE]; /* where it stood in the request */
    struct proto_points points;
    struct gd_vertex *vertices; /* owned, vertex_count of them */
    uint32_t vertex_count;
    uint32_t boundary;
    struct proto_spline *spline; /* owned; NULL: it is none */
};

/* `pointer`: the JSON Pointer of `value`, copied. invalid_request, too_large, insufficient_memory.
 * The caller frees the curve by proto_curve_free. */
bool proto_curve_decode(const json_t *value, const char *pointer, struct proto_curve *out,
                        struct proto_problem *problem);
/* leaves an empty curve; a second time is harmless */
void proto_curve_free(struct proto_curve *curve);

/* A curve on its mesh, all zero: none. */
struct proto_located_curve {
    struct gd_curve_request request; /* of the memory below */
    char place[PROTO_POINT_PLACE];
    struct proto_located_points points;
    struct gd_vertex *vertices;
    struct proto_spline *spline; /* NULL: it is none, and the request counts */
    struct proto_located_spline located_spline;
};

/* proto_point_locate for each point; vertices and boundary are for gd_curve_resolve to look up.
 * Takes the vertices and the spline out of the curve, which is still to be freed. Its problems, and
 * insufficient_memory. */
bool proto_curve_locate(const struct gd_mesh *mesh, struct proto_curve *curve,
                        struct proto_located_curve *out, struct proto_problem *problem);
void proto_located_curve_free(struct proto_located_curve *located); /* leaves none */

/* Gives the vertices and the spline back to the curve that they were taken from, and leaves no
 * located one. */
void proto_located_curve_return(struct proto_located_curve *located, struct proto_curve *curve);

/* The polyline: gd_curve_resolve, or gd_spline_curve. `detail` must be all zero. */
GD_MUST_USE enum gd_status proto_curve_resolve(const struct gd_mesh *mesh,
                                               const struct proto_located_curve *located,
                                               const struct gd_landmarks *landmarks,
                                               const struct gd_control *control,
                                               struct gd_curve *out, struct gd_detail *detail);

/* The problem that its failure is, at the curve's place. False. */
bool proto_curve_fail(const struct proto_located_curve *located, enum gd_status status,
                      struct gd_detail *detail, struct proto_problem *problem);

#endif
