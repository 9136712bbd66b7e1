/* Derive: edits a mesh. The result becomes one mesh resource, several of them, or a file. */
#include "server/query/handlers.h"

#include <stdlib.h>

#include "proto/http/accept.h"
#include "server/exchange/reply.h"
#include "server/query/edits.h"
#include "server/query/query.h"
#include "server/query/request.h"

struct derivation {
    struct server_query query; /* must be the first member */
    struct proto_derive wanted;
    struct server_edits edits;
    struct server_derived_meshes meshes;
    char *file; /* the answer as a file, if no mesh is stored */
    size_t file_size;
};

static void derivation_release(struct server_query *query)
{
    struct derivation *derivation = (struct derivation *)query;
    server_derived_meshes_free(&derivation->meshes);
    server_edits_free(&derivation->edits);
    free(derivation->file);
}

static bool derivation_decode(struct server_query *query, const json_t *document)
{
    struct proto_derive *wanted = &((struct derivation *)query)->wanted;
    const char *accept = server_exchange_header(query->exchange, "Accept");
    if (!proto_derive_decode(document, wanted, query->problem)) return false;
    const char *type =
        wanted->mesh.text[0] ? "application/json" : gd_format_media_type(wanted->format);
    return proto_accept_quality(accept, type) > 0 ||
           proto_problem_set(query->problem, PROTO_PROBLEM_NOT_ACCEPTABLE,
                             "the answer is %s; send Accept: %s or none", type, type);
}

/* --- the answer ------------------------------------------------------------------------------- */

/* Runs on the registry's writer thread. */
static bool derivation_store(struct server_exchange *exchange)
{
    struct derivation *derivation = (struct derivation *)exchange->state;
    struct server_derived_meshes *meshes = &derivation->meshes;
    enum server_outcome outcome = server_derived_meshes_store(meshes);
    if (derivation->wanted.is_split)
        server_derived_meshes_reply(meshes, outcome);
    else
        server_surface_resource_reply_stored(exchange, meshes->list[0].surface, outcome);
    return true;
}

static enum server_query_turn end_with_meshes(struct derivation *derivation)
{
    struct server_query *query = &derivation->query;
    struct server_edits *edits = &derivation->edits;
    const char *name = derivation->wanted.mesh.text;
    struct server_monitor part = server_query_monitor(query, 0.7, 0.1);
    derivation->meshes.exchange = query->exchange;
    bool is_added = derivation->wanted.is_split
                        ? server_edits_add_parts(edits, &part, &derivation->meshes, name,
                                                 derivation->query.problem)
                        : server_edits_add(edits, &edits->edited, &derivation->meshes, name,
                                           derivation->query.problem);
    if (!is_added) return SERVER_QUERY_FAILED;
    (void)server_request_write(query->exchange, derivation_store);
    return SERVER_QUERY_PARKED;
}

/* Returns an upper bound of a file's bytes: a double has at most 25 characters, an index 11. */
static size_t file_cost(const struct gd_polygons *polygons)
{
    return (size_t)polygons->position_count * 2 * 80 + (size_t)polygons->polygon_count * 2 * 40 +
           4096;
}

static enum server_query_turn end_with_file(struct derivation *derivation)
{
    struct server_query *query = &derivation->query;
    struct server_monitor part = server_query_monitor(query, 0.9, 0.1);
    const struct gd_control control = server_exchange_control(&part);
    const struct gd_polygons *polygons = &derivation->edits.edited.polygons;
    size_t cost = file_cost(polygons);
    server_edits_drop_mesh(&derivation->edits);
    enum gd_status status = server_query_take(query, cost);
    if (!status)
        status = gd_write_polygons_within(polygons, derivation->wanted.format, &control,
                                          &derivation->file, &derivation->file_size);
    if (status) return server_query_fail_file(query, status, "the file");
    server_query_give(query, cost - derivation->file_size);
    query->held -= derivation->file_size; /* the response takes over the file */
    query->exchange->held += derivation->file_size;
    return SERVER_QUERY_DONE;
}

static void derivation_reply(struct server_query *query)
{
    struct derivation *derivation = (struct derivation *)query;
    enum gd_format format = derivation->wanted.format;
    void *file = derivation->file;
    derivation->file = NULL;
    server_reply_header(query->exchange, "Content-Disposition", "attachment; filename=\"%s.%s\"",
                        query->surface->record->name, gd_format_name(format));
    server_reply_bytes(query->exchange, 200, gd_format_media_type(format), file,
                       derivation->file_size);
}

/* --- the edits -------------------------------------------------------------------------------- */

static enum server_query_turn derivation_solve(struct server_query *query)
{
    struct derivation *derivation = (struct derivation *)query;
    bool has_mesh = derivation->wanted.mesh.text[0];
    struct server_monitor monitor = server_query_monitor(query, 0, has_mesh ? 0.7 : 0.9);
    derivation->edits.surface = query->surface;
    derivation->edits.edits = derivation->wanted.edits;
    if (!server_edits_run(&derivation->edits, &monitor, query->problem)) return SERVER_QUERY_FAILED;
    return has_mesh ? end_with_meshes(derivation) : end_with_file(derivation);
}

const struct server_query_kind server_query_derive = {.name = "derive",
                                                      .size = sizeof(struct derivation),
                                                      .decode = derivation_decode,
                                                      .solve = derivation_solve,
                                                      .reply = derivation_reply,
                                                      .reply_form = "file",
                                                      .release = derivation_release};
