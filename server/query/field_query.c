/* Queries that are answered from the field of a set. */
#include "server/query/query.h"

#include <stdlib.h>
#include <string.h>

#include "server/base/thread.h"
#include "server/fields/cache.h"
#include "server/query/api.h"
#include "server/work/executor.h"

#define WHAT        "the field"
#define SET_SHARE   0.2 /* fraction of the progress for locating the set, if that takes time */
#define BUILD_SHARE 0.9 /* fraction of the progress for building the field, if it is not cached */

#define BYTES_A_CALL ((size_t)1 << 20) /* additional bytes, independent of the mesh's size */
/* bytes for each edge while a field is built: the finished field has 50 to 700 on most meshes, and
   its workspace 100 */
#define BYTES_AN_EDGE        1024
#define SET_BYTES_AN_EDGE    224 /* the same as for a search (query.c) */
#define RECORD_BYTES_AN_EDGE 96  /* the records of a propagation, without wedges */

/* --- locating the set ------------------------------------------------------------------------- */

bool server_query_locate_set(struct server_query *query, struct server_monitor *part,
                             const struct proto_set *set, struct proto_located_set **out)
{
    const struct gd_mesh *mesh = query->surface->mesh;
    struct server_budgeted_call call = server_query_begin_call(
        query, part, BYTES_A_CALL + gd_mesh_summary(mesh)->edges * (size_t)SET_BYTES_AN_EDGE);
    while (server_budgeted_call_next(&call)) {
        call.status = proto_set_locate(mesh, set, &call.control, out, query->problem);
        if (!call.status) call.kept = (*out)->bytes;
    }
    if (call.status == GD_BUDGET) server_query_fail(query, call.status, "the set");
    return !call.status;
}

static struct gd_field_request request_of(const struct proto_located_set *set, double max_distance)
{
    return (struct gd_field_request){
        .seeds = set->seeds, .seed_count = set->seed_count, .radius = max_distance};
}

void server_field_query_of_located(struct server_query *query, const struct proto_located_set *set,
                                   double max_distance)
{
    query->field.set = set;
    query->field.request = request_of(set, max_distance);
}

static bool set_end(struct server_query *query, struct proto_located_set *located)
{
    query->field.own_set = located;
    proto_set_free(&query->field.pending);
    server_field_query_of_located(query, located, query->field.max_distance);
    return !query->kind->located || query->kind->located(query);
}

bool server_field_query_of_set(struct server_query *query, struct proto_set *set,
                               double max_distance)
{
    struct proto_located_set *located;
    query->field.pending = *set;
    query->field.max_distance = max_distance;
    *set = (struct proto_set){0};
    if (!proto_set_is_quick(&query->field.pending)) return true;
    return !proto_set_locate(query->surface->mesh, &query->field.pending, NULL, &located,
                             query->problem) &&
           set_end(query, located);
}

static bool set_prepare(struct server_query *query)
{
    struct server_monitor part = server_query_monitor(query, 0, SET_SHARE);
    struct proto_located_set *located;
    if (query->kind->prepare) return query->kind->prepare(query);
    return server_query_locate_set(query, &part, &query->field.pending, &located) &&
           set_end(query, located);
}

/* --- field resources -------------------------------------------------------------------------- */

static struct server_resource *resource_find(struct server_record *record, const char *text,
                                             size_t length, struct proto_problem *problem)
{
    struct server_catalogue *catalogue = server_record_catalogue(record);
    struct server_resource *resource = NULL;
    enum server_catalogue_finding finding = SERVER_CATALOGUE_ABSENT;
    char id[PROTO_FIELD_ID + 1] = "";
    if (catalogue && length == PROTO_FIELD_ID) {
        memcpy(id, text, length);
        finding = server_catalogue_find(catalogue, id, &resource);
    }
    if (finding == SERVER_CATALOGUE_ABSENT)
        proto_problem_set(problem, PROTO_PROBLEM_NOT_FOUND,
                          "this mesh has no field of that id; post its set to get one");
    if (finding == SERVER_CATALOGUE_FORGOT)
        proto_problem_set(
            problem, PROTO_PROBLEM_FIELD_EVICTED,
            "the field was evicted and its set is no longer known; post the set again");
    return resource;
}

