/* Pair: distance and path between two points, leg by leg where it is by way of others.
 *
 * The metric is symmetric, so a field of either end of a leg answers. First lane: such a field is
 * in the cache. Second lane: a worker searches from one end to the other, with the mesh's landmarks
 * where there are some; or, if one of the ends is asked about again and again, it builds the field
 * of that point. Who asks while a field of one of his points is being built is parked and looks
 * again when it has landed. */
#include "server/query/handlers.h"

#include <math.h>
#include <stdlib.h>

#include "proto/pair.h"
#include "server/fields/cache.h"
#include "server/query/field_build.h"
#include "server/query/query.h"
#include "server/query/result.h"
#include "server/surfaces/landmarks.h"
#include "server/query/pair_search.h"
#include "server/query/api.h"

/* tracing a path across a larger mesh may keep an HTTP thread for too long */
#define INLINE_PATH_FACES 200000
/* ten times what a field takes: who has less time left has his pair searched */
#define PATIENCE_NS_AN_EDGE 10000
#define WHAT                "the search"

struct pair {
    struct server_query query; /* first */
    struct proto_located_points stops;
    bool wants_path;
    /* the one in work, from that stop to the next; all are done at the last stop */
    uint32_t leg;
    bool is_noted;                      /* its ends are counted as asked about */
    struct gd_pair_answer answer;       /* of the legs before it */
    struct server_pending_build *build; /* this request is to build the field; NULL: it is not */
    const struct gd_point *source;      /* of the pending build: one of the leg's ends */
};

static void release(struct server_query *query)
{
    struct pair *pair = (struct pair *)query;
    if (pair->build) server_cache_fail(pair->build, GD_CANCELLED);
    gd_pair_answer_free(&pair->answer);
    proto_located_points_free(&pair->stops);
}

/* --- the question ----------------------------------------------------------------------------- */

static bool locate(struct server_query *query, struct proto_points *stops,
                   struct proto_problem *problem)
{
    struct pair *pair = (struct pair *)query;
    bool ok = proto_points_locate(query->surface->mesh, stops, &pair->stops, problem);
    proto_points_free(stops);
    pair->wants_path =
        query->options.fields & PROTO_PAIR_FIELD_PATH || query->form >= SERVER_FORM_FIRST;
    return ok;
}

static bool decode(struct server_query *query, const json_t *document,
                   struct proto_problem *problem)
{
    struct proto_points stops;
    return proto_pair_decode(document, &stops, problem) && locate(query, &stops, problem);
}

static bool parse(struct server_query *query, const struct proto_parameters *parameters,
                  struct proto_problem *problem)
{
    struct proto_points stops;
    return proto_pair_parse(parameters, &stops, problem) && locate(query, &stops, problem);
}

/* --- legs ------------------------------------------------------------------------------------- */

static const struct gd_point *from_of(const struct pair *pair)
{
    return &pair->stops.points[pair->leg];
}

static const struct gd_point *to_of(const struct pair *pair)
{
    return &pair->stops.points[pair->leg + 1];
}

static uint32_t leg_count(const struct pair *pair)
{
    return pair->stops.count - 1;
}

/* Ends a leg with its answer, which is used up, or with a failure. AGAIN: there are legs left. */
static enum server_query_turn end_leg(struct pair *pair, enum gd_status status,
                                      struct gd_pair_answer *leg, struct proto_problem *problem)
{
    if (!status) status = server_pair_append(&pair->answer, leg);
    if (status) return server_query_fail(&pair->query, status, WHAT, problem);
    pair->leg = isinf(pair->answer.distance) ? leg_count(pair) : pair->leg + 1;
    pair->is_noted = false;
    return pair->leg == leg_count(pair) ? SERVER_QUERY_DONE : SERVER_QUERY_AGAIN;
}

static enum server_query_turn end_leg_by(struct pair *pair, const struct server_cached *cached,
                                         struct proto_problem *problem)
{
    struct gd_pair_answer leg;
    enum gd_status status =
        gd_pair_from_field(cached->field, from_of(pair), to_of(pair), pair->wants_path, &leg);
    return end_leg(pair, status, &leg, problem);
}

/* Ends the legs, one after the other, that cached fields answer. AGAIN: one is left. */
static enum server_query_turn look(struct pair *pair, struct proto_problem *problem)
{
    enum server_query_turn turn = SERVER_QUERY_AGAIN;
    while (turn == SERVER_QUERY_AGAIN) {
        const struct server_cached *cached =
            server_cache_find(pair->query.surface->fields, from_of(pair));
        if (!cached) cached = server_cache_find(pair->query.surface->fields, to_of(pair));
        if (!cached) break;
        turn = end_leg_by(pair, cached, problem);
        server_cache_unpin(cached);
    }
    return turn;
}

static struct server_monitor monitor_of(const struct pair *pair)
{
    double share = 1.0 / leg_count(pair);
    return server_query_monitor(&pair->query, pair->leg * share, share);
}

static enum server_query_turn search(struct pair *pair, struct proto_problem *problem)
{
    const struct server_api *api = pair->query.exchange->host->api;
    struct server_landmark_set *set = server_landmarks_find(api->landmarks, pair->query.surface);
    struct server_monitor monitor = monitor_of(pair);
    struct gd_pair_answer leg;
    enum gd_status status =
        server_pair_search(&monitor, pair->stops.mesh, from_of(pair), to_of(pair), pair->wants_path,
                           set ? set->landmarks : NULL, &leg);
    server_landmark_set_release(set);
    return end_leg(pair, status, &leg, problem);
}

/* --- the second lane -------------------------------------------------------------------------- */

