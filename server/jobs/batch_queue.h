/* Batch queue: stores batches (proto/queries/many.h) as rows of a database: their documents, and
 * each item's lease and answer. The first daemon with a free worker claims the next item.
 *
 *     batches  id, tenant, document, etag, items, created, cancelled
 *     items    batch, item, lease, node, attempts, status, answer, number
 *
 * DESIGN. Each item is computed at least once. A daemon claims an item for the time
 * SERVER_BATCH_LEASE, and renews this lease while it works. When the lease of a dead daemon ends,
 * another daemon claims the item. The first answer of an item is kept, later ones are ignored. So
 * every statement can be repeated, and a slow or isolated daemon does no harm. Leases use the
 * daemons' own clocks: if these differ by more than a lease, an item may be computed twice. After
 * SERVER_BATCH_TRIES attempts an item fails.
 *
 * The answers of a batch have the numbers 1, 2, … in the order in which they are written. Number n
 * is visible only after all smaller numbers, so a reader that continues after n skips no answer.
 *
 * Thread-safe. Outcomes are those of sql.h. */
#pragma once

#include "proto/queries/many.h"
#include "server/exchange/etag.h"
#include "server/store/kind.h"
#include "server/store/sql.h"

#define SERVER_BATCH_LEASE   15000 /* ms */
#define SERVER_BATCH_TRIES   5
#define SERVER_BATCH_ANSWERS 16 /* number of answers read at once; answers may be large */

/* The steps that create the tables in SQLite, NULL-terminated (for PostgreSQL:
 * store/postgres/schema.c). New steps are appended; old steps never change. */
extern const char *const server_batch_queue_tables[];

/* A new batch; all borrowed. */
struct server_batch_order {
    const struct proto_many_state *batch; /* id, items and time */
    const char *tenant;
    const void *document; /* as the client sent it */
    size_t size;
    const char *etag; /* ETag of the mesh that all items use; "" if they use several meshes */
};

/* Adds a batch. Has no effect if the batch exists. */
enum server_outcome server_batch_queue_add(struct server_store_sql *sql,
                                           const struct server_batch_order *order);

/* Counts the tenant's batches. */
enum server_outcome server_batch_queue_count(struct server_store_sql *sql, const char *tenant,
                                             int64_t *count);

/* Finds the tenant's batch. Returns ABSENT if there is none. */
enum server_outcome server_batch_queue_find(struct server_store_sql *sql, const char *tenant,
                                            const char *id, struct proto_many_state *out);

struct server_batch_list {
    struct proto_many_state *batches; /* room for `most` */
    uint32_t most, count;
};

/* Lists the tenant's batches with ids above `after`; "" means all. */
enum server_outcome server_batch_queue_list(struct server_store_sql *sql, const char *tenant,
                                            const char *after, struct server_batch_list *list);

/* Reads the document of a batch; the caller frees it. Returns ABSENT if there is no such batch. */
enum server_outcome server_batch_queue_document(struct server_store_sql *sql, const char *id,
                                                void **document, size_t *size);

/* A position in the answers of a batch. */
struct server_batch_place {
    const char *id;
    int64_t after;     /* number of an item or of an answer; -1 means before the first one */
    bool is_by_number; /* true if answers are sorted by number, false if by item */
};

/* Visits the next SERVER_BATCH_ANSWERS answers. The columns of a row are item, status, answer, and
 * the value by which the rows are sorted (number or item). */
enum server_outcome server_batch_queue_answers(struct server_store_sql *sql,
                                               const struct server_batch_place *place,
                                               server_sql_visit *visit, void *user);

/* server_batch_queue_cancel ends a batch: no more of its items are claimed.
 * server_batch_queue_remove deletes the batch. */
enum server_outcome server_batch_queue_cancel(struct server_store_sql *sql, const char *id);
enum server_outcome server_batch_queue_remove(struct server_store_sql *sql, const char *id);

struct server_batch_claim {
    char id[PROTO_MANY_ID], tenant[SERVER_TENANT + 1], etag[SERVER_ETAG];
    int64_t item, attempts;
};

/* Claims the next item for the daemon `node`. The function chooses the first tenant after `after`,
 * in cyclic order, that has an unclaimed item. It claims an item of this tenant's oldest batch.
 * `after` is the tenant of the item that was claimed last. Returns ABSENT if there is no item at
 * the moment. */
enum server_outcome server_batch_queue_claim(struct server_store_sql *sql, const char *node,
                                             const char *after, struct server_batch_claim *out);

/* Renews the lease of an item. Returns ABSENT if another daemon has claimed the item, or if it is
 * answered or cancelled. */
enum server_outcome server_batch_queue_renew(struct server_store_sql *sql,
                                             const struct server_batch_claim *claim,
                                             const char *node);

/* Returns an item to the queue. Daemons may claim it after `pause_ms`. `was_tried` is true if the
 * attempt counts. */
enum server_outcome server_batch_queue_return(struct server_store_sql *sql,
                                              const struct server_batch_claim *claim,
                                              const char *node, bool was_tried, int64_t pause_ms);

/* Returns all items without an answer to the queue. Called at the start of the only daemon that
 * uses the queue. */
enum server_outcome server_batch_queue_return_all(struct server_store_sql *sql);

/* Writes the item's answer, unless it has one or the batch is cancelled. */
enum server_outcome server_batch_queue_answer(struct server_store_sql *sql,
                                              const struct server_batch_claim *claim,
                                              unsigned status, const void *answer, size_t size);
