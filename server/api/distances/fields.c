/* Fields: resources with the distances from a set. Creates, lists, describes and deletes them;
 * returns their values at all vertices, and their wedges. */
#include "server/query/handlers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "proto/http/page.h"
#include "server/fields/cache.h"
#include "server/exchange/reply.h"
#include "server/query/api.h"
#include "server/query/request.h"
#include "server/query/result.h"

#define QUICK_VERTICES 10000 /* largest number of vertices whose values an HTTP thread writes */

/* --- create ----------------------------------------------------------------------------------- */

struct field_creation {
    /* must be the first member; the resource takes over the query's set */
    struct server_query query;
    char id[PROTO_FIELD_ID + 1];
    char *set_text;
    bool is_new;
};

static bool creation_decode(struct server_query *query, const json_t *document)
{
    struct field_creation *creation = (struct field_creation *)query;
    struct proto_field_request wanted;
    if (!proto_field_request_decode(document, &wanted, query->problem) ||
        !server_field_query_of_set(query, &wanted.set, wanted.max_distance))
        return false;
    return proto_field_write_set(json_object_get(document, "set"), &creation->set_text) ||
           proto_problem_from_status(query->problem, GD_NO_MEMORY, NULL);
}

static void creation_release(struct server_query *query)
{
    free(((struct field_creation *)query)->set_text);
}

/* Returns true if the resource exists; the query then has a reference to it. */
static bool creation_is_listed(struct server_query *query)
{
    struct server_catalogue *catalogue = server_record_catalogue(query->surface->record);
    return query->field.resource ||
           (catalogue && server_catalogue_find(catalogue, ((struct field_creation *)query)->id,
                                               &query->field.resource) == SERVER_CATALOGUE_FOUND);
}

static bool creation_name(struct server_query *query)
{
    if (!server_resource_name(query->surface->record->etag, query->field.set,
                              query->field.request.radius, ((struct field_creation *)query)->id))
        return proto_problem_from_status(query->problem, GD_NO_MEMORY, NULL);
    query->field.is_quick = creation_is_listed(query);
    return true;
}

/* Adds the field to the catalogue, unless another request has added it meanwhile. */
static enum gd_status creation_list(struct field_creation *creation,
                                    const struct proto_field_description *description)
{
    struct server_query *query = &creation->query;
    struct server_field_query *field = &query->field;
    struct server_catalogue *catalogue = server_record_catalogue(query->surface->record);
    const char *key = server_grant_name(&query->exchange->grant);
    if (!catalogue) return GD_NO_MEMORY;
    field->resource = server_resource_create(creation->id, field->own_set, description,
                                             query->exchange->host->budget);
    if (!field->resource) return GD_BUDGET;
    field->own_set = NULL;
    creation->is_new = server_catalogue_add(catalogue, key ? key : "", &field->resource);
    field->set = field->resource->set;
    field->request = server_resource_request(field->resource);
    return GD_OK;
}

static enum server_query_turn creation_answer(struct server_query *query,
                                              const struct gd_field *field)
{
    const struct gd_field_statistics *statistics = gd_field_statistics(field);
    struct server_monitor monitor = server_query_monitor(query, 0, 1);
    const struct gd_control control = server_exchange_control(&monitor);
    struct proto_field_description description = {.wedges = statistics->wedges,
                                                  .bytes = gd_field_memsize(field),
                                                  .build_ms = (double)statistics->build_ns / 1e6,
                                                  .max_distance = query->field.request.radius,
                                                  .members = query->field.set->count,
                                                  .set = ((struct field_creation *)query)->set_text,
                                                  .created = time(NULL)};
    if (creation_is_listed(query)) return SERVER_QUERY_DONE;
    enum gd_status status =
        gd_field_farthest(field, &control, &description.farthest, &description.max);
    if (status == GD_BEYOND_REACH) {
        description.max = NAN;
        status = GD_OK;
    }
    if (!status) status = creation_list((struct field_creation *)query, &description);
    return server_query_end_draft(query, status, "the field");
}

