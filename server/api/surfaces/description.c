/* See description.h. */
#include "server/api/surfaces/description.h"

#include <stdlib.h>
#include <string.h>

#include "server/surfaces/kind.h"
#include "server/http/reply.h"

void server_description_write(struct proto_writer *writer, const struct server_listed *listed)
{
    const char *remembered = listed->record->description;
    if (listed->surface)
        listed->record->kind->describe(writer, listed->surface);
    else
        proto_write_raw(writer, remembered, strlen(remembered));
}

bool server_description_remember(struct server_surface *surface)
{
    struct server_record *record = surface->record;
    struct proto_writer writer;
    size_t size = 0;
    proto_writer_init(&writer, SERVER_DESCRIPTION_MOST);
    record->kind->describe(&writer, surface);
    proto_append(&writer, "", 1); /* the NUL */
    record->description = proto_writer_take(&writer, &size);
    record->memory = surface->bytes;
    proto_writer_free(&writer);
    return record->description != NULL;
}

void server_description_tag(struct server_exchange *exchange, const struct server_record *record)
{
    server_reply_tag(exchange, record->etag);
}

void server_description_reply(struct server_exchange *exchange, unsigned status,
                              const struct server_listed *listed)
{
    struct proto_writer writer;
    server_reply_writer(exchange, &writer);
    server_description_write(&writer, listed);
    server_description_tag(exchange, listed->record);
    server_reply_json(exchange, status, &writer);
}
