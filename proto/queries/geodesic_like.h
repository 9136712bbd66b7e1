/* Geodesic-like curves: shortest paths on a parametric surface. The requests are
 *
 *     geodesic               {"from": [u, v], "to": [u, v]}
 *     point-curve-distance   {"point": [u, v], "curve": curve}
 *     curve-distance         {"a": curve, "b": curve}
 *
 * each with the options of struct proto_geodesic_request; their answers differ in the names of the ends only. The path is one B-spline in the domain: "degree", "knots"
 * and "control_points" (u, v). */
#ifndef PROTO_GEODESIC_LIKE_H
#define PROTO_GEODESIC_LIKE_H

#include "gd/geodesic_like.h"
#include "generated/requests.h"
#include "proto/http/options.h"
#include "proto/values/domain_curve.h"

/* Names of the two ends in a request, and of all members; which ends are curves; and which are told
 * of in the answer. */
struct proto_geodesic_form {
    const char *ends[2];
    const char *const *members;
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
