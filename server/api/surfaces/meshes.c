/* Meshes: replies with the file and the boundaries of a mesh. surfaces.c has the operations that
 * all surfaces share. */
#include "server/query/handlers.h"

#include <stdlib.h>

#include "gd/io.h"
#include "proto/http/page.h"
#include "server/exchange/etag.h"
#include "server/exchange/reply.h"
#include "server/query/api.h"
#include "server/query/request.h"

/* Reads the requested format; replies with a problem if there is none. */
static bool content_read_format(struct server_exchange *exchange, enum gd_format *format)
{
    const char *accept = server_exchange_header(exchange, "Accept");
    struct proto_problem problem;
    bool is_good = proto_mesh_content_format(&exchange->parameters, accept, format, &problem);
    return server_reply_check(exchange, is_good, &problem);
}

/* Returns an upper bound of the bytes of polygons and text: a double has at most 25 characters, an
 * index 11. */
static size_t content_cost(const struct gd_mesh *mesh)
{
    const struct gd_mesh_summary *summary = gd_mesh_summary(mesh);
    return (size_t)summary->index_count * (24 + 2 * 80) + (size_t)summary->faces * (16 + 2 * 40) +
           4096;
}

static bool content_write(const struct gd_mesh *mesh, enum gd_format format, char **bytes,
                          size_t *size, struct proto_problem *problem)
{
    struct gd_polygons polygons = {0};
    enum gd_status status = gd_mesh_polygons(mesh, &polygons);
    if (!status) status = gd_write_polygons(&polygons, format, bytes, size);
    gd_polygons_free(&polygons);
    return server_request_check_file(status, problem);
}

/* Adds the headers of a mesh's file. */
static void content_describe(struct server_exchange *exchange, const struct server_record *record,
                             enum gd_format format)
{
    server_reply_tag(exchange, record->etag, gd_format_name(format));
    server_reply_header(exchange, "Vary", "Accept");
    server_reply_header(exchange, "Content-Disposition", "attachment; filename=\"%s.%s\"",
                        record->name, gd_format_name(format));
}

static bool content_send(struct server_exchange *exchange)
{
    const struct server_surface *surface = exchange->surface;
    size_t cost = content_cost(surface->mesh), size;
    struct proto_problem problem;
    enum gd_format format;
    char *bytes;
    if (!content_read_format(exchange, &format)) return true;
    bool is_written = server_request_take(exchange, "the file", cost, &problem) &&
                      content_write(surface->mesh, format, &bytes, &size, &problem);
    if (!server_reply_check(exchange, is_written, &problem)) return true;
    server_budget_adjust(exchange->host->budget, SERVER_BUDGET_FLIGHT, cost, size);
    exchange->held = size;
    content_describe(exchange, surface->record, format);
    server_reply_bytes(exchange, 200, gd_format_media_type(format), bytes, size);
    return true;
}

/* Replies without loading the mesh if the client already has the file. Returns true if the request
 * is answered. */
static bool content_is_known(struct server_exchange *exchange, enum gd_format format)
{
    char tag[SERVER_ETAG_TEXT];
    const struct server_precondition precondition = server_precondition_read(exchange);
    struct server_listed listed;
    if (!precondition.if_none_match[0]) return false;
    if (!server_request_record(exchange, &listed)) return true;
    server_etag_write(tag, listed.record->etag, gd_format_name(format));
    bool is_known = server_precondition_known(&precondition, tag);
    if (is_known) {
        server_reply_tag(exchange, listed.record->etag, gd_format_name(format));
        server_reply_header(exchange, "Vary", "Accept, Accept-Encoding");
        server_reply_empty(exchange, 304);
    }
    server_listed_release(&listed);
    return is_known;
}

void server_handle_get_mesh_content(struct server_exchange *exchange)
{
    enum gd_format format;
    if (!content_read_format(exchange, &format) || content_is_known(exchange, format)) return;
    if (server_request_surface(exchange)) server_exchange_defer(exchange, content_send, NULL);
}

void server_handle_list_boundaries(struct server_exchange *exchange)
{
    struct proto_problem problem;
    struct proto_writer writer;
    struct proto_page page;
    int64_t after;
    if (!server_reply_accepts_json(exchange) || !server_request_page(exchange, &page) ||
        !server_reply_check(exchange, proto_page_number(&page, &after, &problem), &problem))
        return;
    struct server_surface *surface = server_request_surface(exchange);
    if (!surface) return;
    server_reply_writer(exchange, &writer);
    proto_boundaries_encode(&writer, surface->mesh, after, page.limit);
    server_reply_tag(exchange, surface->record->etag, "json");
    server_reply_json(exchange, 200, &writer);
}
