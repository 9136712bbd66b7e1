/* Curve: points joined by shortest paths, vertices joined by edges, a boundary loop, or a spline.
 * struct proto_curve and the functions that decode and free it are in generated/requests.h.
 * Locating moves the points onto a mesh. Resolving computes the polyline, which takes a long
 * time. */
#pragma once

#include "gd/curve.h"
#include "generated/requests.h"

/* A curve on its mesh. All zero means none. */
struct proto_located_curve {
    const struct proto_curve *curve;    /* borrowed */
    struct gd_curve_request request;    /* used unless the curve is a spline */
    struct proto_located_points points; /* the points of a curve of points */
    struct proto_located_spline spline; /* the spline, if the curve is one */
};

/* Locates each point by proto_point_locate; gd_curve_resolve later checks vertices and boundary.
 * `curve` must outlive the located curve. Problems: those of proto_point_locate, and
 * insufficient_memory. */
bool proto_curve_locate(const struct gd_mesh *mesh, const struct proto_curve *curve,
                        struct proto_located_curve *out, struct proto_problem *problem);
void proto_located_curve_free(struct proto_located_curve *located); /* leaves none */

/* Computes the polyline by gd_curve_resolve or gd_spline_curve. `detail` must be all zero. */
GD_MUST_USE enum gd_status proto_curve_resolve(const struct gd_mesh *mesh,
                                               const struct proto_located_curve *located,
                                               const struct gd_landmarks *landmarks,
                                               const struct gd_control *control,
                                               struct gd_curve *out, struct gd_detail *detail);

/* Converts a failure of proto_curve_resolve into a problem at the curve's place. Returns false. */
bool proto_curve_fail(const struct proto_located_curve *located, enum gd_status status,
                      struct gd_detail *detail, struct proto_problem *problem);