struct server_resource *server_find_resource(const struct server_exchange *exchange,
                                             struct server_record *record,
                                             struct proto_problem *problem)
{
    const struct proto_capture *capture = &exchange->match.captures[1];
    return resource_find(record, capture->text, capture->length, problem);
}

static bool resource_use(struct server_query *query, struct server_resource *resource)
{
    query->field.resource = resource;
    if (!resource) return false;
    query->field.set = resource->set;
    query->field.request = server_resource_request(resource);
    return true;
}

bool server_field_query_of_resource(struct server_query *query)
{
    return resource_use(
        query, server_find_resource(query->exchange, query->surface->record, query->problem));
}

bool server_field_query_of_id(struct server_query *query, const char *id)
{
    return resource_use(query,
                        resource_find(query->surface->record, id, strlen(id), query->problem)) ||
           proto_problem_at(query->problem, "field");
}

/* --- building --------------------------------------------------------------------------------- */

size_t server_field_build_grant(const struct gd_mesh *mesh)
{
    return BYTES_A_CALL + (size_t)gd_mesh_summary(mesh)->edges * BYTES_AN_EDGE;
}

size_t server_distances_only_grant(const struct gd_mesh *mesh)
{
    return BYTES_A_CALL + (size_t)gd_mesh_summary(mesh)->edges * RECORD_BYTES_AN_EDGE;
}

/* One build that a query must do. */
struct build {
    struct server_query *query;
    struct gd_field_request request;
    struct server_pending_build *pending;
    struct server_monitor part;
    /* true if another build of the query runs at the same time: the query repeats this build alone
       if memory is short, so such a shortage fails no other query */
    bool has_twin;
    /* the results: a pinned field, or NULL and the reason */
    const struct server_cached *cached;
    enum gd_status status;
};

/* Builds the field and counts its propagated windows. */
static enum gd_status field_make(struct build *build, struct gd_field **out)
{
    struct server_host *host = build->query->exchange->host;
    const struct gd_mesh *mesh = build->query->surface->mesh;
    struct server_budgeted_call call = {.workspaces = host->workspaces,
                                        .control = server_exchange_control(&build->part),
                                        .grant = server_field_build_grant(mesh)};
    while (server_budgeted_call_next(&call)) {
        call.status = gd_field_build(mesh, &build->request, &call.control, out, NULL);
        if (!call.status) call.kept = gd_field_memsize(*out);
    }
    if (call.status) return call.status;
    server_metrics_count_windows(host->metrics, gd_field_statistics(*out)->windows_propagated);
    return GD_OK;
}

static bool is_shortage(enum gd_status status)
{
    return status == GD_BUDGET || status == GD_NO_MEMORY;
}

/* Builds the field and ends the pending build. */
static void build_run(struct build *build)
{
    const struct server_exchange *exchange = build->query->exchange;
    struct gd_field *field;
    build->part.build = build->pending;
    build->part.is_awaited = server_cache_is_awaited;
    enum gd_status status = field_make(build, &field);
    bool is_early = status == GD_DEADLINE && gd_now_ns() < exchange->job.deadline_ns;
    if (build->part.is_over_limit || is_early) {
        server_cache_abandon(build->pending);
        status = GD_BUDGET;
    } else if (status) {
        server_cache_fail(build->pending,
                          build->has_twin && is_shortage(status) ? GD_CANCELLED : status);
    } else {
        build->cached = server_cache_publish(build->pending, field);
        if (!build->cached) status = GD_NO_MEMORY;
    }
    build->status = status;
    if (exchange->host->spare) server_thread_wake(exchange->host->spare);
}

enum gd_status server_query_build_field(struct server_query *query, struct server_monitor part,
                                        const struct server_cached **out)
{
    struct build build = {.query = query,
                          .request = query->field.request,
                          .pending = query->field.build,
                          .part = part};
    query->field.build = NULL;
    build_run(&build);
    *out = build.cached;
    return build.status;
}

/* --- the steps -------------------------------------------------------------------------------- */

/* Answers from a field and unpins the field. The field may reach farther than the query allows; the
 * answer must not show that. `begun` is the completed fraction of the query's progress. */
