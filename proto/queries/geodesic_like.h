/* Geodesic-like curves: shortest paths on a parametric surface. The requests are
 *
 *     geodesic               {"from": [u, v], "to": [u, v]}
 *     point-curve-distance   {"point": [u, v], "curve": curve}
 *     curve-distance         {"a": curve, "b": curve}
 *
 * each with "control_points"?, "degree"?, "tolerance"?, "all_minima"?, "samples"?; their answers
 * differ in the names of the ends only. The path is one B-spline in the domain: "degree", "knots"
 * and "control_points" (u, v). */
#ifndef PROTO_GEODESIC_LIKE_H
#define PROTO_GEODESIC_LIKE_H

#include "gd/geodesic_like.h"
#include "proto/values/domain_curve.h"
#include "proto/http/options.h"

/* points of an answer's path when the request does not say */
#define PROTO_GEODESIC_SAMPLES      65
#define PROTO_GEODESIC_SAMPLES_MOST 10000

/* Names of the two ends in a request; which of them are curves; and which are told of in the
 * answer. */
struct proto_geodesic_form {
    const char *ends[2];
    bool is_curve[2], is_told[2];
};
extern const struct proto_geodesic_form proto_geodesic_between_points, proto_geodesic_to_curve,
    proto_geodesic_between_curves;

struct proto_geodesic { /* all zero is an empty one */
    const struct proto_geodesic_form *form;
    struct proto_domain_curve ends[2];
    struct gd_geodesic_options options;
    uint32_t samples;
};

/* invalid_request, too_large, insufficient_memory. Freed by proto_geodesic_free. */
bool proto_geodesic_decode(const json_t *document, const struct proto_geodesic_form *form,
                           struct proto_geodesic *out, struct proto_problem *problem);
void proto_geodesic_free(struct proto_geodesic *geodesic); /* a second time is harmless */

/* Fields of the answer, as bits of proto_options.fields. */
enum proto_geodesic_field {
    PROTO_GEODESIC_FIELD_LENGTH = 1 << 0,
    PROTO_GEODESIC_FIELD_DEGREE = 1 << 1,
    PROTO_GEODESIC_FIELD_KNOTS = 1 << 2,
    PROTO_GEODESIC_FIELD_CONTROL_POINTS = 1 << 3,
    PROTO_GEODESIC_FIELD_POINTS = 1 << 4,
    PROTO_GEODESIC_FIELD_ENDS = 1 << 5,
    PROTO_GEODESIC_FIELD_RESIDUAL = 1 << 6,
    PROTO_GEODESIC_FIELD_ERROR = 1 << 7,
    PROTO_GEODESIC_FIELD_CURVATURE = 1 << 8,
    PROTO_GEODESIC_FIELD_SPEED_DEFECT = 1 << 9,
    PROTO_GEODESIC_FIELD_ITERATIONS = 1 << 10,
    PROTO_GEODESIC_FIELD_CONVERGED = 1 << 11,
    PROTO_GEODESIC_FIELD_IS_MINIMUM = 1 << 12,
    PROTO_GEODESIC_FIELD_BOUNDARY_CONTACT = 1 << 13,
    PROTO_GEODESIC_FIELD_WARNINGS = 1 << 14,
    PROTO_GEODESIC_FIELD_MINIMA = 1 << 15
};
extern const char *const proto_geodesic_fields[]; /* NULL-terminated, for proto_options_parse */

/* What an answer is about; all borrowed. */
struct proto_geodesic_answer {
    const struct proto_geodesic *request;
    const struct gd_domain_curve *ends[2];
    const struct gd_geodesics *found;
};

/* Writes the shortest one's fields, and with all_minima "minima", all those that are local minima,
 * in the same form. GD_NO_MEMORY. */
GD_MUST_USE enum gd_status proto_geodesic_encode(struct proto_writer *writer,
                                                 const struct proto_geodesic_answer *answer,
                                                 const struct proto_options *options);

#endif
