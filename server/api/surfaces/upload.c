/* Uploads of any kind of surface. The route names the kind (request.h).
 *
 * A worker builds the surface from the bytes of the body, and edits it if requested; the registry's
 * writer thread stores it before the response. Each step replies when it fails. */
#include "server/query/handlers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/exchange/reply.h"
#include "server/query/api.h"
#include "server/query/edits.h"
#include "server/query/request.h"
#include "server/query/surface_resource.h"
#include "server/store/kind.h"

#define GENERATED_NAME 32 /* hexadecimal digits of a SHA-256 */

/* fraction of the progress before the edits; the rest is for building the edited mesh */
#define BUILD_SHARE 0.2
#define EDIT_SHARE  0.6

struct upload {
    char name[PROTO_MESH_NAME + 1]; /* empty if it is generated from the bytes and the edits */
    bool has_caption;
    char caption[SERVER_CAPTION];
    struct proto_edits edits; /* edits of a mesh; may be empty */
    struct server_record *record;
    bool is_known;                       /* true if the record is already in the registry */
    struct server_surface *surface;      /* NULL if not built yet */
    struct server_derived_meshes edited; /* with edits: the surface and its file */
};

static void upload_free(void *state)
{
    struct upload *upload = state;
    server_surface_release(upload->surface);
    server_record_release(upload->record);
    server_derived_meshes_free(&upload->edited);
    free(upload);
}

/* Returns the file of the surface. */
static const void *upload_file(const struct server_exchange *exchange)
{
    const struct upload *upload = exchange->state;
    return upload->edited.count ? upload->edited.list[0].file : exchange->body.bytes;
}

/* --- the record ------------------------------------------------------------------------------- */

/* Generates the name. Returns false if out of memory. */
static bool generate_name(struct upload *upload, const char *sha256)
{
    char both[SERVER_SHA256_HEX];
    struct proto_writer writer;
    if (upload->name[0]) return true;
    proto_writer_init(&writer, PROTO_EDITS_TEXT + SERVER_SHA256_HEX);
    proto_append(&writer, sha256, strlen(sha256));
    if (upload->edits.count) proto_edits_encode(&writer, &upload->edits);
    bool is_written = !writer.failure;
    if (is_written && upload->edits.count) {
        server_sha256(writer.data, writer.size, both);
        sha256 = both;
    }
    if (is_written) snprintf(upload->name, sizeof upload->name, "%.*s", GENERATED_NAME, sha256);
    proto_writer_free(&writer);
    return is_written;
}

/* Creates the record of the uploaded file; also called when an upload starts over
 * (upload_confirm). */
static bool upload_identify(struct server_exchange *exchange, struct upload *upload)
{
    const struct server_body *body = &exchange->body;
    const struct server_kind *kind = server_request_kind(exchange);
    const struct server_file file = {body->bytes, body->size,
                                     server_exchange_header(exchange, "Content-Type")};
    struct proto_problem problem;
    char sha256[SERVER_SHA256_HEX], options[SERVER_OPTIONS];
    struct server_monitor monitor = {.exchange = exchange};
    const struct gd_control control = server_exchange_control(&monitor);
    bool is_good = kind->read_options(&exchange->parameters, &file, options, &problem);
    if (is_good) {
        enum gd_status status = server_sha256_within(body->bytes, body->size, &control, sha256);
        is_good = !status || proto_problem_from_status(&problem, status, NULL);
    }
    if (!server_reply_check(exchange, is_good, &problem)) return false;
    server_record_release(upload->record);
    upload->record = NULL;
    if (generate_name(upload, sha256))
        upload->record = server_record_create(
            &(struct server_origin){.key = {exchange->tenant, kind, upload->name},
                                    .sha256 = sha256,
                                    .size = body->size,
                                    .options = options});
    if (!upload->record) server_request_fail(exchange, SERVER_STORE_NO_MEMORY);
    return upload->record != NULL;
}

/* Checks the precondition. If the same surface is already stored under this name, the upload takes
 * over its record, and also the surface if that is in memory. */
static bool upload_compare(struct server_exchange *exchange, struct upload *upload)
{
    const struct server_precondition precondition = server_precondition_read(exchange);
    const struct server_key key = server_record_key(upload->record);
    struct server_listed before = {0};
    bool exists = server_registry_find(exchange->host->api->registry, &key, &before);
    bool holds = server_registry_allows(&precondition, exists ? before.record : NULL);
    upload->is_known = exists && server_record_equal(before.record, upload->record);
    if (!holds) {
        server_request_fail(exchange, SERVER_STORE_PRECONDITION);
    } else if (upload->is_known) {
        server_record_release(upload->record);
        upload->record = server_record_retain(before.record);
        if (before.surface && !upload->surface)
            upload->surface = server_surface_retain(before.surface);
    }
    server_listed_release(&before);
    return holds;
}

/* --- storing ---------------------------------------------------------------------------------- */

static bool upload_reply(struct server_exchange *exchange, enum server_outcome outcome)
{
    const struct upload *upload = exchange->state;
    server_body_drop(&exchange->body);
    if (outcome == SERVER_STORE_CREATED || outcome == SERVER_STORE_REPLACED)
        server_previews_expect(exchange->host->api->previews, upload->surface);
    server_surface_resource_reply_stored(exchange, upload->surface, outcome);
    return true;
}

