/* Fields: the distances from a set as a resource. Made, listed, described, removed. */
#include "server/query/handlers.h"

#include <math.h>
#include <stdlib.h>

#include "proto/page.h"
#include "server/fields/cache.h"
#include "server/query/field_query.h"
#include "server/query/request.h"
#include "server/http/reply.h"
#include "server/query/api.h"

#define WHAT "the field"

/* --- make ------------------------------------------------------------------------------------- */

struct making {
    struct server_field_query field; /* first; its set passes to the resource */
    char id[PROTO_FIELD_ID + 1];
    bool is_new;
};

/* True when it is a resource already, which is then the query's. */
static bool is_listed(struct making *making)
{
    struct server_field_query *field = &making->field;
    struct server_catalogue *catalogue = server_record_catalogue(field->query.surface->record);
    if (field->resource) return true;
    return catalogue &&
           server_catalogue_find(catalogue, making->id, &field->resource) == SERVER_CATALOGUE_FOUND;
}

static bool name(struct server_field_query *query, struct proto_problem *problem)
{
    struct making *making = (struct making *)query;
    const char *etag = query->query.surface->record->etag;
    if (!server_resource_name(etag, query->set, query->request.radius, making->id))
        return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    query->is_quick = is_listed(making);
    return true;
}

/* Where the distance is largest, of a field that goes so far. */
static enum gd_status find_farthest(const struct gd_field *field, struct server_monitor *part,
                                    struct proto_field_description *description)
{
    const struct gd_control control = server_exchange_control(part);
    enum gd_status status =
        gd_field_farthest(field, &control, &description->farthest, &description->max);
    if (status != GD_BEYOND_REACH) return status;
    description->max = NAN;
    return GD_OK;
}

static enum gd_status describe(const struct making *making, const struct gd_field *field,
                               struct server_monitor *part, struct proto_field_description *out)
{
    const struct gd_field_statistics *statistics = gd_field_statistics(field);
    *out = (struct proto_field_description){.wedges = statistics->wedges,
                                            .bytes = gd_field_memsize(field),
                                            .build_ms = (double)statistics->build_ns / 1e6,
                                            .max_distance = making->field.request.radius,
                                            .members = making->field.set->count};
    return find_farthest(field, part, out);
}

/* Lists the field as a resource, unless another request has done so by now. */
static enum gd_status list(struct making *making, const struct proto_field_description *description)
{
    struct server_field_query *field = &making->field;
    struct server_catalogue *catalogue = server_record_catalogue(field->query.surface->record);
    struct server_budget *budget = field->query.exchange->host->budget;
    if (!catalogue) return GD_NO_MEMORY;
    field->resource = server_resource_create(making->id, field->own_set, description, budget);
    if (!field->resource) return GD_BUDGET;
    field->own_set = NULL;
    const char *key = server_grant_name(&field->query.exchange->grant);
    making->is_new = server_catalogue_add(catalogue, key ? key : "", &field->resource);
    field->set = field->resource->set;
    field->request = server_resource_request(field->resource);
    return GD_OK;
}

static enum server_query_turn answer(struct server_field_query *query, const struct gd_field *field,
                                     struct server_monitor *part, struct proto_problem *problem)
{
    struct making *making = (struct making *)query;
    struct proto_field_description description;
    if (is_listed(making)) return SERVER_QUERY_DONE;
    enum gd_status status = describe(making, field, part, &description);
    if (!status) status = list(making, &description);
    return status ? server_query_fail(&query->query, status, WHAT, problem) : SERVER_QUERY_DONE;
}

static bool decode(struct server_query *query, const json_t *document,
                   struct proto_problem *problem)
{
    struct making *making = (struct making *)query;
    struct proto_field_request wanted;
    if (!proto_field_decode(document, &wanted, problem)) return false;
    making->field.answer = answer;
    making->field.located = name;
    bool ok = server_field_query_of_set(&making->field, &wanted.set, wanted.max_distance, problem);
    proto_set_free(&wanted.set);
    return ok;
}

static void encode_resource(const struct server_query *query, struct proto_writer *writer)
{
    const struct server_field_query *field = (const struct server_field_query *)query;
    proto_field_encode(writer, query->surface->mesh, &field->resource->description,
                       query->options.fields);
}

static unsigned status(struct server_query *query)
{
    const struct making *making = (const struct making *)query;
    server_reply_header(query->exchange, "Location", "/v1/meshes/%s/fields/%s",
                        query->surface->record->name, making->id);
    return making->is_new ? 201 : 200;
}

static const struct server_query_kind make_field = {.name = "fields",
                                                    .size = sizeof(struct making),
                                                    .fields = proto_field_fields,
                                                    .decode = decode,
                                                    .glance = server_field_query_glance,
                                                    .join = server_field_query_join,
                                                    .solve = server_field_query_solve,
                                                    .encode = encode_resource,
                                                    .release = server_field_query_release,
                                                    .status = status};

