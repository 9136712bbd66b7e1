/* Batch queue: batches (proto/many.h) as rows: what they ask, and each item's lease and answer.
 * Whichever daemon has time takes the next item.
 *
 *     batches  id, tenant, document, etag, items, created, cancelled
 *     items    batch, item, lease, node, attempts, status, answer
 *
 * DESIGN. At least once: who takes an item has it for LEASE, and renews that while it works; the
 * item of one who is gone is taken by another. An answer is written once: the first that comes
 * stays. So each statement can be run again, and a daemon that was slow or cut off does no harm.
 * Leases are in the time of the daemons' own clocks, which may differ by much less than a lease; if
 * they differ by more an item is worked on twice. An item whose daemon has died over it too often
 * is given up.
 *
 * Thread-safe. Outcomes as sql.h. */
#ifndef SERVER_JOBS_BATCH_QUEUE_H
#define SERVER_JOBS_BATCH_QUEUE_H

#include "server/http/etag.h"
#include "server/store/key.h"
#include "server/store/sql.h"

#define SERVER_BATCH_ID    25    /* with the NUL */
#define SERVER_BATCH_LEASE 15000 /* ms */
#define SERVER_BATCH_TRIES 5

/* The statements that make the tables in SQLite, NULL-terminated (PostgreSQL's:
 * store/postgres/schema.c). */
extern const char *const server_batch_queue_tables[];

struct server_batch {
    char id[SERVER_BATCH_ID];
    int64_t items, created; /* created: seconds since 1970 */
    bool is_cancelled;
    int64_t done, failed; /* items that have an answer; those whose answer is a problem */
};

/* A batch that begins: nothing of it is done. All borrowed. */
struct server_batch_order {
    const struct server_batch *batch; /* its name, items and time */
    const char *tenant;
    const void *document; /* as it was sent */
    size_t size;
    const char *etag; /* of the mesh that all items are about, "": of several */
};

/* Adds a batch. Once: the second time changes nothing. */
enum server_store_outcome server_batch_queue_add(struct server_store_sql *sql,
                                                 const struct server_batch_order *order);

/* How many batches the tenant has. */
enum server_store_outcome server_batch_queue_count(struct server_store_sql *sql, const char *tenant,
                                                   int64_t *count);

/* The tenant's batch; ABSENT. */
enum server_store_outcome server_batch_queue_find(struct server_store_sql *sql, const char *tenant,
                                                  const char *id, struct server_batch *out);

/* Up to `most` of the tenant's batches with ids after `after` ("": from the first). */
enum server_store_outcome server_batch_queue_list(struct server_store_sql *sql, const char *tenant,
                                                  const char *after, uint32_t most,
                                                  struct server_batch *out, uint32_t *count);

/* The document of a batch, malloc'ed; ABSENT. */
enum server_store_outcome server_batch_queue_document(struct server_store_sql *sql, const char *id,
                                                      void **document, size_t *size);

/* Shows the answers of items after `after`, in their order: item, status, answer. */
enum server_store_outcome server_batch_queue_answers(struct server_store_sql *sql, const char *id,
                                                     int64_t after, uint32_t most,
                                                     server_sql_visit *visit, void *user);

/* No more items are begun. */
enum server_store_outcome server_batch_queue_cancel(struct server_store_sql *sql, const char *id);
enum server_store_outcome server_batch_queue_remove(struct server_store_sql *sql, const char *id);

struct server_batch_claim {
    char id[SERVER_BATCH_ID], tenant[SERVER_TENANT + 1], etag[SERVER_ETAG];
    int64_t item, attempts;
};

/* Takes the next item. Tenants take turns: it is of the first tenant behind `after` (the one
 * that the item before was of) that has an item to be done, and of its oldest batch. ABSENT:
 * there is none for now. */
enum server_store_outcome server_batch_queue_claim(struct server_store_sql *sql, const char *node,
                                                   const char *after,
                                                   struct server_batch_claim *out);

/* ABSENT: the item is another's, answered, or not wanted any more. */
enum server_store_outcome server_batch_queue_renew(struct server_store_sql *sql, const char *id,
                                                   int64_t item, const char *node);

/* Gives all items back that are not answered: at the start of the only daemon that there is. */
enum server_store_outcome server_batch_queue_return_all(struct server_store_sql *sql);

/* Gives an item back, for whoever has time after `pause_ms`. `was_tried`: the attempt counts. */
enum server_store_outcome server_batch_queue_return(struct server_store_sql *sql,
                                                    const struct server_batch_claim *claim,
                                                    const char *node, bool was_tried,
                                                    int64_t pause_ms);

/* The item's answer, unless it has one. */
enum server_store_outcome server_batch_queue_answer(struct server_store_sql *sql, const char *id,
                                                    int64_t item, unsigned status,
                                                    const void *answer, size_t size);

#endif
