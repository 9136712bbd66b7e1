/* Many: a batch that is worked on item by item, by whichever daemon has time: POST /v1/batches. An
 * item is a question of its own, as a client could ask it.
 *
 *     {"query": "all-pairs", "mesh": "bunny", "vertices": [0, 17, 2040]}
 *         an item a source: its distances to all of them
 *     {"query": "fields", "meshes": ["a", "b"], "set": {…}, "max_distance"?}
 *         an item a mesh: the field of that set */
#ifndef PROTO_MANY_H
#define PROTO_MANY_H

#include "proto/json/problem.h"
#include "proto/json/writer.h"
#include "proto/values/mesh.h"

struct json_t; /* of jansson */

/* most of a batch: as many vertices as the question of an item can hold */
#define PROTO_MANY_ITEMS 20000

enum proto_many_query { PROTO_MANY_ALL_PAIRS, PROTO_MANY_FIELDS };

struct proto_many {
    enum proto_many_query query;
    uint32_t item_count;
    struct json_t *document; /* checked, owned */
};

/* Takes over a reference of the document, which is checked as far as it can be without the meshes.
 * False with the problem: the document is the caller's still. */
bool proto_many_decode(struct json_t *document, struct proto_many *out,
                       struct proto_problem *problem);

/* The same of a text. */
bool proto_many_read(const void *text, size_t size, struct proto_many *out,
                     struct proto_problem *problem);
void proto_many_free(struct proto_many *many); /* all zero is harmless */

/* The mesh of an item; borrowed. */
const char *proto_many_mesh(const struct proto_many *many, uint32_t item);

/* "all-pairs" or "fields". Static string. */
const char *proto_many_query_name(enum proto_many_query query);

/* The item's question: what follows "/v1/meshes/{name}/", a static string, and its body, written to
 * a writer that was initialized. */
const char *proto_many_ask(const struct proto_many *many, uint32_t item, struct proto_writer *body);

/* --- a page of answers ------------------------------------------------------------------------ */

#define PROTO_MANY_WAIT 60 /* seconds; the most that a request waits for news */

struct proto_many_page {
    uint32_t limit;
    bool is_by_number; /* `cursor` was sent: in the order in which the items were answered */
    int64_t after;     /* an item (-1: from the first), or the number of an answer */
    uint64_t wait_s;
};

/* Reads limit, after or cursor, and wait, and refuses any other parameter. invalid_request. */
bool proto_many_parse_page(const struct proto_parameters *parameters, struct proto_many_page *out,
                           struct proto_problem *problem);

/* Reads wait, and refuses any other parameter. invalid_request. */
bool proto_many_parse_wait(const struct proto_parameters *parameters, uint64_t *wait_s,
                           struct proto_problem *problem);

/* --- told ------------------------------------------------------------------------------------- */

struct proto_many_state {
    const char *id;
    int64_t items, done, failed, created;
    bool is_cancelled;
};

/* Done or cancelled. */
bool proto_many_has_ended(const struct proto_many_state *state);

/* Writes {"id", "state": "running"|"done"|"cancelled", "items", "done", "failed", "progress",
 * "created"}. */
void proto_many_encode(struct proto_writer *writer, const struct proto_many_state *state);

/* Writes {"item", "status", "mesh", "vertex"?, "answer"|"problem"}; `answer` is JSON. */
void proto_many_encode_answer(struct proto_writer *writer, const struct proto_many *many,
                              uint32_t item, unsigned status, const char *answer, size_t size);

/* Ends a page of answers, with the state of the batch. `next`: the `after` or `cursor` of the next
 * page; -1: none. */
void proto_many_end_page(struct proto_writer *writer, const struct proto_many_state *state,
                         int64_t next);

#endif
