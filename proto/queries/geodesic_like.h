/* Geodesic-like curves: shortest paths on a parametric surface between two points, a point and a
 * curve, or two curves. A path is one B-spline in the domain. */
#pragma once

#include "gd/geodesic_like.h"
#include "generated/requests.h"
#include "proto/http/options.h"
#include "proto/values/domain_curve.h"

/* A form of request: names of its two ends and of all members, which ends are curves, and which
 * ends the answer describes. */
struct proto_geodesic_form {
    const char *ends[2];
    const char *const *members;
    bool is_curve[2], is_answered[2];
};
extern const struct proto_geodesic_form proto_geodesic_between_points, proto_geodesic_to_curve,
    proto_geodesic_between_curves;

struct proto_geodesic { /* all zero means empty */
    const struct proto_geodesic_form *form;
    struct proto_domain_curve ends[2];
    struct proto_domain_curve initial; /* set if has_initial is true */
    bool has_initial, has_turns;
    int32_t turns[2];
    struct gd_geodesic_options options;
    uint32_t samples;
};

/* Decodes the body of a request. Problems: invalid_request, too_large, insufficient_memory. The
 * caller frees the result by proto_geodesic_free. */
bool proto_geodesic_decode(const json_t *document, const struct proto_geodesic_form *form,
                           struct proto_geodesic *out, struct proto_problem *problem);
void proto_geodesic_free(struct proto_geodesic *geodesic); /* may be called repeatedly */

/* Input of an answer; all borrowed. */
struct proto_geodesic_answer {
    const struct proto_geodesic *request;
    const struct gd_domain_curve *ends[2];
    const struct gd_geodesics *found;
};

/* Copy the knots or the control points of the path as one B-spline, and return their number. If
 * `out` is NULL, they only count. */
uint32_t proto_geodesic_knots(const struct gd_geodesic *path, double *out);
uint32_t proto_geodesic_control_points(const struct gd_geodesic *path, double (*out)[2]);

/* Returns the number of points to sample on a path, which is one if the path's ends coincide.
 * Errors: those of gd_geodesic_sample. */
uint32_t proto_geodesic_sample_count(const struct proto_geodesic *request,
                                     const struct gd_geodesic *path);
GD_MUST_USE enum gd_status proto_geodesic_sample(const struct proto_geodesic_answer *answer,
                                                 const struct gd_geodesic *path, double (*uv)[2],
                                                 struct gd_vec3 *xyz);

/* Writes the shortest path's fields; with all_minima also "minima", all locally shortest paths in
 * the same form. Error: GD_NO_MEMORY. */
GD_MUST_USE enum gd_status proto_geodesic_encode(struct proto_writer *writer,
                                                 const struct proto_geodesic_answer *answer,
                                                 const struct proto_options *options);
