/* Lines and vectors: traces, logarithms, exponentials, transport, means. */
#include "tests/fault/operations.h"

#include <stdlib.h>

#include "gd/mean.h"
#include "gd/query.h"
#include "gd/vector.h"
#include "tests/samples/samples.h"
#include "tests/support/test.h"

enum { CELLS = 14, PLACES = 5, VERTICES = (CELLS + 1) * (CELLS + 1) };

static struct gd_mesh *mesh;
static struct gd_point places[PLACES];
static struct gd_field *field;
static struct gd_pair_answer pair;
static struct gd_log logarithm;
static struct gd_vector bent[2]; /* two segments */

static void open_lines(void)
{
    struct gd_polygons polygons;
    struct rng rng = {2};
    check_ok(sample_terrain(CELLS, 0.9, 3, &polygons), NULL);
    mesh = test_mesh(&polygons);
    for (int i = 0; i < PLACES; i++)
        places[i] = test_point(mesh, test_random_place(&polygons, &rng));
    gd_polygons_free(&polygons);
    check_ok(gd_field_build(mesh,
                            &(struct gd_field_request){
                                .seeds = &(struct gd_seed){.point = places[0]}, .seed_count = 1},
                            NULL, &field, NULL),
             NULL);
    check_ok(gd_pair_solve(mesh,
                           &(struct gd_pair_request){
                               .from = &places[1], .to = &places[2], .output = GD_PAIR_PATH},
                           NULL, &pair, NULL),
             NULL);
    check_ok(gd_vector_log(mesh, &pair.path, &logarithm, NULL), NULL);
    bent[0] = bent[1] = logarithm.vector;
    bent[1].direction.angle += 1;
}

/* --- answers ---------------------------------------------------------------------------------- */

static void digest_trace(struct digest *digest, const void *out)
{
    const struct gd_trace *trace = out;
    digest_path(digest, &trace->path);
    digest_number(digest, trace->direction.angle);
    digest_number(digest, trace->end);
}

static void discard_trace(void *out)
{
    gd_trace_free(out);
}

static void digest_log(struct digest *digest, const void *out)
{
    const struct gd_log *found = out;
    digest_number(digest, found->vector.length);
    for (uint32_t i = 0; i < found->count; i++)
        digest_number(digest, found->segments[i].direction.angle);
}

static void discard_log(void *out)
{
    gd_log_free(out);
}

static void digest_vector(struct digest *digest, const void *out)
{
    const struct gd_vector *vector = out;
    digest_number(digest, vector->direction.angle);
    digest_number(digest, vector->length);
}

struct logs {
    double angles[VERTICES], lengths[VERTICES];
};

static void digest_logs(struct digest *digest, const void *out)
{
    digest_bytes(digest, out, sizeof(struct logs));
}

static void digest_mean(struct digest *digest, const void *out)
{
    const struct gd_mean *mean = out;
    digest_path(digest, &(struct gd_path){.length = mean->spread,
                                          .count = 1,
                                          .points = (struct gd_point *)&mean->point});
}

static const struct answer a_trace = {sizeof(struct gd_trace), digest_trace, discard_trace};
static const struct answer a_log = {sizeof(struct gd_log), digest_log, discard_log};
static const struct answer a_vector = {sizeof(struct gd_vector), digest_vector, NULL};
static const struct answer all_logs = {sizeof(struct logs), digest_logs, NULL};
static const struct answer a_mean = {sizeof(struct gd_mean), digest_mean, NULL};

/* --- calls ------------------------------------------------------------------------------------ */

static enum gd_status trace(const struct gd_trace_options *options, void *out)
{
    struct gd_detail detail = {0};
    return gd_trace_follow(mesh,
                           &(struct gd_trace_request){.start = &places[0],
                                                      .ahead = &(struct gd_direction){.angle = 1},
                                                      .length = 3,
                                                      .options = options},
                           NULL, out, &detail);
}

static enum gd_status trace_to_boundary(void *out)
{
    return trace(NULL, out);
}

static enum gd_status trace_along_boundary(void *out)
{
    return trace(&(struct gd_trace_options){.boundary_rule = GD_BOUNDARY_RULE_SLIDE,
                                            .vertex_rule = GD_VERTEX_RULE_NORMAL},
                 out);
}

static enum gd_status trace_to_itself(void *out)
{
    return trace(&(struct gd_trace_options){.boundary_rule = GD_BOUNDARY_RULE_SLIDE,
                                            .stop_at_self_intersection = true},
                 out);
}

static enum gd_status take_log(void *out)
{
    struct gd_detail detail = {0};
    return gd_vector_log(mesh, &pair.path, out, &detail);
}

static enum gd_status take_all_logs(void *out)
{
    struct logs *logs = out;
    return gd_vector_log_all(field, NULL, logs->angles, logs->lengths, NULL);
}

static enum gd_status take_exp(void *out)
{
    return gd_vector_exp(mesh,
                         &(struct gd_exp_request){.start = &places[1],
                                                  .segments = logarithm.segments,
                                                  .count = logarithm.count},
                         NULL, out, NULL);
}

static enum gd_status take_bent_exp(void *out)
{
    return gd_vector_exp(
        mesh, &(struct gd_exp_request){.start = &places[1], .segments = bent, .count = COUNT(bent)},
        NULL, out, NULL);
}

static enum gd_status transport(void *out)
{
    struct gd_detail detail = {0};
    *(struct gd_vector *)out = logarithm.vector;
    return gd_vector_transport(mesh, &pair.path, out, 1, &detail);
}

static enum gd_status find_mean(void *out)
{
    return gd_mean_find(mesh, &(struct gd_mean_request){.points = places, .count = 3}, NULL, out,
                        NULL);
}

static enum gd_status find_mean_in_one_step(void *out)
{
    return gd_mean_find(mesh,
                        &(struct gd_mean_request){.points = places, .count = 3, .one_step = true},
                        NULL, out, NULL);
}

static const struct operation items[] = {
    {"trace", &a_trace, trace_to_boundary, GD_OK, NULL},
    {"trace along the boundary", &a_trace, trace_along_boundary, GD_OK, NULL},
    {"trace to itself", &a_trace, trace_to_itself, GD_OK, NULL},
    {"logarithm", &a_log, take_log, GD_OK, NULL},
    {"logarithms of all vertices", &all_logs, take_all_logs, GD_OK, NULL},
    {"exponential", &a_trace, take_exp, GD_OK, NULL},
    {"exponential with a bend", &a_trace, take_bent_exp, GD_OK, NULL},
    {"parallel transport", &a_vector, transport, GD_OK, NULL},
    {"mean", &a_mean, find_mean, GD_OK, NULL},
    {"mean in one step", &a_mean, find_mean_in_one_step, GD_OK, NULL},
};

const struct operations line_operations = {open_lines, items, COUNT(items)};