static enum server_query_turn field_answer(struct server_query *query,
                                           const struct server_cached *cached, double begun)
{
    double radius = query->field.request.radius;
    struct gd_field *within = NULL;
    server_query_pass(query, begun);
    enum gd_status status = radius > 0 ? gd_field_within(cached->field, radius, &within) : GD_OK;
    enum server_query_turn turn = status
                                      ? server_query_fail(query, status, WHAT)
                                      : query->kind->answer(query, within ? within : cached->field);
    gd_field_release(within);
    server_cache_unpin(cached);
    return turn;
}

/* Finds the field in the cache, unless it is pinned already. */
static bool field_pin(struct server_query *query)
{
    struct server_field_query *field = &query->field;
    if (!field->pin) field->pin = server_cache_find_field(query->surface->fields, &field->request);
    return field->pin;
}

static enum server_query_turn field_answer_by_pin(struct server_query *query)
{
    const struct server_cached *pin = query->field.pin;
    query->field.pin = NULL;
    return field_answer(query, pin, 0);
}

/* Claims the build of the field that the query names next, unless the field exists or another
 * request builds it. */
static bool next_claim(struct server_query *query, struct build *out)
{
    const struct proto_located_set *set = query->field.next;
    enum gd_status why;
    if (!set) return false;
    *out = (struct build){.query = query, .request = request_of(set, 0)};
    return server_cache_claim(query->surface->fields, &out->request, NULL, &out->pending, &why) ==
           SERVER_CACHE_BUILD;
}

/* Runs a build of field_build. The second field stays in the cache without a pin. */
static void build_task(void *user, uint32_t number)
{
    struct build *build = (struct build *)user + number;
    build_run(build);
    if (number > 0) server_cache_unpin(build->cached);
}

static enum server_query_turn field_build(struct server_query *query)
{
    const struct server_exchange *exchange = query->exchange;
    struct build builds[2] = {
        {.query = query, .request = query->field.request, .pending = query->field.build}};
    uint32_t count = 1 + next_claim(query, &builds[1]);
    double share = BUILD_SHARE / count;
    query->field.build = NULL;
    for (uint32_t i = 0; i < count; i++) {
        builds[i].part = server_query_monitor(query, i * share, share);
        builds[i].has_twin = count > 1;
    }
    const struct gd_executor *executor =
        server_executor_start(exchange->host->workers, count, exchange->job.deadline_ns);
    gd_executor_run(executor, build_task, builds, count);
    server_executor_stop(executor);
    query->field.next = NULL;
    if (builds[0].has_twin && is_shortage(builds[0].status)) return SERVER_QUERY_AGAIN;
    return builds[0].status ? server_query_fail(query, builds[0].status, WHAT)
                            : field_answer(query, builds[0].cached, BUILD_SHARE);
}

static enum server_cache_turn field_claim(struct server_query *query, enum gd_status *why)
{
    return server_cache_claim(query->surface->fields, &query->field.request, &query->exchange->job,
                              &query->field.build, why);
}

enum server_query_turn server_field_query_try_inline(struct server_query *query)
{
    return query->field.set && field_pin(query) && query->field.is_quick
               ? field_answer_by_pin(query)
               : SERVER_QUERY_AGAIN;
}

/* Begins a pending build before its builder is queued, so that later queries for the same field are
 * parked instead of queued. */
bool server_field_query_join(struct server_query *query)
{
    enum gd_status why;
    return query->field.set && !query->field.pin && field_claim(query, &why) == SERVER_CACHE_WAIT;
}

enum server_query_turn server_field_query_solve(struct server_query *query)
{
    enum gd_status why;
    if (!query->field.set && !set_prepare(query)) return SERVER_QUERY_FAILED;
    if (query->field.build) return field_build(query);
    if (field_pin(query)) return field_answer_by_pin(query);
    switch (field_claim(query, &why)) {
    case SERVER_CACHE_WAIT:
        return SERVER_QUERY_PARKED;
    case SERVER_CACHE_BUILD:
        return field_build(query);
    case SERVER_CACHE_SEARCH:
        return server_query_fail(query, why, WHAT);
    case SERVER_CACHE_AGAIN:
        break;
    }
    return SERVER_QUERY_AGAIN;
}

void server_field_query_release(struct server_query *query)
{
    struct server_field_query *field = &query->field;
    if (field->build) server_cache_fail(field->build, GD_CANCELLED);
    server_cache_unpin(field->pin);
    server_resource_release(field->resource);
    proto_set_free(&field->pending);
    free(field->own_set);
}
