#include "proto/queries/mean.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "proto/json/decode.h"
#include "proto/json/member.h"

const char *const proto_mean_fields[] = {"point",     "residual",  "spread", "iterations",
                                         "converged", "cut_locus", NULL};

/* --- the request ------------------------------------------------------------------------------ */

void proto_mean_free(struct proto_mean *mean)
{
    proto_points_free(&mean->points);
    free(mean->weights);
    *mean = (struct proto_mean){0};
}

static bool decode_method(const json_t *document, bool *one_step, struct proto_problem *problem)
{
    const json_t *value = json_object_get(document, "method");
    const char *word = value ? json_string_value(value) : "karcher";
    *one_step = word && strcmp(word, "one_step") == 0;
    if (*one_step || (word && strcmp(word, "karcher") == 0)) return true;
    return proto_problem_refuse(problem, "/method", "method is \"karcher\" or \"one_step\"");
}

static bool decode_weights(const json_t *document, struct proto_mean *mean,
                           struct proto_problem *problem)
{
    uint32_t count = mean->points.count;
    double sum = 0;
    if (!json_object_get(document, "weights")) return true;
    mean->weights = malloc(count * sizeof *mean->weights);
    if (!mean->weights) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    if (!proto_decode_numbers(document, "", "weights", count, mean->weights, problem)) return false;
    for (uint32_t i = 0; i < count; i++) {
        if (mean->weights[i] < 0)
            return proto_problem_refuse(problem, "/weights", "a weight is 0 or more");
        sum += mean->weights[i];
    }
    return (sum > 0 && isfinite(sum)) ||
           proto_problem_refuse(problem, "/weights",
                                "one weight must be more than 0, and their sum a finite number");
}

static bool decode(const json_t *document, struct proto_mean *mean, struct proto_problem *problem)
{
    const json_t *points = proto_decode_member(document, "", "points", problem);
    if (!points ||
        !proto_points_decode(&mean->points, points, "/points", PROTO_MEAN_POINTS, problem))
        return false;
    if (!mean->points.count)
        return proto_problem_refuse(problem, "/points", "name at least one point");
    return decode_weights(document, mean, problem) &&
           decode_method(document, &mean->one_step, problem);
}

bool proto_mean_decode(const json_t *document, struct proto_mean *out,
                       struct proto_problem *problem)
{
    static const char *const members[] = {"points", "weights", "method", NULL};
    struct proto_mean mean = {0};
    if (!proto_decode_object(document, "", members, problem)) return false;
    if (decode(document, &mean, problem)) {
        *out = mean;
        return true;
    }
    proto_mean_free(&mean);
    return false;
}

/* --- the answer ------------------------------------------------------------------------------- */

void proto_mean_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                       const struct gd_mean *mean, const struct proto_options *options)
{
    uint32_t fields = options->fields;
    proto_write_object_begin(writer);
    if (fields & PROTO_MEAN_FIELD_POINT)
        proto_member_point(writer, "point", mesh, &mean->point, NAN);
    if (fields & PROTO_MEAN_FIELD_RESIDUAL) proto_member_number(writer, "residual", mean->residual);
    if (fields & PROTO_MEAN_FIELD_SPREAD) proto_member_number(writer, "spread", mean->spread);
    if (fields & PROTO_MEAN_FIELD_ITERATIONS)
        proto_member_uint(writer, "iterations", mean->iterations);
    if (fields & PROTO_MEAN_FIELD_CONVERGED)
        proto_member_bool(writer, "converged", mean->converged);
    if (fields & PROTO_MEAN_FIELD_CUT_LOCUS) proto_member_bool(writer, "cut_locus", mean->is_cut);
    proto_write_object_end(writer);
}
