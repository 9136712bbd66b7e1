/* Description: a surface as a resource, in an answer. */
#ifndef SERVER_API_SURFACES_DESCRIPTION_H
#define SERVER_API_SURFACES_DESCRIPTION_H

#include "proto/writer.h"
#include "server/http/exchange.h"
#include "server/surfaces/registry.h"

/* As it is now when the surface is in memory, else as its record remembers it. */
void server_description_write(struct proto_writer *writer, const struct server_listed *listed);

/* Replies with the description and its ETag. */
void server_description_reply(struct server_exchange *exchange, unsigned status,
                              const struct server_listed *listed);

/* Writes the surface's description into its record, and what it takes in memory: before the record
 * is shared. False without memory. */
bool server_description_remember(struct server_surface *surface);

/* The ETag header of a surface, which every answer about it carries. */
void server_description_tag(struct server_exchange *exchange, const struct server_record *record);

#endif
