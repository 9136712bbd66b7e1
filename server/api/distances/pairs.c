/* Pairs: answers queries for the distance and the shortest path between two points, optionally via
 * other points. A leg is the part of the path between two consecutive points.
 *
 * DESIGN. The metric is symmetric, so a field of either end answers a leg. try_inline answers from
 * cached fields. A worker searches from one end to the other. If enough queries have named an end,
 * the worker builds the field of this end instead. While another query builds the field of an end,
 * this query is parked. When the build has ended, the query tries the cache again. */
#include "server/query/handlers.h"

#include <math.h>

#include "proto/queries/pair.h"
#include "server/base/thread.h"
#include "server/exchange/metrics.h"
#include "server/fields/cache.h"
#include "server/query/query.h"
#include "server/query/result.h"

/* Limit on the faces of a mesh whose paths an HTTP thread may trace. */
#define INLINE_PATH_FACES 200000
/* Ten times the cost of a field on most meshes. If less time is left until the deadline, the pair
 * is searched. */
#define PATIENCE_NS_AN_EDGE 10000
/* A build that takes more processor time is abandoned, because searches are faster on such meshes.
 * It is also abandoned after half of the time until the deadline. */
#define BUILD_NS         1000000000
#define BUILD_NS_AN_EDGE 5000
#define WHAT             "the search"

struct pair_query {
    struct server_query query; /* must be the first member */
    enum gd_pair_output output;
    uint32_t leg, leg_count; /* the current leg: from point `leg` of the query to the next one */
    bool is_noted;           /* true if the cache has counted this query of the leg's ends */
    struct gd_pair_answer answer; /* joined answer of the legs before the current one */
    struct gd_seed source;        /* source of the field that this query builds */
};

static void pair_release(struct server_query *query)
{
    gd_pair_answer_free(&((struct pair_query *)query)->answer);
}

static bool pair_locate(struct server_query *query, struct proto_points *stops)
{
    struct pair_query *pair = (struct pair_query *)query;
    if (!server_query_locate(query, stops)) return false;
    pair->leg_count = query->points.count - 1;
    pair->output = query->options.fields & PROTO_PATH_FIELD_PATH || query->form >= SERVER_FORM_FIRST
                       ? GD_PAIR_PATH
                       : GD_PAIR_DISTANCE;
    return true;
}

static bool pair_decode(struct server_query *query, const json_t *document)
{
    struct proto_points stops;
    return proto_pair_decode(document, &stops, query->problem) && pair_locate(query, &stops);
}

static bool pair_parse(struct server_query *query, const struct proto_parameters *parameters)
{
    struct proto_points stops;
    return proto_pair_parse(parameters, &stops, query->problem) && pair_locate(query, &stops);
}

/* --- one leg ---------------------------------------------------------------------------------- */

static struct server_pair leg_of(const struct pair_query *pair)
{
    const struct gd_point *from = &pair->query.points.points[pair->leg];
    return (struct server_pair){from, from + 1, pair->output};
}

static struct server_monitor leg_monitor(const struct pair_query *pair)
{
    double share = 1.0 / pair->leg_count;
    return server_query_monitor(&pair->query, pair->leg * share, share);
}

/* Appends and frees the answer of a leg. Returns AGAIN if legs remain. */
static enum server_query_turn leg_end(struct pair_query *pair, enum gd_status status,
                                      struct gd_pair_answer *leg)
{
    if (!status) status = server_pair_append(&pair->answer, leg);
    if (status) return server_query_fail(&pair->query, status, WHAT);
    pair->leg = isinf(pair->answer.distance) ? pair->leg_count : pair->leg + 1;
    pair->is_noted = false;
    return pair->leg == pair->leg_count ? SERVER_QUERY_DONE : SERVER_QUERY_AGAIN;
}

/* Answers the leg from a field, and unpins the field. */
static enum server_query_turn leg_answer(struct pair_query *pair,
                                         const struct server_cached *cached)
{
    const struct server_pair ends = leg_of(pair);
    struct gd_pair_answer leg;
    enum gd_status status =
        gd_pair_from_field(cached->field, ends.from, ends.to, ends.output, &leg);
    server_cache_unpin(cached);
    return leg_end(pair, status, &leg);
}

/* Answers legs from cached fields. Returns AGAIN if a leg remains. */
static enum server_query_turn leg_find(struct pair_query *pair)
{
    enum server_query_turn turn = SERVER_QUERY_AGAIN;
    while (turn == SERVER_QUERY_AGAIN) {
        const struct server_pair ends = leg_of(pair);
        const struct server_cached *cached = server_pair_find_field(pair->query.surface, &ends);
        if (!cached) break;
        turn = leg_answer(pair, cached);
    }
    return turn;
}

static enum server_query_turn leg_search(struct pair_query *pair)
{
    const struct server_pair ends = leg_of(pair);
    struct server_monitor monitor = leg_monitor(pair);
    struct gd_pair_answer leg;
    enum gd_status status = server_pair_search(&monitor, pair->query.surface, &ends, &leg);
    return leg_end(pair, status, &leg);
}

/* --- building a field ------------------------------------------------------------------------- */

/* Counts a query of a leg whose ends have no field, once for each leg. */
static void leg_note(struct pair_query *pair)
{
    struct server_mesh_cache *fields = pair->query.surface->fields;
    const struct server_pair ends = leg_of(pair);
    if (pair->is_noted) return;
    server_cache_note(fields, ends.from);
    if (!gd_point_equal(ends.from, ends.to)) server_cache_note(fields, ends.to);
    pair->is_noted = true;
}

