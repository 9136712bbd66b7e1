/* Curve operation: what is done to a curve. The request is {"curve", "operation"} and the
 * operation's arguments:
 *
 *     length                                      -> {"path"}
 *     resample         "count"                    -> {"path", "points"}
 *     shorten          "rounds"?, "pieces"?       -> {"path", "turn", "rounds", "geodesic"}
 *     closed-geodesic                             -> the same
 *     offset           "distance", "tolerance"?   -> {"paths"} */
#ifndef PROTO_CURVE_OPERATION_H
#define PROTO_CURVE_OPERATION_H

#include "gd/offset.h"
#include "gd/resampling.h"
#include "gd/shortening.h"
#include "proto/values/curve.h"
#include "proto/http/options.h"

#define PROTO_CURVE_OPERATION_COUNT  100000 /* points of a resampling */
#define PROTO_CURVE_OPERATION_ROUNDS 10000
#define PROTO_CURVE_OPERATION_PIECES 10000
#define PROTO_CURVE_OPERATION_FLAT                                                                 \
    1e-3 /* tolerance of an offset's path when none is given, as a part of the distance */

enum proto_operation {
    PROTO_OPERATION_LENGTH,
    PROTO_OPERATION_RESAMPLE,
    PROTO_OPERATION_SHORTEN,
    PROTO_OPERATION_CLOSED_GEODESIC,
    PROTO_OPERATION_OFFSET
};

struct proto_curve_operation {
    struct proto_curve curve;
    enum proto_operation operation;
    uint32_t count, rounds, pieces;
    double distance, tolerance;
};

/* invalid_request, too_large, insufficient_memory. Freed by proto_curve_operation_free. */
bool proto_curve_operation_decode(const json_t *document, struct proto_curve_operation *out,
                                  struct proto_problem *problem);
/* a second time is harmless */
void proto_curve_operation_free(struct proto_curve_operation *operation);

/* Fields of the answer, as bits of proto_options.fields. */
enum proto_curve_operation_field {
    PROTO_CURVE_OPERATION_FIELD_PATH = 1 << 0,
    PROTO_CURVE_OPERATION_FIELD_POINTS = 1 << 1,
    PROTO_CURVE_OPERATION_FIELD_TURN = 1 << 2,
    PROTO_CURVE_OPERATION_FIELD_ROUNDS = 1 << 3,
    PROTO_CURVE_OPERATION_FIELD_GEODESIC = 1 << 4,
    PROTO_CURVE_OPERATION_FIELD_PATHS = 1 << 5
};
/* NULL-terminated, for proto_options_parse */
extern const char *const proto_curve_operation_fields[];

/* What has come out of an operation: what does not belong to it is all zero. The curve is the
 * path. */
struct proto_curve_result {
    enum proto_operation operation;
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