void server_handle_create_field(struct server_exchange *exchange)
{
    server_query_handle(exchange, &make_field);
}

/* --- describe --------------------------------------------------------------------------------- */

static bool parse_id(struct server_query *query, const struct proto_parameters *parameters,
                     struct proto_problem *problem)
{
    (void)parameters;
    return server_field_query_of_resource((struct server_field_query *)query, problem);
}

/* What is told needs no wedges. */
static enum server_query_turn tell(struct server_query *query, struct proto_problem *problem)
{
    (void)query, (void)problem;
    return SERVER_QUERY_DONE;
}

static const struct server_query_kind describe_field = {.name = "field",
                                                        .size = sizeof(struct server_field_query),
                                                        .fields = proto_field_fields,
                                                        .parse = parse_id,
                                                        .glance = tell,
                                                        .solve = tell,
                                                        .encode = encode_resource,
                                                        .release = server_field_query_release};

void server_handle_get_field(struct server_exchange *exchange)
{
    server_query_handle(exchange, &describe_field);
}

/* --- list ------------------------------------------------------------------------------------- */

static void write_page(struct proto_writer *writer, const struct gd_mesh *mesh,
                       struct server_resource **resources, uint32_t count, uint32_t limit)
{
    uint32_t written = count < limit ? count : limit;
    proto_page_begin(writer, "fields");
    for (uint32_t i = 0; i < written; i++)
        proto_field_encode(writer, mesh, &resources[i]->description, PROTO_FIELD_FIELD_ALL);
    proto_page_end(writer, count > limit ? resources[limit - 1]->id : NULL);
}

/* The fields on a page, and one more if there is a next page; at most `most`. */
static uint32_t find_listed(struct server_surface *surface, const struct proto_page *page,
                            uint32_t most, struct server_resource **resources)
{
    struct server_catalogue *catalogue = server_record_catalogue(surface->record);
    uint32_t wanted = page->limit < most ? page->limit + 1 : most;
    return catalogue ? server_catalogue_list(catalogue, page->after, wanted, resources) : 0;
}

static void reply_page(struct server_exchange *exchange, struct server_surface *surface,
                       const struct proto_page *page, struct server_resource **resources,
                       uint32_t count)
{
    struct proto_writer writer;
    server_reply_writer(exchange, &writer);
    write_page(&writer, surface->mesh, resources, count, page->limit);
    for (uint32_t i = 0; i < count; i++) server_resource_release(resources[i]);
    server_reply_json(exchange, 200, &writer);
}

/* Of the mesh that the exchange keeps. */
static bool list_fields(struct server_exchange *exchange)
{
    struct proto_page page;
    struct server_resource *resources[PROTO_PAGE_MOST + 1];
    if (!server_request_page(exchange, &page)) return true;
    uint32_t count = find_listed(exchange->state, &page, PROTO_PAGE_MOST + 1, resources);
    reply_page(exchange, exchange->state, &page, resources, count);
    return true;
}

static void release_surface(void *surface)
{
    server_surface_release(surface);
}

void server_handle_list_fields(struct server_exchange *exchange)
{
    struct proto_page page;
    struct server_resource *resources[SERVER_REQUEST_SHORT_LIST + 1];
    if (!server_reply_accepts_json(exchange) || !server_request_page(exchange, &page)) return;
    struct server_surface *surface = server_request_surface(exchange);
    if (!surface) return;
    server_exchange_keep(exchange, surface, release_surface);
    uint32_t count = find_listed(surface, &page, SERVER_REQUEST_SHORT_LIST + 1, resources);
    if (page.limit <= SERVER_REQUEST_SHORT_LIST || count <= SERVER_REQUEST_SHORT_LIST) {
        reply_page(exchange, surface, &page, resources, count);
        return;
    }
    for (uint32_t i = 0; i < count; i++) server_resource_release(resources[i]);
    server_request_list(exchange, list_fields);
}

/* --- remove ----------------------------------------------------------------------------------- */

/* Takes the field from the list and its wedges from the cache; false with the problem. */
static bool remove_field(struct server_exchange *exchange, const struct server_listed *mesh,
                         struct proto_problem *problem)
{
    struct server_resource *resource = server_find_resource(exchange, mesh->record, problem);
    if (!resource) return false;
    struct gd_field_request request = server_resource_request(resource);
    server_resource_release(
        server_catalogue_remove(server_record_catalogue(mesh->record), resource->id));
    if (mesh->surface) server_cache_drop(mesh->surface->fields, &request);
    server_resource_release(resource);
    return true;
}

void server_handle_delete_field(struct server_exchange *exchange)
{
    struct server_listed mesh;
    struct proto_problem problem;
    if (!server_request_is_plain(exchange) || !server_request_record(exchange, &mesh)) return;
    if (remove_field(exchange, &mesh, &problem))
        server_reply_empty(exchange, 204);
    else
        server_reply_problem(exchange, &problem);
    server_listed_release(&mesh);
}
