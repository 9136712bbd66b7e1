/* Request: functions by which all handlers read requests. */
#pragma once

#include "proto/json/decode.h"
#include "proto/http/page.h"
#include "server/exchange/exchange.h"
#include "server/exchange/relay.h"
#include "server/surfaces/registry.h"

/* Returns the kind of surface of a route "/v1/<plural>…"; for other routes, the kind `mesh`. */
const struct server_kind *server_request_kind(const struct server_exchange *exchange);

/* Reads the key of the surface (tenant, kind, name) from the path. The key borrows strings of the
 * exchange. If the name is invalid, replies with a problem and returns false. */
bool server_request_key(struct server_exchange *exchange, struct server_key *key);

/* Called by operations without parameters. If the request has parameters, replies with a problem
 * and returns false. */
bool server_request_is_plain(struct server_exchange *exchange);

/* Reads the seconds that the request may wait. Returns false after replying with a problem. */
bool server_request_wait(struct server_exchange *exchange, uint64_t *wait_s);

/* Returns the time of gd_now_ns at which a wait of `wait_s` seconds ends. The wait ends at the
 * latest one second before the deadline. */
uint64_t server_request_wait_end(const struct server_exchange *exchange, uint64_t wait_s);

/* Read the requested page of a list. The second function also reads `prefix`, which selects names.
 * Returns false after replying with a problem. */
bool server_request_page(struct server_exchange *exchange, struct proto_page *page);
bool server_request_page_of_names(struct server_exchange *exchange, struct proto_page *page);

/* Finds and retains the record of the surface in the path. Returns false after replying with a
 * problem. */
bool server_request_record(struct server_exchange *exchange, struct server_listed *out);

/* Returns the surface in the path if it is in memory; the exchange has the reference. Checks the
 * preconditions of a POST; those of a GET are checked together with its answer (reply.c). If the
 * result is NULL, the handler must return at once: the exchange has a problem as its reply, or a
 * worker loads the surface and then calls the handler again. */
struct server_surface *server_request_surface(struct server_exchange *exchange);

/* Allocates the handler's state, all zero, and keeps it (server_exchange_keep). Returns NULL after
 * replying with a problem. */
void *server_request_allocate(struct server_exchange *exchange, size_t size,
                              void (*free_state)(void *state));

/* Called before the handler of a request about a surface. Returns true if the exchange is deferred;
 * a worker then applies the changes of other daemons before it calls the handler. */
bool server_request_follows_first(struct server_exchange *exchange);

/* Runs `work`, which stores something, on the registry's writer thread. Call this function last in
 * a worker's step. Always returns false, so that the step can end with `return
 * server_request_write(…)`. */
bool server_request_write(struct server_exchange *exchange,
                          bool (*work)(struct server_exchange *exchange));

/* Runs `work`, which makes a list, on the registry's reader thread. This must be the last call of a
 * handler. */
void server_request_list(struct server_exchange *exchange,
                         bool (*work)(struct server_exchange *exchange));

/* largest number of items in a list that an HTTP thread makes */
#define SERVER_REQUEST_SHORT_LIST 16

/* Takes memory from the budget. The exchange holds this memory until it ends. On failure, returns
 * false with a problem that names `what`. */
bool server_request_take(struct server_exchange *exchange, const char *what, size_t bytes,
                         struct proto_problem *problem);

/* Returns true if a mesh was written as a file. Otherwise returns false with the problem. */
bool server_request_check_file(enum gd_status status, struct proto_problem *problem);

/* Reserves the memory that a document parsed from this text will need. After freeing the document,
 * the caller calls server_request_end_parsing, which returns the memory. Problem:
 * insufficient_memory. */
bool server_request_begin_parsing(struct server_exchange *exchange, const char *text, size_t size,
                                  struct proto_problem *problem);
void server_request_end_parsing(struct server_exchange *exchange);

/* Returns true unless Content-Type names another type than JSON. */
bool server_request_is_json(const struct server_exchange *exchange);

/* Parses the body as a JSON document. The caller owns the document, and ends it by json_decref and
 * then server_request_end_parsing. On failure, returns NULL with unsupported_media_type,
 * invalid_request or insufficient_memory. */
json_t *server_request_document(struct server_exchange *exchange, struct proto_problem *problem);

/* Begins an answer that is a stream of that media type. The caller owns `*relay`, and writes the
 * text of the answer to it. Returns an exchange for the rest of the work. After adding the answer's
 * headers, the caller queues the job of this exchange (server_request_go_on). If out of memory,
 * returns NULL and changes nothing. */
struct server_exchange *server_request_stream(struct server_exchange *exchange,
                                              const struct server_transport *transport,
                                              const char *media_type, struct server_relay **relay);
void server_request_go_on(struct server_exchange *rest);

/* Replies with the problem of a store's outcome. */
void server_request_fail(struct server_exchange *exchange, enum server_outcome outcome);

/* Returns whether a surface was stored; otherwise replies with the problem. */
bool server_request_check_stored(struct server_exchange *exchange, enum server_outcome outcome);
