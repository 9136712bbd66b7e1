/* Curve distance: {"a": curve, "b": curve, "measure"?: "min" | "hausdorff"}, and how far they are
 * from each other. */
#ifndef PROTO_CURVE_DISTANCE_H
#define PROTO_CURVE_DISTANCE_H

#include "gd/curve_distance.h"
#include "proto/http/options.h"
#include "proto/json/writer.h"
#include "proto/values/set.h"

/* Each curve as a set of which it is the only member; freed by proto_curve_distance_free. */
struct proto_curve_distance {
    struct proto_set a, b;
    bool hausdorff;
};

/* invalid_request, too_large, insufficient_memory. */
bool proto_curve_distance_decode(const json_t *document, struct proto_curve_distance *out,
                                 struct proto_problem *problem);
void proto_curve_distance_free(struct proto_curve_distance *wanted); /* a second time is harmless */

/* {"distance", "reason"?, "closest": {"a": place, "b": place}, "path"}: of these the wanted
 * ones. */
void proto_curve_distance_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                                 const struct gd_curve_distance *least,
                                 const struct proto_options *options);

/* {"distance", "reason"?, "a_to_b", "b_to_a", "farthest": {"a_to_b": {"a": place, "b": place},
 * "b_to_a": …}, "path"}: of these the wanted ones. Both as gd_curve_farthest gives them, so that in
 * `from_a` the curves have changed names. */
void proto_hausdorff_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                            const struct gd_curve_distance *from_a,
                            const struct gd_curve_distance *from_b,
                            const struct proto_options *options);

#endif
