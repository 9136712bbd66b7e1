/* Curve distance: the smallest distance or the Hausdorff distance of two curves. */
#ifndef PROTO_CURVE_DISTANCE_H
#define PROTO_CURVE_DISTANCE_H

#include "gd/curve_distance.h"
#include "proto/http/options.h"
#include "proto/json/writer.h"
#include "proto/values/set.h"

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

#endif
