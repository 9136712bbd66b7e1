/* Request: what handlers read from requests, in one way. */
#ifndef SERVER_QUERY_REQUEST_H
#define SERVER_QUERY_REQUEST_H

#include "proto/json/decode.h"
#include "proto/http/page.h"
#include "server/exchange/exchange.h"
#include "server/surfaces/registry.h"

/* The kind of surface that the route is about, "/v1/<plural>…". Other routes: meshes. */
const struct server_kind *server_request_kind(const struct server_exchange *exchange);

/* The key that the path names. Its name is written to `name`, which the key borrows. False: it is
 * no valid name; a problem is replied. */
bool server_request_key(struct server_exchange *exchange, char name[PROTO_MESH_NAME + 1],
                        struct server_key *key);

/* For operations without query-string parameters. False: there are some; a problem is replied. */
bool server_request_is_plain(struct server_exchange *exchange);

/* The page of a list that the parameters ask for, or of a list of names, which `prefix` may narrow.
 * False: a problem is replied. */
bool server_request_page(struct server_exchange *exchange, struct proto_page *page);
bool server_request_page_of_names(struct server_exchange *exchange, struct proto_page *page);

/* The record of the surface that the path names, retained. False: a problem is replied. */
bool server_request_record(struct server_exchange *exchange, struct server_listed *out);

/* The surface that the path names, in memory, retained. Checks the preconditions of a POST; those
 * of a GET are checked with its answer (reply.c). NULL: the handler returns at once, for a problem
 * is replied, or a worker loads the surface and then calls the handler again. */
struct server_surface *server_request_surface(struct server_exchange *exchange);

/* Before the handler of a request about a surface. True: a worker first learns what other daemons
 * have changed, then calls the handler; the exchange is deferred. */
bool server_request_follows_first(struct server_exchange *exchange);

/* Runs `work` on the registry's writer: the last act of work that stores something. False, for that
 * work to return. */
bool server_request_write(struct server_exchange *exchange,
                          bool (*work)(struct server_exchange *exchange));

/* Runs `work`, which makes a list, on the registry's reader thread. The handler's last act. */
void server_request_list(struct server_exchange *exchange,
                         bool (*work)(struct server_exchange *exchange));

#define SERVER_REQUEST_SHORT_LIST 16 /* items of a list that an HTTP thread makes */

/* Holds the memory of a document that is parsed from this text, until server_request_end_parsing,
 * which follows when the document is freed. insufficient_memory. */
bool server_request_begin_parsing(struct server_exchange *exchange, const char *text, size_t size,
                                  struct proto_problem *problem);
void server_request_end_parsing(struct server_exchange *exchange);

/* The body as a JSON document, owned by the caller (json_decref, then server_request_end_parsing).
 * NULL: unsupported_media_type, invalid_request or insufficient_memory. */
json_t *server_request_document(struct server_exchange *exchange, struct proto_problem *problem);

/* Replies with the problem of a store's outcome. */
void server_request_fail(struct server_exchange *exchange, enum server_store_outcome outcome);

#endif
