/* Curve operation: length, resample, shorten, closed-geodesic and offset of a curve. */
#ifndef PROTO_CURVE_OPERATION_H
#define PROTO_CURVE_OPERATION_H

#include "gd/offset.h"
#include "gd/resampling.h"
#include "gd/shortening.h"
#include "generated/requests.h"
#include "proto/http/options.h"

#define PROTO_CURVE_OPERATION_FLAT                                                                 \
    1e-3 /* default tolerance of an offset, relative to its distance */

/* Result of an operation: fields of other operations are zero. `curve` is the answer's path. */
struct proto_curve_result {
    unsigned operation; /* PROTO_OPERATION_… */
    struct gd_curve curve;
    struct gd_point *points;
    uint32_t point_count;
    double turn;
    uint32_t rounds;
    bool is_geodesic;
    struct gd_path *paths; /* path_count items */
    bool *is_closed;       /* one for each path */
    uint32_t path_count;
};

void proto_curve_result_free(struct proto_curve_result *result); /* may be called repeatedly */

/* Writes the members of the result that the options select. */
void proto_curve_result_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                               const struct proto_curve_result *result,
                               const struct proto_options *options);

#endif
