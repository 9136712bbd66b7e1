/* Request: what several handlers read from a request in the same way. */
#ifndef SERVER_HANDLERS_REQUEST_H
#define SERVER_HANDLERS_REQUEST_H

#include "proto/decode.h"
#include "server/exchange.h"
#include "server/store.h"

/* The name in the path, NUL-terminated, of the form that names have; else false, with a problem replied. */
bool server_request_name(struct server_exchange *exchange, char name[PROTO_MESH_NAME + 1]);

/* True when there are no query-string parameters, for operations that have none; else false, with a problem replied. */
bool server_request_is_plain(struct server_exchange *exchange);

/* The surface that the path names, retained, or NULL with a problem replied. */
struct server_surface *server_request_surface(struct server_exchange *exchange);

/* The body as a JSON document, owned by the caller (json_decref), or NULL with unsupported_media_type or
 * invalid_request in `problem`. */
json_t *server_request_document(const struct server_exchange *exchange, struct proto_problem *problem);

/* If-Match and If-None-Match; borrowed. */
struct server_precondition server_request_precondition(const struct server_exchange *exchange);

/* Replies with the problem that a store's outcome is. */
void server_request_fail(struct server_exchange *exchange, enum server_store_outcome outcome);

#endif