static void resource_encode(const struct server_query *query, struct proto_writer *writer)
{
    proto_field_encode(writer, query->surface->mesh, &query->field.resource->description,
                       query->options.fields);
}

static unsigned creation_status(struct server_query *query)
{
    const struct field_creation *creation = (const struct field_creation *)query;
    server_reply_header(query->exchange, "Location", "/v1/meshes/%s/fields/%s",
                        query->surface->record->name, creation->id);
    return creation->is_new ? 201 : 200;
}

const struct server_query_kind server_query_create_field = {.name = "fields",
                                                            .size = sizeof(struct field_creation),
                                                            .decode = creation_decode,
                                                            .located = creation_name,
                                                            .answer = creation_answer,
                                                            .encode = resource_encode,
                                                            .release = creation_release,
                                                            .status = creation_status};

/* --- describe --------------------------------------------------------------------------------- */

static bool resource_parse(struct server_query *query, const struct proto_parameters *parameters)
{
    (void)parameters;
    return server_field_query_of_resource(query);
}

const struct server_query_kind server_query_get_field = {.name = "field",
                                                         .size = sizeof(struct server_query),
                                                         .parse = resource_parse,
                                                         .encode = resource_encode};

/* --- list ------------------------------------------------------------------------------------- */

static void reply_page(struct server_exchange *exchange, uint32_t limit,
                       struct server_resource **resources, uint32_t count)
{
    uint32_t written = count < limit ? count : limit;
    struct proto_writer writer;
    server_reply_writer(exchange, &writer);
    proto_page_begin(&writer, "fields");
    for (uint32_t i = 0; i < written; i++) {
        struct proto_field_description description = resources[i]->description;
        description.uses = atomic_load(&resources[i]->uses);
        proto_field_encode_listed(&writer, exchange->surface->mesh, &description);
    }
    proto_page_end(&writer, count > limit ? resources[limit - 1]->id : NULL);
    server_reply_json(exchange, 200, &writer);
}

/* Replies with a page of fields. Returns false if the page is too long for an HTTP thread. */
static bool list_fields(struct server_exchange *exchange)
{
    uint32_t most = exchange->work ? PROTO_PAGE_MOST : SERVER_REQUEST_SHORT_LIST;
    struct proto_page page;
    struct server_resource *resources[PROTO_PAGE_MOST + 1];
    if (!server_request_page(exchange, &page) || !server_request_surface(exchange)) return true;
    struct server_catalogue *catalogue = server_record_catalogue(exchange->surface->record);
    uint32_t wanted = page.limit < most ? page.limit : most;
    uint32_t count =
        catalogue ? server_catalogue_list(catalogue, page.after, wanted + 1, resources) : 0;
    bool is_whole = page.limit <= most || count <= most;
    if (is_whole) reply_page(exchange, page.limit, resources, count);
    for (uint32_t i = 0; i < count; i++) server_resource_release(resources[i]);
    return is_whole;
}

void server_handle_list_fields(struct server_exchange *exchange)
{
    if (server_reply_accepts_json(exchange) && !list_fields(exchange))
        server_request_list(exchange, list_fields);
}

/* --- delete ----------------------------------------------------------------------------------- */

void server_handle_delete_field(struct server_exchange *exchange)
{
    struct server_listed mesh;
    struct proto_problem problem;
    if (!server_request_is_plain(exchange) || !server_request_record(exchange, &mesh)) return;
    struct server_resource *resource = server_find_resource(exchange, mesh.record, &problem);
    if (resource) {
        const struct gd_field_request request = server_resource_request(resource);
        server_resource_release(
            server_catalogue_remove(server_record_catalogue(mesh.record), resource->id));
        if (mesh.surface) server_cache_drop(mesh.surface->fields, &request);
        server_resource_release(resource);
        server_reply_empty(exchange, 204);
    } else {
        server_reply_problem(exchange, &problem);
    }
    server_listed_release(&mesh);
}

/* --- values at all vertices ------------------------------------------------------------------- */

struct values_query {
    struct server_query query; /* must be the first member */
    double *values;            /* by vertex index; values that are not finite are written as null */
};

static uint32_t values_count(const struct server_query *query)
{
    return gd_mesh_summary(query->surface->mesh)->index_count;
}

