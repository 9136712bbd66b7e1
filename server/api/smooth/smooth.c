/* See smooth.h. */
#include "server/api/smooth/smooth.h"

#include "proto/jet.h"
#include "server/query/api.h"

#define APPROACH_BYTES ((size_t)1 << 20)

enum server_query_turn server_smooth_fail(const struct server_query *query, enum gd_status status,
                                          const struct gd_detail *detail, const char *what,
                                          struct proto_problem *problem)
{
    if (status == GD_BUDGET || !detail->text[0])
        return server_query_fail(query, status, what, problem);
    if (status == GD_INTERNAL) status = GD_DEGENERATE_FACE;
    proto_problem_from_status(problem, status, detail);
    if (status == GD_TOO_LARGE)
        proto_problem_limit(problem, query->exchange->host->api->config->max_faces);
    return SERVER_QUERY_FAILED;
}

/* --- evaluate --------------------------------------------------------------------------------- */

static enum gd_status write_round(struct server_smooth_evaluation *evaluation, uint32_t first)
{
    uint32_t total = evaluation->count, left = total - first,
             count = left < evaluation->round ? left : evaluation->round;
    struct server_monitor monitor =
        server_query_monitor(&evaluation->query, (double)first / total, (double)count / total);
    const struct gd_control control = server_exchange_control(&monitor);
    enum gd_status status = evaluation->write(evaluation, first, count, &control);
    if (!status) status = server_query_check_draft(&evaluation->query);
    return status ? status : gd_control_check(&control, 1);
}

enum server_query_turn server_smooth_evaluation_solve(struct server_query *query,
                                                      struct proto_problem *problem)
{
    struct server_smooth_evaluation *evaluation = (struct server_smooth_evaluation *)query;
    struct proto_writer *writer = &query->draft;
    enum gd_status status = GD_OK;
    proto_write_object_begin(writer);
    proto_write_key(writer, "points");
    proto_write_array_begin(writer);
    for (uint32_t i = 0; i < evaluation->count && !status; i += evaluation->round)
        status = write_round(evaluation, i);
    proto_write_array_end(writer);
    proto_write_object_end(writer);
    if (status)
        return server_smooth_fail(query, status, &evaluation->detail, "the answer", problem);
    return server_query_end_draft(query, GD_OK, "the answer", problem);
}

enum server_query_turn server_smooth_evaluation_glance(struct server_query *query,
                                                       struct proto_problem *problem)
{
    const struct server_smooth_evaluation *evaluation =
        (const struct server_smooth_evaluation *)query;
    if (evaluation->count > evaluation->quick) return SERVER_QUERY_AGAIN;
    return server_smooth_evaluation_solve(query, problem);
}

/* --- nearest ---------------------------------------------------------------------------------- */

bool server_smooth_approach_decode(struct server_smooth_approach *approach, const json_t *document,
                                   struct proto_problem *problem)
{
    return proto_foot_decode(document, &approach->xyz, problem);
}

static enum gd_status find(void *user, const struct gd_control *control, size_t *kept)
{
    struct server_smooth_approach *approach = user;
    (void)kept; /* nothing */
    return approach->find(approach, control);
}

enum server_query_turn server_smooth_approach_solve(struct server_query *query,
                                                    struct proto_problem *problem)
{
    struct server_smooth_approach *approach = (struct server_smooth_approach *)query;
    struct server_monitor monitor = server_query_monitor(query, 0, 1);
    enum gd_status status = server_query_call(query, &monitor, find, approach, APPROACH_BYTES);
    if (status) return server_smooth_fail(query, status, &approach->detail, "the search", problem);
    return SERVER_QUERY_DONE;
}
