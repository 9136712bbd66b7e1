/* See field_query.h. */
#include "server/query/field_query.h"

#include <stdlib.h>
#include <string.h>

#include "server/fields/cache.h"
#include "server/query/field_build.h"
#include "server/query/set_resolve.h"

#define WHAT        "the field"
#define SET_SHARE   0.2 /* of the work, when the set is to be put on the mesh, */
#define BUILD_SHARE 0.9 /* and when the field is not there */

/* --- which field ------------------------------------------------------------------------------ */

void server_field_query_of_located(struct server_field_query *query,
                                   const struct proto_located_set *set, double max_distance)
{
    query->set = set;
    query->request = (struct gd_field_request){
        .seeds = set->seeds, .seed_count = set->seed_count, .radius = max_distance};
}

/* The pending set is on the mesh. */
static bool take(struct server_field_query *query, struct proto_located_set *located,
                 struct proto_problem *problem)
{
    query->own_set = located;
    proto_set_free(&query->pending);
    server_field_query_of_located(query, located, query->max_distance);
    return !query->located || query->located(query, problem);
}

bool server_field_query_of_set(struct server_field_query *query, struct proto_set *set,
                               double max_distance, struct proto_problem *problem)
{
    struct proto_located_set *located;
    query->pending = *set;
    query->max_distance = max_distance;
    *set = (struct proto_set){0};
    if (!proto_set_is_quick(&query->pending)) return true;
    if (proto_set_locate(query->query.surface->mesh, &query->pending, NULL, NULL, &located,
                         problem))
        return false;
    return take(query, located, problem);
}

static bool resolve(struct server_field_query *query, struct proto_problem *problem)
{
    struct server_monitor part = server_query_monitor(&query->query, 0, SET_SHARE);
    struct proto_located_set *located;
    if (!server_set_resolve(&query->query, &part, &query->pending, &located, problem)) return false;
    return take(query, located, problem);
}

static struct server_resource *find_resource(struct server_record *record, const char *text,
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
    return find_resource(record, capture->text, capture->length, problem);
}

/* The resource, which is the query's, or NULL. */
static bool use_resource(struct server_field_query *query, struct server_resource *resource)
{
    query->resource = resource;
    if (!resource) return false;
    query->set = query->resource->set;
    query->request = server_resource_request(query->resource);
    return true;
}

/* --- from the field --------------------------------------------------------------------------- */

/* The cached field may reach farther than the query's, which is answered as if it did not. `begun`:
 * the part of the query's work that is done. */
static enum server_query_turn answer_by(struct server_field_query *query,
                                        const struct server_cached *cached, double begun,
                                        struct proto_problem *problem)
{
    struct server_monitor part = server_query_monitor(&query->query, begun, 1 - begun);
    double radius = query->request.radius;
    struct gd_field *within = NULL;
    enum gd_status status = radius > 0 ? gd_field_within(cached->field, radius, &within) : GD_OK;
    if (status) return server_query_fail(&query->query, status, WHAT, problem);
    enum server_query_turn turn =
        query->answer(query, within ? within : cached->field, &part, problem);
    gd_field_release(within);
    return turn;
}

static enum server_query_turn answer_by_pin(struct server_field_query *query,
                                            struct proto_problem *problem)
{
    const struct server_cached *pin = query->pin;
    query->pin = NULL;
    enum server_query_turn turn = answer_by(query, pin, 0, problem);
    server_cache_unpin(pin);
    return turn;
}

/* True if the field is in the cache; it is pinned then. */
static bool look(struct server_field_query *query)
{
    query->pin = server_cache_find_field(query->query.surface->fields, &query->request);
    return query->pin != NULL;
}

static enum server_query_turn fly(struct server_field_query *query, struct proto_problem *problem)
{
    struct server_pending_build *build = query->build;
    struct server_monitor part = server_query_monitor(&query->query, 0, BUILD_SHARE);
    struct gd_field *field;
    part.build = build;
    part.is_awaited = server_cache_is_awaited;
    query->build = NULL;
    enum gd_status status =
        server_field_build_request(&part, query->query.surface->mesh, &query->request, &field);
    if (status) {
        server_cache_fail(build, status);
        return server_query_fail(&query->query, status, WHAT, problem);
    }
    const struct server_cached *published = server_cache_publish(build, field);
    if (!published) return server_query_fail(&query->query, GD_NO_MEMORY, WHAT, problem);
    enum server_query_turn turn = answer_by(query, published, BUILD_SHARE, problem);
    server_cache_unpin(published);
    return turn;
}

/* --- the steps -------------------------------------------------------------------------------- */

static enum server_cache_turn claim(struct server_field_query *query, enum gd_status *why)
{
    return server_cache_claim(query->query.surface->fields, &query->request,
                              &query->query.exchange->job, &query->build, why);
}

bool server_field_query_of_resource(struct server_field_query *query, struct proto_problem *problem)
{
    return use_resource(
        query, server_find_resource(query->query.exchange, query->query.surface->record, problem));
}

bool server_field_query_of_id(struct server_field_query *query, const char *id,
                              struct proto_problem *problem)
{
    if (use_resource(query, find_resource(query->query.surface->record, id, strlen(id), problem)))
        return true;
    proto_problem_at(problem, "field");
    return false;
}

enum server_query_turn server_field_query_glance(struct server_query *query,
                                                 struct proto_problem *problem)
{
    struct server_field_query *own = (struct server_field_query *)query;
    if (!own->set) return SERVER_QUERY_AGAIN;
    return look(own) && own->is_quick ? answer_by_pin(own, problem) : SERVER_QUERY_AGAIN;
}

/* A pending build begins here, before its builder is queued: so those who come meanwhile take no
 * place in the queue. */
bool server_field_query_join(struct server_query *query)
{
    struct server_field_query *own = (struct server_field_query *)query;
    enum gd_status why;
    return own->set && !own->pin && claim(own, &why) == SERVER_CACHE_WAIT;
}

enum server_query_turn server_field_query_solve(struct server_query *query,
                                                struct proto_problem *problem)
{
    struct server_field_query *own = (struct server_field_query *)query;
    enum gd_status why;
    if (!own->set && !(own->prepare ? own->prepare : resolve)(own, problem))
        return SERVER_QUERY_FAILED;
    if (own->build) return fly(own, problem);
    if (own->pin || look(own)) return answer_by_pin(own, problem);
    switch (claim(own, &why)) {
    case SERVER_CACHE_WAIT:
        return SERVER_QUERY_PARKED;
    case SERVER_CACHE_BUILD:
        return fly(own, problem);
    case SERVER_CACHE_SEARCH:
        return server_query_fail(query, why, WHAT, problem);
    case SERVER_CACHE_AGAIN:
        break;
    }
    return SERVER_QUERY_AGAIN;
}

void server_field_query_release(struct server_query *query)
{
    struct server_field_query *own = (struct server_field_query *)query;
    if (own->build) server_cache_fail(own->build, GD_CANCELLED);
    server_cache_unpin(own->pin);
    server_resource_release(own->resource);
    proto_set_free(&own->pending);
    free(own->own_set);
}