static bool values_parse(struct server_query *query, const struct proto_parameters *parameters)
{
    (void)parameters;
    query->with_mesh = query->form >= SERVER_FORM_FIRST &&
                       !server_query_arrays_form(query); /* regardless of ?mesh= */
    query->field.is_quick = values_count(query) <= QUICK_VERTICES;
    return server_field_query_of_resource(query);
}

static enum server_query_turn values_answer(struct server_query *query,
                                            const struct gd_field *field)
{
    struct values_query *own = (struct values_query *)query;
    uint32_t count = values_count(query);
    double most = query->field.request.radius;
    own->values = server_query_allocate(query, count, sizeof *own->values);
    if (!own->values) return server_query_fail(query, GD_BUDGET, "the answer");
    gd_field_vertex_distances(field, own->values);
    for (uint32_t i = 0; i < count && most > 0; i++)
        if (own->values[i] > most) own->values[i] = INFINITY;
    return SERVER_QUERY_DONE;
}

static void values_encode(const struct server_query *query, struct proto_writer *writer)
{
    proto_values_encode(writer, ((const struct values_query *)query)->values, values_count(query));
}

static const struct server_form values_forms[] = {{"ply", "application/x-ply", false},
                                                  {"glb", "model/gltf-binary", false},
                                                  {"csv", "text/csv", false},
                                                  {NULL, NULL, false}};

static bool values_write(struct server_query *query, struct server_answer_file *out)
{
    static const enum gd_result_format formats[] = {GD_RESULT_PLY, GD_RESULT_GLB, GD_RESULT_CSV};
    const struct gd_result result = {.distances = ((const struct values_query *)query)->values};
    return server_result_write(query, &result, formats[query->form - SERVER_FORM_FIRST], out);
}

static bool values_list_arrays(struct server_query *query)
{
    server_arrays_add_numbers(&query->arrays, "values", 0, values_count(query),
                              ((struct values_query *)query)->values);
    return true;
}

const struct server_query_kind server_query_get_field_values = {.name = "values",
                                                                .size = sizeof(struct values_query),
                                                                .forms = values_forms,
                                                                .parse = values_parse,
                                                                .answer = values_answer,
                                                                .encode = values_encode,
                                                                .has_bytes = true,
                                                                .list_arrays = values_list_arrays,
                                                                .write = values_write};

/* --- wedges ----------------------------------------------------------------------------------- */

/* Wedges of one edge or, as arrays only, of all edges. */
struct wedges_query {
    struct server_query query; /* must be the first member */
    struct gd_vertex ends[2];
    struct gd_wedge *wedges; /* owned */
    uint32_t count;
    bool is_of_all;
    struct gd_all_wedges all; /* owned */
    uint32_t first[2];        /* one edge: its first wedge, and the end of its wedges */
};

static bool wedges_parse(struct server_query *query, const struct proto_parameters *parameters)
{
    struct wedges_query *own = (struct wedges_query *)query;
    own->is_of_all = server_query_arrays_form(query) && !proto_parameters_get(parameters, "edge");
    query->field.is_quick = !own->is_of_all;
    return server_field_query_of_resource(query) &&
           (own->is_of_all || proto_wedges_parse(parameters, own->ends, query->problem));
}

/* Replaces seeds by members of the set: a curve has a seed for each of its points and segments. */
static void wedges_name_members(const struct server_query *query, struct gd_wedge *wedges,
                                uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        if (!wedges[i].at_vertex) wedges[i].source = query->field.set->members[wedges[i].source];
}

static enum server_query_turn wedges_answer_all(struct wedges_query *own,
                                                const struct gd_field *field)
{
    struct server_query *query = &own->query;
    /* On most edges the result has a few more wedges than the field stores. The factor three covers
       the copy while an array grows. */
    size_t grant = (gd_field_statistics(field)->wedges +
                    3 * (size_t)gd_mesh_summary(query->surface->mesh)->edges) *
                   3 * sizeof *own->all.wedges;
    struct server_budgeted_call call = server_query_begin_call(query, NULL, grant);
    while (server_budgeted_call_next(&call)) {
        call.status = gd_field_all_wedges(field, &call.control, &own->all);
        call.kept = gd_all_wedges_memsize(&own->all);
    }
    if (call.status) return server_query_fail(query, call.status, "the wedges");
    wedges_name_members(query, own->all.wedges, own->all.first[own->all.edge_count]);
    return SERVER_QUERY_DONE;
}

