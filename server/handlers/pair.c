/* Pair: distance and path between two points.
 *
 * The metric is symmetric, so a field of either point answers, if it reaches as far as the other. First lane: such
 * a field is in the cache. Second lane: a worker builds one, of `from`: only as far as `to` when it is the first
 * question about that source, the whole of it when a field of that source is there but does not reach. Who asks
 * for a field that is being built is parked and looks again when it has landed. */
#include "server/handlers/handlers.h"

#include <stdlib.h>

#include "proto/pair.h"
#include "server/cache.h"
#include "server/field_build.h"
#include "server/handlers/description.h"
#include "server/handlers/request.h"
#include "server/reply.h"
#include "server/server.h"

#define INLINE_PATH_FACES 200000 /* tracing a path across a larger mesh may keep an HTTP thread for too long */

struct pair {
    struct server_surface *surface;
    struct proto_options options;
    struct proto_located_pair points;
    bool wants_path;
    bool wants_all; /* a field that was built as far as `to` did not answer */
};

static void free_pair(void *state)
{
    struct pair *pair = state;
    server_surface_release(pair->surface);
    free(pair);
}

/* --- the question ------------------------------------------------------------------------------------------------- */

static bool read_points(struct server_exchange *exchange, struct proto_parameters *parameters,
                        struct proto_pair *points, struct proto_problem *problem)
{
    if (!exchange->match.route->has_body) return proto_pair_parse(parameters, points, problem);
    json_t *document = server_request_document(exchange, problem);
    if (!document) return false;
    bool ok = proto_pair_decode(document, points, problem);
    json_decref(document);
    return ok;
}

static bool read_pair(struct server_exchange *exchange, const char *const *fields, struct pair *pair,
                      struct proto_problem *problem)
{
    struct proto_parameters parameters = server_exchange_parameters(exchange);
    const char *const *names = exchange->match.route->has_body ? NULL : proto_pair_parameters;
    struct proto_pair points;
    if (!proto_options_parse(&parameters, fields, names, &pair->options, problem)) return false;
    if (!read_points(exchange, &parameters, &points, problem)) return false;
    if (!proto_pair_locate(pair->surface->mesh, &points, &pair->points, problem)) return false;
    pair->wants_path = pair->options.fields & PROTO_PAIR_FIELD_PATH;
    return true;
}

/* --- the answer --------------------------------------------------------------------------------------------------- */

static void reply_status(struct server_exchange *exchange, enum gd_status status)
{
    struct proto_problem problem;
    if (status == GD_INTERNAL || status == GD_RUNAWAY) server_metrics_count_failed_check(exchange->server->metrics);
    if (status == GD_BUDGET)
        server_budget_refuse(&exchange->server->budget, "the field", 0, &problem);
    else
        proto_problem_from_status(&problem, status, NULL);
    server_reply_problem(exchange, &problem);
}

static void reply_answer(struct server_exchange *exchange, const struct pair *pair, const struct gd_pair_answer *answer)
{
    struct proto_writer writer;
    proto_writer_init(&writer, SERVER_REPLY_MOST);
    proto_pair_encode(&writer, &pair->points, answer, &pair->options);
    server_description_tag(exchange, pair->surface->record);
    server_reply_json(exchange, 200, &writer);
}

/* Replies from a field; false when there is none or it does not reach. */
static bool answer_from(struct server_exchange *exchange, const struct pair *pair, const struct server_cached *cached)
{
    struct gd_pair_answer answer;
    if (!cached) return false;
    enum gd_status status =
        gd_pair_from_field(cached->field, &pair->points.from, &pair->points.to, pair->wants_path, &answer);
    if (status == GD_BEYOND_REACH) return false;
    if (status) {
        reply_status(exchange, status);
        return true;
    }
    reply_answer(exchange, pair, &answer);
    gd_pair_answer_free(&answer);
    return true;
}

/* Replies from a cached field; else false, with the field of `from` pinned (or NULL) in `*seen`. */
static bool answer_from_cache(struct server_exchange *exchange, const struct pair *pair,
                              const struct server_cached **seen)
{
    *seen = server_cache_find(pair->surface->shelf, &pair->points.from);
    if (answer_from(exchange, pair, *seen)) {
        server_cache_unpin(*seen);
        return true;
    }
    const struct server_cached *other = server_cache_find(pair->surface->shelf, &pair->points.to);
    bool answered = answer_from(exchange, pair, other);
    server_cache_unpin(other);
    if (answered) server_cache_unpin(*seen);
    return answered;
}

