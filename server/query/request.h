/* Request: functions by which all handlers read requests. */
#ifndef SERVER_QUERY_REQUEST_H
#define SERVER_QUERY_REQUEST_H

#include "proto/json/decode.h"
#include "proto/http/page.h"
#include "server/exchange/exchange.h"
#include "server/exchange/relay.h"
#include "server/surfaces/registry.h"

/* Returns the kind of surface that the route is about, "/v1/<plural>…". Other routes: meshes. */
const struct server_kind *server_request_kind(const struct server_exchange *exchange);

/* Reads the key of the surface (tenant, kind, name) from the path; borrowed from the exchange.
 * False, with a problem replied: the name is invalid. */
bool server_request_key(struct server_exchange *exchange, struct server_key *key);

/* For operations without parameters. False: the request has parameters; a problem is replied. */
bool server_request_is_plain(struct server_exchange *exchange);

/* Reads the seconds that the request may wait. Returns false after replying with a problem. */
bool server_request_wait(struct server_exchange *exchange, uint64_t *wait_s);

/* Returns the time of gd_now_ns at which a wait of `wait_s` ends, or earlier at the deadline. */
uint64_t server_request_wait_end(const struct server_exchange *exchange, uint64_t wait_s);

/* Reads which page of a list the client wants. The second function also reads `prefix`, which
 * selects names. Returns false after replying with a problem. */
bool server_request_page(struct server_exchange *exchange, struct proto_page *page);
bool server_request_page_of_names(struct server_exchange *exchange, struct proto_page *page);

/* Finds the record of the surface that the path names, retained. Returns false after replying with
 * a problem. */
bool server_request_record(struct server_exchange *exchange, struct server_listed *out);

/* Returns the surface that the path names, in memory, retained. Checks the preconditions of a POST;
 * those of a GET are checked with its answer (reply.c). On NULL the handler returns at once: either
 * a problem is replied, or a worker loads the surface and then calls the handler again. */
struct server_surface *server_request_surface(struct server_exchange *exchange);

/* Called before the handler of a request about a surface. True: the exchange is deferred, and a
 * worker applies the changes of other daemons before it calls the handler. */
bool server_request_follows_first(struct server_exchange *exchange);

/* Runs `work`, which stores something, on the registry's writer thread. Call this function last in
 * a worker's step. Always returns false, so that the step can end with `return
 * server_request_write(…)`. */
bool server_request_write(struct server_exchange *exchange,
                          bool (*work)(struct server_exchange *exchange));

/* Runs `work`, which makes a list, on the registry's reader thread. Last call of a handler. */
void server_request_list(struct server_exchange *exchange,
                         bool (*work)(struct server_exchange *exchange));

#define SERVER_REQUEST_SHORT_LIST 16 /* most items of a list that an HTTP thread makes */

/* Takes memory, which the exchange holds until it ends. False with the problem of `what`. */
bool server_request_take(struct server_exchange *exchange, const char *what, size_t bytes,
                         struct proto_problem *problem);

/* Reserves the memory that a document parsed from this text will need. When the caller frees the
 * document, it calls server_request_end_parsing, which returns the memory. Problem:
 * insufficient_memory. */
bool server_request_begin_parsing(struct server_exchange *exchange, const char *text, size_t size,
                                  struct proto_problem *problem);
void server_request_end_parsing(struct server_exchange *exchange);

/* Parses the body as a JSON document, owned by the caller (json_decref, then
 * server_request_end_parsing). NULL: unsupported_media_type, invalid_request or
 * insufficient_memory. */
json_t *server_request_document(struct server_exchange *exchange, struct proto_problem *problem);

/* Begins an answer that is a stream of that media type. The caller writes its text to `*relay`, and
 * owns the relay. Returns an exchange for the rest of the work. The caller queues its job
 * (server_request_go_on) after it has added the answer's headers. NULL: out of memory, and nothing
 * has changed. */
struct server_exchange *server_request_stream(struct server_exchange *exchange,
                                              const struct server_transport *transport,
                                              const char *media_type, struct server_relay **relay);
void server_request_go_on(struct server_exchange *rest);

/* Replies with the problem of a store's outcome. */
void server_request_fail(struct server_exchange *exchange, enum server_outcome outcome);

/* Returns whether a surface was stored; otherwise replies with the problem. */
bool server_request_check_stored(struct server_exchange *exchange, enum server_outcome outcome);

#endif