static enum server_query_turn wedges_answer(struct server_query *query,
                                            const struct gd_field *field)
{
    struct wedges_query *own = (struct wedges_query *)query;
    if (own->is_of_all) return wedges_answer_all(own, field);
    enum gd_status status =
        gd_field_wedges(field, own->ends[0], own->ends[1], &own->wedges, &own->count);
    if (status) {
        server_query_fail(query, status, "the answer");
        if (status == GD_NO_SUCH_EDGE) proto_problem_at(query->problem, "edge");
        return SERVER_QUERY_FAILED;
    }
    wedges_name_members(query, own->wedges, own->count);
    return SERVER_QUERY_DONE;
}

static void wedges_encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct wedges_query *own = (const struct wedges_query *)query;
    proto_wedges_encode(writer, own->ends, own->wedges, own->count, query->options.fields);
}

static void wedges_release(struct server_query *query)
{
    struct wedges_query *own = (struct wedges_query *)query;
    free(own->wedges);
    gd_all_wedges_free(&own->all);
}

static void wedges_read_numbers(const void *source, uint64_t first, uint64_t count, void *out)
{
    const struct gd_wedge *wedges = source;
    double(*rows)[5] = out;
    for (uint64_t i = 0; i < count; i++) {
        const struct gd_wedge *wedge = &wedges[first + i];
        const double row[5] = {wedge->b0, wedge->b1, wedge->d0, wedge->d1, wedge->sigma};
        memcpy(rows[i], row, sizeof row);
    }
}

/* Writes the index of the source, and flags: 1 tau, 2 linear, 4 the source is a vertex. */
static void wedges_read_sources(const void *source, uint64_t first, uint64_t count, void *out)
{
    const struct gd_wedge *wedges = source;
    uint32_t(*rows)[2] = out;
    for (uint64_t i = 0; i < count; i++) {
        const struct gd_wedge *wedge = &wedges[first + i];
        rows[i][0] = wedge->source;
        rows[i][1] = (uint32_t)(wedge->tau | wedge->linear << 1 | wedge->at_vertex << 2);
    }
}

static bool wedges_list_arrays(struct server_query *query)
{
    struct wedges_query *own = (struct wedges_query *)query;
    const struct gd_all_wedges one = {1, &own->ends, own->first, own->wedges};
    const struct gd_all_wedges *all = own->is_of_all ? &own->all : &one;
    own->first[1] = own->count;
    uint32_t count = all->first[all->edge_count];
    const struct server_array arrays[] = {{.name = "wedges",
                                           .type = SERVER_ARRAY_NUMBERS,
                                           .columns = 5,
                                           .rows = count,
                                           .read = wedges_read_numbers,
                                           .source = all->wedges},
                                          {.name = "sources",
                                           .type = SERVER_ARRAY_INDICES,
                                           .columns = 2,
                                           .rows = count,
                                           .read = wedges_read_sources,
                                           .source = all->wedges},
                                          {.name = "edges",
                                           .type = SERVER_ARRAY_INDICES,
                                           .columns = 2,
                                           .rows = all->edge_count,
                                           .source = all->edges},
                                          {.name = "first",
                                           .type = SERVER_ARRAY_INDICES,
                                           .rows = all->edge_count + UINT64_C(1),
                                           .source = all->first}};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        server_arrays_add(&query->arrays, &arrays[i]);
    return true;
}

const struct server_query_kind server_query_get_field_wedges = {.name = "wedges",
                                                                .size = sizeof(struct wedges_query),
                                                                .list_arrays = wedges_list_arrays,
                                                                .parse = wedges_parse,
                                                                .answer = wedges_answer,
                                                                .encode = wedges_encode,
                                                                .release = wedges_release};
