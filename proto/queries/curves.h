/* Queries about curves: operations (length, resample, shorten, closed-geodesic, offset), the
 * distance of two curves, and the cut of a mesh along a curve. */
#pragma once

#include "gd/curve_distance.h"
#include "gd/cut.h"
#include "gd/offset.h"
#include "gd/resampling.h"
#include "gd/shortening.h"
#include "generated/requests.h"
#include "proto/http/options.h"
#include "proto/json/writer.h"
#include "proto/values/set.h"

/* --- operations ------------------------------------------------------------------------------- */

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

/* --- distance of two curves ------------------------------------------------------------------- */

/* Each curve is a set with one member; freed by proto_curve_distance_free. */
struct proto_curve_distance {
    struct proto_set a, b;
    bool hausdorff;
};

/* Decodes the body of a request. Problems: invalid_request, too_large, insufficient_memory. */
bool proto_curve_distance_decode(const json_t *document, struct proto_curve_distance *out,
                                 struct proto_problem *problem);
void proto_curve_distance_free(struct proto_curve_distance *wanted); /* may be called repeatedly */

/* Writes the selected members of the answer. */
void proto_curve_distance_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                                 const struct gd_curve_distance *least,
                                 const struct proto_options *options);

/* Writes the Hausdorff distance from two results of gd_curve_farthest; in `from_a` the roles of the
 * two curves are swapped. */
void proto_hausdorff_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                            const struct gd_curve_distance *from_a,
                            const struct gd_curve_distance *from_b,
                            const struct proto_options *options);

/* --- cut -------------------------------------------------------------------------------------- */

/* Begin and end the answer; proto_cut_piece_encode writes each piece in between. `fields` has the
 * meaning of the member in struct proto_options. */
void proto_cut_begin(struct proto_writer *writer, const struct gd_cut *cut, uint32_t fields);
void proto_cut_end(struct proto_writer *writer, const struct gd_cut *cut, uint32_t fields);

/* Writes a piece. `name` is the name of its new mesh; NULL means that faces were only selected. */
void proto_cut_piece_encode(struct proto_writer *writer, const struct gd_cut_piece *piece,
                            const char *name, uint32_t fields);