/* If the upload has no caption, copies that of the current record with the same name. */
static bool upload_caption(struct server_exchange *exchange, struct upload *upload)
{
    const struct server_key key = server_record_key(upload->record);
    struct server_listed before = {0};
    char caption[SERVER_CAPTION] = "";
    if (upload->has_caption)
        strcpy(caption, upload->caption);
    else if (server_registry_find(exchange->host->api->registry, &key, &before))
        server_record_caption(before.record, caption);
    server_listed_release(&before);
    if (server_record_set_caption(upload->record, caption)) return true;
    server_request_fail(exchange, SERVER_STORE_NO_MEMORY);
    return false;
}

/* Runs on the registry's writer thread. */
static bool upload_store(struct server_exchange *exchange)
{
    const struct server_precondition precondition = server_precondition_read(exchange);
    struct upload *upload = exchange->state;
    if (!upload_caption(exchange, upload)) return true;
    return upload_reply(exchange,
                        server_registry_put(exchange->host->api->registry, upload->surface,
                                            upload_file(exchange), &precondition));
}

static bool upload_build(struct server_exchange *exchange);

/* Confirms the stored file of a record that is already in the registry. Runs on the registry's
 * writer thread. If the name has another record by now, the upload starts over. */
static bool upload_confirm(struct server_exchange *exchange)
{
    static const struct server_precondition none;
    struct server_registry *registry = exchange->host->api->registry;
    struct upload *upload = exchange->state;
    const struct server_key key = server_record_key(upload->record);
    enum server_outcome outcome =
        server_registry_put(registry, upload->surface, upload_file(exchange), NULL);
    if (outcome == SERVER_STORE_REPLACED && upload->has_caption) {
        enum server_outcome amended =
            server_registry_caption(registry, &key, upload->caption, &none);
        if (amended) outcome = amended;
    }
    if (outcome != SERVER_STORE_ABSENT) return upload_reply(exchange, outcome);
    server_surface_release(upload->surface);
    upload->surface = NULL;
    server_exchange_defer(exchange, upload_build, NULL);
    server_workers_resume(exchange->host->workers, &exchange->job);
    return false;
}

/* --- building --------------------------------------------------------------------------------- */

/* Replaces the mesh of the file by the edited mesh. On failure returns false with the problem. */
static bool upload_edit(struct server_exchange *exchange, struct upload *upload,
                        struct proto_problem *problem)
{
    struct server_monitor part = {.exchange = exchange, .begun = BUILD_SHARE, .share = EDIT_SHARE};
    struct server_edits edits = {
        .surface = upload->surface, .is_upload = true, .edits = upload->edits};
    server_derived_meshes_free(&upload->edited);
    upload->edited.exchange = exchange;
    bool is_made = server_edits_run(&edits, &part, problem) &&
                   server_edits_add(&edits, &edits.edited, &upload->edited, upload->name, problem);
    server_edits_free(&edits);
    if (!is_made) return false;
    server_surface_release(upload->surface);
    server_record_release(upload->record);
    upload->surface = server_surface_retain(upload->edited.list[0].surface);
    upload->record = server_record_retain(upload->surface->record);
    return true;
}

/* Builds the surface; runs on a worker. */
static bool upload_build(struct server_exchange *exchange)
{
    struct upload *upload = exchange->state;
    struct server_monitor part = {.exchange = exchange,
                                  .share = upload->edits.count ? BUILD_SHARE : 1};
    struct proto_problem problem;
    if (!upload_identify(exchange, upload) || !upload_compare(exchange, upload)) return true;
    if (!upload->surface)
        upload->surface = server_surface_resource_build(
            &part, upload->record, &(struct server_surface_source){.bytes = exchange->body.bytes},
            &problem);
    bool is_built =
        upload->surface && (!upload->edits.count || upload_edit(exchange, upload, &problem));
    if (!server_reply_check(exchange, is_built, &problem)) return true;
    if (upload->edits.count && !upload_compare(exchange, upload)) return true;
    return server_request_write(exchange, upload->is_known ? upload_confirm : upload_store);
}

/* --- the request ------------------------------------------------------------------------------ */

static bool upload_parse(struct server_exchange *exchange, struct upload *upload,
                         struct proto_problem *problem)
{
    const char *caption;
    if (!proto_caption_parse(&exchange->parameters, &caption, problem)) return false;
    upload->has_caption = caption;
    snprintf(upload->caption, sizeof upload->caption, "%s", caption ? caption : "");
    return server_request_kind(exchange) != &server_kind_mesh ||
           proto_edits_parse(&exchange->parameters, &upload->edits, problem);
}

static void upload_start(struct server_exchange *exchange, const char *name)
{
    struct proto_problem problem;
    if (!server_reply_accepts_json(exchange)) return;
    struct upload *upload = server_request_allocate(exchange, sizeof *upload, upload_free);
    if (!upload) return;
    strcpy(upload->name, name);
    if (server_reply_check(exchange, upload_parse(exchange, upload, &problem), &problem))
        server_exchange_defer(exchange, upload_build, NULL);
}

void server_handle_create_surface(struct server_exchange *exchange)
{
    upload_start(exchange, "");
}

void server_handle_put_surface(struct server_exchange *exchange)
{
    struct server_key key;
    if (server_request_key(exchange, &key)) upload_start(exchange, key.name);
}
