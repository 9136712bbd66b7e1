/* Pair: distance and path between two points.
 *
 * The metric is symmetric, so a field of either point answers. First lane: such a field is in the cache. Second lane: a worker
 * searches from one point to the other, with the mesh's landmarks where there are some; or, if one of the points is asked about
 * again and again, it builds the field of that point. Who asks while a field of one of his points is being built is parked and
 * looks again when it has landed. */
#include "server/handlers/handlers.h"

#include <stdlib.h>

#include "proto/pair.h"
#include "server/cache.h"
#include "server/field_build.h"
#include "server/handlers/description.h"
#include "server/handlers/request.h"
#include "server/landmarks.h"
#include "server/pair_search.h"
#include "server/reply.h"
#include "server/server.h"

#define INLINE_PATH_FACES   200000 /* tracing a path across a larger mesh may keep an HTTP thread for too long */
#define PATIENCE_NS_AN_EDGE 10000  /* ten times what a field takes: who has less time left has his pair searched */

struct pair {
    struct server_surface *surface;
    struct proto_options options;
    struct proto_located_pair points;
    bool wants_path;
    struct server_flight *flight;  /* this request is to build the field; NULL: it is not */
    const struct gd_point *source; /* of the flight: one of the points */
};

static void free_pair(void *state)
{
    struct pair *pair = state;
    if (pair->flight) server_cache_abandon(pair->flight, true);
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

static void count_failure(struct server_exchange *exchange, enum gd_status status)
{
    if (status == GD_INTERNAL || status == GD_RUNAWAY) server_metrics_count_failed_check(exchange->server->metrics);
}

static void reply_status(struct server_exchange *exchange, enum gd_status status)
{
    struct proto_problem problem;
    count_failure(exchange, status);
    if (status == GD_BUDGET)
        server_budget_refuse(&exchange->server->budget, "the search", 0, &problem);
    else
        proto_problem_from_status(&problem, status, NULL);
    server_reply_problem(exchange, &problem);
}

static void reply_answer(struct server_exchange *exchange, const struct pair *pair, struct gd_pair_answer *answer)
{
    struct proto_writer writer;
    proto_writer_init(&writer, SERVER_REPLY_MOST);
    proto_pair_encode(&writer, &pair->points, answer, &pair->options);
    server_description_tag(exchange, pair->surface->record);
    server_reply_json(exchange, 200, &writer);
    gd_pair_answer_free(answer);
}

static void answer_from(struct server_exchange *exchange, const struct pair *pair, const struct server_cached *cached)
{
    struct gd_pair_answer answer;
    enum gd_status status =
        gd_pair_from_field(cached->field, &pair->points.from, &pair->points.to, pair->wants_path, &answer);
    if (status)
        reply_status(exchange, status);
    else
        reply_answer(exchange, pair, &answer);
}

static bool answer_from_cache(struct server_exchange *exchange, const struct pair *pair)
{
    const struct server_cached *cached = server_cache_find(pair->surface->shelf, &pair->points.from);
    if (!cached) cached = server_cache_find(pair->surface->shelf, &pair->points.to);
    if (!cached) return false;
    answer_from(exchange, pair, cached);
    server_cache_unpin(cached);
    return true;
}

static void search(struct server_exchange *exchange, const struct pair *pair)
{
    struct server *server = exchange->server;
    struct server_landmark_set *set = server_landmarks_find(server->landmarks, pair->surface);
    struct gd_pair_answer answer;
    server_metrics_count_search(server->metrics);
    enum gd_status status = server_pair_search(exchange, pair->points.mesh, &pair->points.from, &pair->points.to,
                                               pair->wants_path, set ? set->landmarks : NULL, &answer);
    server_landmark_set_release(set);
    if (status)
        reply_status(exchange, status);
    else
        reply_answer(exchange, pair, &answer);
}

/* --- the second lane ---------------------------------------------------------------------------------------------- */

/* BUILD: the request has a flight now. WAIT: it is parked, and not the caller's any more. */
static enum server_cache_turn board(struct server_exchange *exchange, struct pair *pair)
{
    struct server_shelf *shelf = pair->surface->shelf;
    uint64_t patience = PATIENCE_NS_AN_EDGE * (uint64_t)gd_mesh_summary(pair->points.mesh)->edges;
    if (exchange->job.deadline_ns < gd_now_ns() + patience) return SERVER_CACHE_SEARCH;
    pair->source = &pair->points.from;
    enum server_cache_turn turn = server_cache_enter(shelf, pair->source, &exchange->job, &pair->flight);
    if (turn != SERVER_CACHE_SEARCH) return turn;
    pair->source = &pair->points.to;
    return server_cache_enter(shelf, pair->source, &exchange->job, &pair->flight);
}

/* Ends a flight whose build failed. Unless it is this request that ended, its pair can still be searched, as can those of the
 * requests that wait. */
static void give_up(struct server_exchange *exchange, const struct pair *pair, struct server_flight *flight,
                    enum gd_status status)
{
    bool has_ended = status == GD_DEADLINE || status == GD_CANCELLED;
    server_cache_abandon(flight, has_ended);
    if (has_ended) {
        reply_status(exchange, status);
        return;
    }
    count_failure(exchange, status);
    search(exchange, pair);
}

/* Builds the field and replies from it. */
static void fly(struct server_exchange *exchange, struct pair *pair)
{
    struct server_flight *flight = pair->flight;
    struct gd_field *field;
    pair->flight = NULL;
    enum gd_status status = server_field_build(exchange, flight, pair->points.mesh, pair->source, &field);
    if (status) {
        give_up(exchange, pair, flight, status);
        return;
    }
    const struct server_cached *landed = server_cache_land(flight, field);
    if (landed)
        answer_from(exchange, pair, landed);
    else
        search(exchange, pair);
    server_cache_unpin(landed);
}

/* One look and, if need be, one search or build. False: parked, then this is called again. */
static bool solve(struct server_exchange *exchange)
{
    struct pair *pair = exchange->state;
    enum server_cache_turn turn = SERVER_CACHE_BUILD;
    if (!pair->flight) {
        if (answer_from_cache(exchange, pair)) return true;
        turn = board(exchange, pair);
    }
    switch (turn) {
    case SERVER_CACHE_WAIT:
        return false;
    case SERVER_CACHE_BUILD:
        fly(exchange, pair);
        break;
    case SERVER_CACHE_SEARCH:
        search(exchange, pair);
        break;
    case SERVER_CACHE_AGAIN:
        break; /* without a reply: the dispatcher calls this again */
    }
    return true;
}

/* A flight begins here, before its builder is queued: so those who come meanwhile take no place in the queue. */
static bool join(struct server_exchange *exchange)
{
    return board(exchange, exchange->state) == SERVER_CACHE_WAIT;
}

/* --- the first lane ----------------------------------------------------------------------------------------------- */

static bool is_quick(const struct pair *pair)
{
    return !pair->wants_path || gd_mesh_summary(pair->points.mesh)->faces <= INLINE_PATH_FACES;
}

static void answer_or_defer(struct server_exchange *exchange, const struct pair *pair)
{
    const struct gd_point *from = &pair->points.from, *to = &pair->points.to;
    if (is_quick(pair) && answer_from_cache(exchange, pair)) return;
    server_cache_note(pair->surface->shelf, from);
    if (!gd_point_equal(from, to)) server_cache_note(pair->surface->shelf, to);
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
