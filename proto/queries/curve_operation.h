/* Curve operation: what is done to a curve. The operations and their answers:
 *
 *     length                    {"path"}
 *     resample                  {"path", "points"}
 *     shorten, closed-geodesic  {"path", "turn", "rounds", "geodesic"}
 *     offset                    {"paths"} */
#ifndef PROTO_CURVE_OPERATION_H
#define PROTO_CURVE_OPERATION_H

#include "gd/offset.h"
#include "gd/resampling.h"
#include "gd/shortening.h"
#include "generated/requests.h"
#include "proto/http/options.h"

#define PROTO_CURVE_OPERATION_FLAT                                                                 \
    1e-3 /* tolerance of an offset's path when none is given, as a part of the distance */

/* Its request, whose tolerance is set. invalid_request, too_large, insufficient_memory. Freed by
 * proto_curve_operation_request_free. */
bool proto_curve_operation_decode(const json_t *document, struct proto_curve_operation_request *out,
                                  struct proto_problem *problem);

/* What has come out of an operation: what does not belong to it is all zero. The curve is the
 * path. */
struct proto_curve_result {
    unsigned operation; /* PROTO_OPERATION_… */
    struct gd_curve curve;
    struct gd_point *points;
    uint32_t point_count;
    double turn;
    uint32_t rounds;
    bool is_geodesic;
    struct gd_path *paths; /* path_count of them */
    bool *is_closed;       /* of each */
    uint32_t path_count;
};

void proto_curve_result_free(struct proto_curve_result *result); /* a second time is harmless */

/* Writes the members above, of these the wanted ones. */
void proto_curve_result_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                               const struct proto_curve_result *result,
                               const struct proto_options *options);

#endif
