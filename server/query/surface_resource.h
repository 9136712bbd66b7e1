/* Surface resource: a surface as clients see it. Builds it from the bytes of a file, and describes
 * it in an answer. */
#ifndef SERVER_QUERY_SURFACE_RESOURCE_H
#define SERVER_QUERY_SURFACE_RESOURCE_H

#include "proto/json/writer.h"
#include "server/exchange/exchange.h"
#include "server/surfaces/registry.h"

/* Builds the surface of a record from the bytes of its file and stores the description in the
 * record. `attachment` (NULL: none) is malloc'ed and counted as SERVER_BUDGET_FLIGHT; the call
 * takes it over, even when it fails. NULL with the problem. */
struct server_surface *server_surface_resource_build(struct server_exchange *exchange,
                                                     struct server_record *record,
                                                     const void *bytes, void *attachment,
                                                     struct proto_problem *problem);

/* Writes the description: the current one of a surface in memory, else the one in its record. */
void server_surface_resource_describe(struct proto_writer *writer,
                                      const struct server_listed *listed);

/* Replies with the description and its ETag. */
void server_surface_resource_reply(struct server_exchange *exchange, unsigned status,
                                   const struct server_listed *listed);

/* Replies to a request that stores a surface: 201 or 200 with Location and description, or the
 * problem of the outcome. */
void server_surface_resource_reply_stored(struct server_exchange *exchange,
                                          struct server_surface *surface,
                                          enum server_store_outcome outcome);

#endif
