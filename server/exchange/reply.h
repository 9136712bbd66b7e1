/* Reply: how a handler answers. Each server_reply_* ends the request; the first one counts. */
#ifndef SERVER_EXCHANGE_REPLY_H
#define SERVER_EXCHANGE_REPLY_H

#include "proto/http/asset.h"
#include "proto/json/writer.h"
#include "server/exchange/exchange.h"

/* Begins the text of an answer: of --max-answer bytes at most, in the memory budget from its first
 * byte on. */
void server_reply_writer(struct server_exchange *exchange, struct proto_writer *writer);

/* Adds a response header, cut to SERVER_HEADER_VALUE. `name` is static. */
void server_reply_header(struct server_exchange *exchange, const char *name, const char *format,
                         ...) __attribute__((format(printf, 3, 4)));

/* Adds the entity tag of the representation in that form of the resource `etag` (etag.h). */
void server_reply_tag(struct server_exchange *exchange, const char *etag, const char *form);

/* What the writer holds, as JSON or as another static media type; the writer is freed. A writer
 * that failed gives its problem. */
void server_reply_json(struct server_exchange *exchange, unsigned status,
                       struct proto_writer *writer);
void server_reply_text(struct server_exchange *exchange, unsigned status, const char *media_type,
                       struct proto_writer *writer);

/* Memory for an answer of so many bytes, to be handed to server_reply_bytes. NULL with a problem
 * replied. */
void *server_reply_allocate(struct server_exchange *exchange, size_t size);

/* Bytes made by malloc, which become the exchange's. What the exchange holds for them (`held`) is
 * counted as the answer's from now on, the rest is taken. A problem is replied, and the bytes are
 * freed, if there are too many. */
void server_reply_bytes(struct server_exchange *exchange, unsigned status, const char *media_type,
                        void *bytes, size_t size);

/* A body that comes as it happens; the stream becomes the exchange's. */
void server_reply_stream(struct server_exchange *exchange, unsigned status, const char *media_type,
                         struct server_stream *stream);

/* Whether such a body may come packed by gzip, and the headers that say how it comes. */
bool server_reply_takes_gzip(const struct server_exchange *exchange);
void server_reply_coding(struct server_exchange *exchange, bool is_packed);

/* A static file, in its compressed form where the client takes it. */
void server_reply_asset(struct server_exchange *exchange, const struct proto_asset *asset);

/* What the writer holds, perhaps nothing, then the lent bytes, which are neither copied nor
 * packed. */
void server_reply_lent(struct server_exchange *exchange, unsigned status, const char *media_type,
                       struct proto_writer *head, const struct server_lent *lent);

void server_reply_empty(struct server_exchange *exchange, unsigned status);
void server_reply_problem(struct server_exchange *exchange, const struct proto_problem *problem);

/* The problem as a sentence made here. */
void server_reply_refusal(struct server_exchange *exchange, enum proto_problem_code code,
                          const char *format, ...) __attribute__((format(printf, 3, 4)));

/* True, or false with not_acceptable replied, when the client takes no JSON. */
bool server_reply_accepts_json(struct server_exchange *exchange);

/* Finishes the answer: 304 when the client has it already, compression, the headers that every
 * answer has. Called once, after the reply, by a transport that brings the answer to its client
 * now. */
void server_reply_seal(struct server_exchange *exchange);

#endif
