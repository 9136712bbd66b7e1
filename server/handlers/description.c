/* See description.h. */
#include "server/handlers/description.h"

#include "server/reply.h"

void server_description_write(struct proto_writer *writer, struct server_surface *surface)
{
    const struct proto_mesh_description description = {
        .name = surface->origin.name,
        .sha256 = surface->origin.sha256,
        .created = surface->created,
        .etag = surface->etag,
        .fields_cached = server_shelf_count(surface->shelf),
        .memory_bytes = surface->bytes,
        .mesh = surface->mesh,
    };
    proto_mesh_encode(writer, &description);
}

void server_description_tag(struct server_exchange *exchange, const struct server_surface *surface)
{
    server_reply_header(exchange, "ETag", "\"%s\"", surface->etag);
}

void server_description_reply(struct server_exchange *exchange, unsigned status, struct server_surface *surface)
{
    struct proto_writer writer;
    proto_writer_init(&writer, SERVER_REPLY_MOST);
    server_description_write(&writer, surface);
    server_description_tag(exchange, surface);
    server_reply_json(exchange, status, &writer);
}
