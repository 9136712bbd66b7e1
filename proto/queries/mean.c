#include "proto/queries/mean.h"

#include <math.h>
#include <stdlib.h>

static bool decode_weights(const json_t *document, uint32_t count, double *weights,
                           struct proto_problem *problem)
{
    double sum = 0;
    if (!proto_decode_numbers(document, "", "weights", count, weights, problem)) return false;
    for (uint32_t i = 0; i < count; i++) {
        if (weights[i] < 0)
            return proto_problem_refuse(problem, "/weights", "a weight is 0 or more");
        sum += weights[i];
    }
    return (sum > 0 && isfinite(sum)) ||
           proto_problem_refuse(problem, "/weights",
                                "one weight must be more than 0, and their sum a finite number");
}

bool proto_mean_weights_decode(const json_t *document, uint32_t count, double **out,
                               struct proto_problem *problem)
{
    *out = NULL;
    if (!json_object_get(document, "weights")) return true;
    double *weights = malloc(count * sizeof *weights);
    if (!weights) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    if (decode_weights(document, count, weights, problem)) {
        *out = weights;
        return true;
    }
    free(weights);
    return false;
}

void proto_mean_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                       const struct gd_mean *mean, const struct proto_options *options)
{
    proto_write_object_begin(writer);
    if (proto_field(writer, options, PROTO_MEAN_FIELD_POINT))
        proto_point_encode(writer, mesh, &mean->point, NAN);
    if (proto_field(writer, options, PROTO_MEAN_FIELD_RESIDUAL))
        proto_write_number(writer, mean->residual);
    if (proto_field(writer, options, PROTO_MEAN_FIELD_SPREAD))
        proto_write_number(writer, mean->spread);
    if (proto_field(writer, options, PROTO_MEAN_FIELD_ITERATIONS))
        proto_write_uint(writer, mean->iterations);
    if (proto_field(writer, options, PROTO_MEAN_FIELD_CONVERGED))
        proto_write_bool(writer, mean->converged);
    if (proto_field(writer, options, PROTO_MEAN_FIELD_CUT_LOCUS))
        proto_write_bool(writer, mean->is_cut);
    proto_write_object_end(writer);
}
