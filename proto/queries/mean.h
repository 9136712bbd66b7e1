/* Mean: the weighted mean of points of a surface. The request is {"points", "weights"?,
 * "method"?}. */
#ifndef PROTO_MEAN_H
#define PROTO_MEAN_H

#include "gd/mean.h"
#include "proto/http/options.h"
#include "proto/values/points.h"

#define PROTO_MEAN_POINTS 1000 /* most points */

struct proto_mean { /* all zero is an empty one */
    struct proto_points points;
    double *weights; /* owned; NULL: equal ones */
    bool one_step;   /* method: one_step instead of karcher */
};

/* invalid_request, too_large (with the limit), insufficient_memory. Freed by proto_mean_free. */
bool proto_mean_decode(const json_t *document, struct proto_mean *out,
                       struct proto_problem *problem);
void proto_mean_free(struct proto_mean *mean); /* a second time is harmless */

/* Fields of the answer, as bits of proto_options.fields. */
enum proto_mean_field {
    PROTO_MEAN_FIELD_POINT = 1 << 0,
    PROTO_MEAN_FIELD_RESIDUAL = 1 << 1,
    PROTO_MEAN_FIELD_SPREAD = 1 << 2,
    PROTO_MEAN_FIELD_ITERATIONS = 1 << 3,
    PROTO_MEAN_FIELD_CONVERGED = 1 << 4,
    PROTO_MEAN_FIELD_CUT_LOCUS = 1 << 5
};
extern const char *const proto_mean_fields[]; /* NULL-terminated, for proto_options_parse */

/* Writes {"point", "residual", "spread", "iterations", "converged"}, of these the wanted ones. */
void proto_mean_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                       const struct gd_mean *mean, const struct proto_options *options);

#endif
