/* Many: a batch of POST /v1/batches. Any daemon of the store may process its items. Each item is a
 * separate query: for "all-pairs" the distances from one vertex to all, for "fields" the field on
 * one mesh. */
#pragma once

#include "generated/answers.h"
#include "proto/json/problem.h"
#include "proto/json/writer.h"
#include "proto/values/mesh.h"

struct json_t; /* declared by jansson */

/* limit on the items of a batch, and on the vertices in an item's request */
#define PROTO_MANY_ITEMS 20000
#define PROTO_MANY_ID    25 /* bytes of a batch's id, with the NUL */

enum proto_many_query { PROTO_MANY_ALL_PAIRS, PROTO_MANY_FIELDS };

struct proto_many {
    enum proto_many_query query;
    uint32_t item_count;
    struct json_t *document; /* checked, owned */
};

/* Takes over a reference of the document and checks it as far as possible without the meshes. On
 * failure returns false with the problem, and the caller keeps the reference. */
bool proto_many_decode(struct json_t *document, struct proto_many *out,
                       struct proto_problem *problem);

/* Like proto_many_decode, but parses text. */
bool proto_many_read(const void *text, size_t size, struct proto_many *out,
                     struct proto_problem *problem);
void proto_many_free(struct proto_many *many); /* accepts all zero */

/* Returns the name of an item's mesh, borrowed. */
const char *proto_many_mesh(const struct proto_many *many, uint32_t item);

/* Returns the part of the item's request path after "/v1/meshes/{name}/", a static string. Writes
 * the body of the item's request to an initialized writer. */
const char *proto_many_ask(const struct proto_many *many, uint32_t item, struct proto_writer *body);

/* --- a page of answers ------------------------------------------------------------------------ */

#define PROTO_MANY_WAIT 60 /* longest time, in seconds, that a request waits for new answers */

struct proto_many_page {
    uint32_t limit;
    /* true if `cursor` was sent, and items are listed in the order of their answers */
    bool is_by_number;
    int64_t after; /* number of an item (-1 means before the first one), or of an answer */
    uint64_t wait_s;
};

/* Reads limit, after or cursor, and wait; rejects any other parameter. Problem: invalid_request. */
bool proto_many_parse_page(const struct proto_parameters *parameters, struct proto_many_page *out,
                           struct proto_problem *problem);

/* Reads wait; rejects any other parameter. Problem: invalid_request. */
bool proto_many_parse_wait(const struct proto_parameters *parameters, uint64_t *wait_s,
                           struct proto_problem *problem);

/* --- the state of a batch --------------------------------------------------------------------- */

/* Written by proto_batch_encode (generated/answers.h). */
struct proto_many_state {
    char id[PROTO_MANY_ID];
    int64_t items, created; /* `created` in seconds since 1970 */
    int64_t done, failed;   /* items with an answer; among them, items whose answer is a problem */
    bool is_cancelled;
};

/* Returns whether the batch is done or cancelled. */
bool proto_many_has_ended(const struct proto_many_state *state);

/* Returns "running", "done" or "cancelled". */
const char *proto_many_state_name(const struct proto_many_state *state);

/* Writes an item's answer. `answer` is JSON. */
void proto_many_encode_answer(struct proto_writer *writer, const struct proto_many *many,
                              uint32_t item, unsigned status, const char *answer, size_t size);

/* Ends a page of answers with the batch's state. `next` is the `after` or `cursor` of the next
 * page, or -1 if there is none. */
void proto_many_end_page(struct proto_writer *writer, const struct proto_many_state *state,
                         int64_t next);
