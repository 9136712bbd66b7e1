/* Description: a mesh as a resource, in an answer. */
#ifndef SERVER_HANDLERS_DESCRIPTION_H
#define SERVER_HANDLERS_DESCRIPTION_H

#include "proto/writer.h"
#include "server/exchange.h"
#include "server/surface.h"

void server_description_write(struct proto_writer *writer, struct server_surface *surface);

/* Replies with the description and its ETag. */
void server_description_reply(struct server_exchange *exchange, unsigned status, struct server_surface *surface);

/* The ETag header of a surface, which every answer about it carries. */
void server_description_tag(struct server_exchange *exchange, const struct server_surface *surface);

#endif