static enum server_cache_turn field_enter(struct pair_query *pair, const struct gd_point *source)
{
    struct server_query *query = &pair->query;
    pair->source.point = *source;
    return server_cache_enter(query->surface->fields, source, &query->exchange->job,
                              &query->field.build);
}

static uint64_t edge_count(const struct pair_query *pair)
{
    return gd_mesh_summary(pair->query.surface->mesh)->edges;
}

/* Enters the cache. After BUILD, this query must build the field. After WAIT, the query is parked,
 * and the caller must not use it any more. */
static enum server_cache_turn leg_enter(struct pair_query *pair)
{
    const struct server_pair ends = leg_of(pair);
    uint64_t patience_ns = PATIENCE_NS_AN_EDGE * edge_count(pair);
    if (pair->query.exchange->job.deadline_ns < gd_now_ns() + patience_ns)
        return SERVER_CACHE_SEARCH;
    enum server_cache_turn turn = field_enter(pair, ends.from);
    return turn == SERVER_CACHE_SEARCH ? field_enter(pair, ends.to) : turn;
}

/* Builds the field. If the build fails but the query may continue, searches the leg instead. */
static enum server_query_turn leg_build(struct pair_query *pair)
{
    struct server_query *query = &pair->query;
    const struct server_cached *cached;
    query->field.request = (struct gd_field_request){.seeds = &pair->source, .seed_count = 1};
    struct server_monitor monitor = leg_monitor(pair);
    monitor.limit_ns = gd_now_ns() / 2 + query->exchange->job.deadline_ns / 2;
    monitor.cpu_limit_ns = server_thread_cpu_ns() + BUILD_NS + BUILD_NS_AN_EDGE * edge_count(pair);
    enum gd_status status = server_query_build_field(query, monitor, &cached);
    if (!status) return leg_answer(pair, cached);
    if (status == GD_DEADLINE || status == GD_CANCELLED)
        return server_query_fail(query, status, WHAT);
    server_metrics_count_status(query->exchange->host->metrics, status);
    return leg_search(pair);
}

/* --- the steps -------------------------------------------------------------------------------- */

static enum server_query_turn pair_try_inline(struct server_query *query)
{
    struct pair_query *pair = (struct pair_query *)query;
    uint64_t faces = gd_mesh_summary(pair->query.surface->mesh)->faces;
    bool is_quick = !pair->output || faces * pair->leg_count <= INLINE_PATH_FACES;
    enum server_query_turn turn = is_quick ? leg_find(pair) : SERVER_QUERY_AGAIN;
    if (turn == SERVER_QUERY_AGAIN) leg_note(pair);
    return turn;
}

/* Begins the build before its query is queued, so that later queries for the same field are parked
 * instead of queued. */
static bool pair_join(struct server_query *query)
{
    return leg_enter((struct pair_query *)query) == SERVER_CACHE_WAIT;
}

/* Tries the cache, then runs at most one search or build. */
static enum server_query_turn pair_solve(struct server_query *query)
{
    struct pair_query *pair = (struct pair_query *)query;
    if (query->field.build) return leg_build(pair);
    enum server_query_turn turn = leg_find(pair);
    if (turn != SERVER_QUERY_AGAIN) return turn;
    leg_note(pair);
    switch (leg_enter(pair)) {
    case SERVER_CACHE_WAIT:
        return SERVER_QUERY_PARKED;
    case SERVER_CACHE_BUILD:
        return leg_build(pair);
    case SERVER_CACHE_AGAIN:
        return SERVER_QUERY_AGAIN;
    case SERVER_CACHE_SEARCH:
        break;
    }
    return leg_search(pair);
}

static void pair_encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct pair_query *pair = (const struct pair_query *)query;
    proto_pair_encode(writer, &query->points, &pair->answer, &query->options);
}

static bool path_write(struct server_query *query, struct server_answer_file *out)
{
    const struct gd_pair_answer *answer = &((const struct pair_query *)query)->answer;
    if (isinf(answer->distance))
        return server_result_refuse_nothing(query->problem, "there is no path between the points");
    if (query->form < SERVER_RESULT_LINE_FORMS_END) return server_result_write_listed(query, out);
    return server_result_write_strip(query, &answer->path, out);
}

/* Lists the arrays, without a line if there is no path. */
static bool path_list_arrays(struct server_query *query)
{
    const struct gd_pair_answer *answer = &((const struct pair_query *)query)->answer;
    const struct gd_point *points = isfinite(answer->distance) ? answer->path.points : NULL;
    if (!server_query_list_line(query, points, answer->path.count)) return false;
    server_arrays_add_numbers(&query->arrays, "distance", 0, 1, &answer->distance);
    return true;
}

static const struct server_form path_forms[] = {
    SERVER_RESULT_LINE_FORMS, {"svg", "image/svg+xml", false}, {NULL, NULL, false}};

#define PAIR_STEPS                                                                                 \
    .size = sizeof(struct pair_query), .decode = pair_decode, .parse = pair_parse,                 \
    .try_inline = pair_try_inline, .join = pair_join, .solve = pair_solve, .encode = pair_encode,  \
    .release = pair_release

const struct server_query_kind server_query_distance = {.name = "distance", PAIR_STEPS};
const struct server_query_kind server_query_path = {.name = "path",
                                                    .forms = path_forms,
                                                    .write = path_write,
                                                    .list_arrays = path_list_arrays,
                                                    PAIR_STEPS};
