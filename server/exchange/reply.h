/* Reply: functions by which a handler answers. Each server_reply_… ends the request, except those
 * that only add headers or begin a text. */
#pragma once

#include "proto/http/asset.h"
#include "proto/json/writer.h"
#include "server/exchange/exchange.h"

/* Begins the text of an answer. The text has at most --max-answer bytes, which the memory budget
 * counts. */
void server_reply_writer(struct server_exchange *exchange, struct proto_writer *writer);

/* Adds a response header. Its value is truncated to SERVER_HEADER_VALUE bytes. `name` must be
 * static. */
void server_reply_header(struct server_exchange *exchange, const char *name, const char *format,
                         ...) __attribute__((format(printf, 3, 4)));

/* Adds the entity tag of a representation: `etag` is the resource's tag, `form` its form
 * (etag.h). */
void server_reply_tag(struct server_exchange *exchange, const char *etag, const char *form);

/* Reply with the text of the writer, as JSON or another static media type, and free the writer. If
 * the writer failed, reply with its problem. */
void server_reply_json(struct server_exchange *exchange, unsigned status,
                       struct proto_writer *writer);
void server_reply_text(struct server_exchange *exchange, unsigned status, const char *media_type,
                       struct proto_writer *writer);

/* Replies with bytes from malloc and takes them over. The answer takes over the budget bytes that
 * the exchange holds, and takes more if needed. If the budget has too few, frees the bytes and
 * replies with a problem. */
void server_reply_bytes(struct server_exchange *exchange, unsigned status, const char *media_type,
                        void *bytes, size_t size);

/* Replies with a stream and takes it over. */
void server_reply_stream(struct server_exchange *exchange, unsigned status, const char *media_type,
                         struct server_stream *stream);

/* Returns whether the client accepts gzip and is not a browser on this host. server_reply_coding
 * adds the headers Vary and Content-Encoding to a stream's answer. */
bool server_reply_takes_gzip(const struct server_exchange *exchange);
void server_reply_coding(struct server_exchange *exchange, bool is_packed);

/* Replies with a static file, compressed if the client accepts compression. */
void server_reply_asset(struct server_exchange *exchange, const struct proto_asset *asset);

/* Replies with the text of the writer, followed by the lent bytes. These are neither copied nor
 * compressed. */
void server_reply_lent(struct server_exchange *exchange, unsigned status, const char *media_type,
                       struct proto_writer *head, const struct server_lent *lent);

void server_reply_empty(struct server_exchange *exchange, unsigned status);
void server_reply_problem(struct server_exchange *exchange, const struct proto_problem *problem);

/* Replies with the problem if `is_well` is false. Returns `is_well`. */
bool server_reply_check(struct server_exchange *exchange, bool is_well,
                        const struct proto_problem *problem);

/* Formats a sentence and replies with a problem that contains it. */
void server_reply_refusal(struct server_exchange *exchange, enum proto_problem_code code,
                          const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Returns whether the client accepts JSON. If not, replies with not_acceptable. */
bool server_reply_accepts_json(struct server_exchange *exchange);

/* Finishes the answer: makes it a 304 if the client knows the tag, compresses the body, and adds
 * the headers that all answers have. Called once, after the reply, by a transport that sends the
 * answer immediately. */
void server_reply_seal(struct server_exchange *exchange);