/* Counts, once, that the leg's ends are asked about and have no field. */
static void note(struct pair *pair)
{
    struct server_mesh_cache *fields = pair->query.surface->fields;
    if (pair->is_noted) return;
    server_cache_note(fields, from_of(pair));
    if (!gd_point_equal(from_of(pair), to_of(pair))) server_cache_note(fields, to_of(pair));
    pair->is_noted = true;
}

/* BUILD: the request has a pending build now. WAIT: it is parked, and not the caller's any more. */
static enum server_cache_turn board(struct pair *pair)
{
    struct server_job *job = &pair->query.exchange->job;
    struct server_mesh_cache *fields = pair->query.surface->fields;
    uint64_t patience = PATIENCE_NS_AN_EDGE * (uint64_t)gd_mesh_summary(pair->stops.mesh)->edges;
    if (job->deadline_ns < gd_now_ns() + patience) return SERVER_CACHE_SEARCH;
    pair->source = from_of(pair);
    enum server_cache_turn turn = server_cache_enter(fields, pair->source, job, &pair->build);
    if (turn != SERVER_CACHE_SEARCH) return turn;
    pair->source = to_of(pair);
    return server_cache_enter(fields, pair->source, job, &pair->build);
}

/* Ends a pending build whose build failed. Unless it is this request that ended, its leg can still
 * be searched, as can those of the requests that wait. */
static enum server_query_turn give_up(struct pair *pair, struct server_pending_build *build,
                                      enum gd_status status, struct proto_problem *problem)
{
    server_cache_fail(build, status);
    if (status == GD_DEADLINE || status == GD_CANCELLED)
        return server_query_fail(&pair->query, status, WHAT, problem);
    server_query_count(&pair->query, status);
    return search(pair, problem);
}

/* Builds the field and answers from it. */
static enum server_query_turn fly(struct pair *pair, struct proto_problem *problem)
{
    struct server_pending_build *build = pair->build;
    const struct gd_seed seed = {.point = *pair->source};
    const struct gd_field_request request = {.seeds = &seed, .seed_count = 1};
    struct server_monitor monitor = monitor_of(pair);
    struct gd_field *field;
    monitor.build = build;
    monitor.is_awaited = server_cache_is_awaited;
    pair->build = NULL;
    enum gd_status status =
        server_field_build_request(&monitor, pair->stops.mesh, &request, &field);
    if (status) return give_up(pair, build, status, problem);
    const struct server_cached *published = server_cache_publish(build, field);
    enum server_query_turn turn =
        published ? end_leg_by(pair, published, problem) : search(pair, problem);
    server_cache_unpin(published);
    return turn;
}

/* One look and, if need be, one search or build. */
static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct pair *pair = (struct pair *)query;
    if (pair->build) return fly(pair, problem);
    enum server_query_turn turn = look(pair, problem);
    if (turn != SERVER_QUERY_AGAIN) return turn;
    note(pair);
    switch (board(pair)) {
    case SERVER_CACHE_WAIT:
        return SERVER_QUERY_PARKED;
    case SERVER_CACHE_BUILD:
        return fly(pair, problem);
    case SERVER_CACHE_AGAIN:
        return SERVER_QUERY_AGAIN;
    case SERVER_CACHE_SEARCH:
        break;
    }
    return search(pair, problem);
}

/* A pending build begins here, before its builder is queued: so those who come meanwhile take no
 * place in the queue. */
static bool join(struct server_query *query)
{
    return board((struct pair *)query) == SERVER_CACHE_WAIT;
}

/* --- the first lane --------------------------------------------------------------------------- */

static bool is_quick(const struct pair *pair)
{
    uint64_t faces = gd_mesh_summary(pair->stops.mesh)->faces;
    return !pair->wants_path || faces * leg_count(pair) <= INLINE_PATH_FACES;
}

static enum server_query_turn glance(struct server_query *query, struct proto_problem *problem)
{
    struct pair *pair = (struct pair *)query;
    enum server_query_turn turn = is_quick(pair) ? look(pair, problem) : SERVER_QUERY_AGAIN;
    if (turn == SERVER_QUERY_AGAIN) note(pair);
    return turn;
}

/* --- the answer ------------------------------------------------------------------------------- */

static void encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct pair *pair = (const struct pair *)query;
    proto_pair_encode(writer, &pair->stops, &pair->answer, &query->options);
}

static const struct server_form path_forms[] = {
    SERVER_RESULT_LINE_FORMS, {"svg", "image/svg+xml", false}, {NULL, NULL, false}};

static bool write_path(const struct server_query *query, char **bytes, size_t *size,
                       struct proto_problem *problem)
{
    const struct gd_pair_answer *answer = &((const struct pair *)query)->answer;
    if (isinf(answer->distance))
        return server_result_refuse_nothing(problem, "there is no path between the points");
    const struct server_result_lines line = {.paths = &answer->path, .count = 1};
    if (query->form < SERVER_RESULT_LINE_FORMS_END)
        return server_result_write_lines(query, &line, bytes, size, problem);
    return server_result_write_strip(query, &answer->path, bytes, size, problem);
}

#define PAIR_STEPS                                                                                 \
    .size = sizeof(struct pair), .parameters = proto_pair_parameters, .decode = decode,            \
    .parse = parse, .glance = glance, .join = join, .solve = solve, .encode = encode,              \
    .release = release

const struct server_query_kind server_query_distance = {
    .name = "distance", .fields = proto_distance_fields, PAIR_STEPS};
const struct server_query_kind server_query_path = {.name = "path",
                                                    .fields = proto_path_fields,
                                                    .forms = path_forms,
                                                    .write = write_path,
                                                    PAIR_STEPS};

void server_handle_distance(struct server_exchange *exchange)
{
    server_query_handle(exchange, &server_query_distance);
}

void server_handle_path(struct server_exchange *exchange)
{
    server_query_handle(exchange, &server_query_path);
}