/* --- the second lane ---------------------------------------------------------------------------------------------- */

/* Ends a flight whose build failed, and replies. Who waits for it may still succeed, unless it would fail in the
 * same way. */
static void crash(struct server_exchange *exchange, struct server_flight *flight, enum gd_status status)
{
    if (status == GD_BUDGET || status == GD_NO_MEMORY)
        server_cache_fail(flight, SERVER_REFUSAL_MEMORY);
    else if (status == GD_INTERNAL)
        server_cache_fail(flight, SERVER_REFUSAL_INTERNAL);
    else if (status == GD_RUNAWAY)
        server_cache_fail(flight, SERVER_REFUSAL_RUNAWAY);
    else
        server_cache_abandon(flight);
    reply_status(exchange, status);
}

/* Builds the field and replies from it; without a reply it is to be tried again. */
static void fly(struct server_exchange *exchange, struct pair *pair, struct server_flight *flight, bool whole)
{
    struct gd_field *field;
    enum gd_status status = server_field_build(exchange, flight, pair->points.mesh, &pair->points.from,
                                               whole ? NULL : &pair->points.to, &field);
    if (status) {
        crash(exchange, flight, status);
        return;
    }
    const struct server_cached *landed = server_cache_land(flight, field);
    if (!landed)
        reply_status(exchange, GD_NO_MEMORY);
    else if (!answer_from(exchange, pair, landed))
        pair->wants_all = true;
    server_cache_unpin(landed);
}

/* One look and, if need be, one build. False: parked, then this is called again. */
static bool solve(struct server_exchange *exchange)
{
    struct pair *pair = exchange->state;
    const struct server_cached *seen;
    struct server_flight *flight;
    if (answer_from_cache(exchange, pair, &seen)) return true;
    enum server_cache_turn turn =
        server_cache_enter(pair->surface->shelf, &pair->points.from, seen, &exchange->job, &flight);
    bool whole = seen != NULL;
    server_cache_unpin(seen);
    switch (turn) {
    case SERVER_CACHE_WAIT:
        return false;
    case SERVER_CACHE_BUILD:
        fly(exchange, pair, flight, whole || pair->wants_all);
        break;
    case SERVER_CACHE_NO_MEMORY:
        reply_status(exchange, GD_NO_MEMORY);
        break;
    case SERVER_CACHE_AGAIN:
        break; /* without a reply: the dispatcher calls this again */
    }
    return true;
}

static bool join(struct server_exchange *exchange)
{
    const struct pair *pair = exchange->state;
    return server_cache_join(pair->surface->shelf, &pair->points.from, &exchange->job);
}

/* --- the first lane ----------------------------------------------------------------------------------------------- */

static bool is_quick(const struct pair *pair)
{
    return !pair->wants_path || gd_mesh_summary(pair->points.mesh)->faces <= INLINE_PATH_FACES;
}

static void answer_or_defer(struct server_exchange *exchange, const struct pair *pair)
{
    const struct server_cached *seen = NULL;
    if (is_quick(pair) && answer_from_cache(exchange, pair, &seen)) return;
    server_cache_unpin(seen);
    server_exchange_defer(exchange, solve, join);
}

static void handle_pair(struct server_exchange *exchange, const char *const *fields)
{
    struct proto_problem problem;
    if (!server_reply_accepts_json(exchange)) return;
    struct server_surface *surface = server_request_surface(exchange);
    if (!surface) return;
    struct pair *pair = calloc(1, sizeof *pair);
    if (!pair) {
        server_surface_release(surface);
        reply_status(exchange, GD_NO_MEMORY);
        return;
    }
    pair->surface = surface;
    server_exchange_keep(exchange, pair, free_pair);
    if (!read_pair(exchange, fields, pair, &problem)) {
        server_reply_problem(exchange, &problem);
        return;
    }
    server_exchange_shorten(exchange, pair->options.timeout_ms);
    answer_or_defer(exchange, pair);
}

void server_handle_distance(struct server_exchange *exchange)
{
    handle_pair(exchange, proto_distance_fields);
}

void server_handle_path(struct server_exchange *exchange)
{
    handle_pair(exchange, proto_path_fields);
}
