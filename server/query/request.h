/* Request: what several handlers read from a request in the same way. */
#ifndef SERVER_QUERY_REQUEST_H
#define SERVER_QUERY_REQUEST_H

#include "proto/decode.h"
#include "proto/page.h"
#include "server/http/exchange.h"
#include "server/surfaces/registry.h"

/* The kind of surface that the route is about: "/v1/<plural>…". Of any other route: meshes. */
const struct server_kind *server_request_kind(const struct server_exchange *exchange);

/* What the path names: the key, whose name is written to `name`, which it borrows, has the form
 * that names have; else false, with a problem replied. */
bool server_request_key(struct server_exchange *exchange, char name[PROTO_MESH_NAME + 1],
                        struct server_key *key);

/* True when there are no query-string parameters, for operations that have none; else false, with a
 * problem replied. */
bool server_request_is_plain(struct server_exchange *exchange);

/* The page of a list that the parameters ask for; false: a problem is replied. */
bool server_request_page(struct server_exchange *exchange, struct proto_page *page);

/* What is known of the surface that the path names, retained; false: a problem is replied. */
bool server_request_record(struct server_exchange *exchange, struct server_listed *out);

/* The surface that the path names, in memory, retained, if it is what the preconditions of a POST
 * ask for (those of a GET are looked at when its answer is there, reply.c). NULL: the handler is to
 * return at once; a problem is replied, or the exchange is deferred: the surface is loaded by a
 * worker, which then calls the handler again from its beginning. */
struct server_surface *server_request_surface(struct server_exchange *exchange);

/* Of a request about a surface, before its handler is called: true when a worker is to learn first
 * what other daemons have changed, and then calls the handler. Then the exchange is deferred. */
bool server_request_follows_first(struct server_exchange *exchange);

/* Has `work` done by the registry's writer: the last act of work that has something to store.
 * False: as that work then returns. */
bool server_request_write(struct server_exchange *exchange,
                          bool (*work)(struct server_exchange *exchange));

/* Runs `work`, which makes a list, on the registry's reader thread. The handler's last act. */
void server_request_list(struct server_exchange *exchange,
                         bool (*work)(struct server_exchange *exchange));

#define SERVER_REQUEST_SHORT_LIST 16 /* items of a list that an HTTP thread may make */
#define SERVER_REQUEST_SMALL      ((size_t)16 << 10) /* bytes of JSON that an HTTP thread may parse */

/* Holds what a document takes that is parsed from this text, until server_request_end_parsing.
 * insufficient_memory. */
bool server_request_begin_parsing(struct server_exchange *exchange, const char *text, size_t size,
                                  struct proto_problem *problem);

/* The document has been freed. */
void server_request_end_parsing(struct server_exchange *exchange);

/* The body as a JSON document, owned by the caller (json_decref, then server_request_end_parsing),
 * or NULL with unsupported_media_type, invalid_request or insufficient_memory in `problem`. */
json_t *server_request_document(struct server_exchange *exchange, struct proto_problem *problem);

/* Replies with the problem that a store's outcome is. */
void server_request_fail(struct server_exchange *exchange, enum server_store_outcome outcome);

#endif
