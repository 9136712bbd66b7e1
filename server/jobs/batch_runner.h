/* Batch runner: this daemon's part in the work on batches, which any daemon of a store does item by
 * item (batch_queue.h).
 *
 * DESIGN. A thread claims items from the queue while workers are free. Each item becomes an
 * exchange that goes through dispatch, handler and workers as a client's request does. Its answer
 * comes back to the thread, which alone writes to the queue about items: it renews their leases,
 * writes answers and returns items that failed for want of time, memory or workers (503, 504, 507).
 * A drain returns all items under way.
 *
 * The queue is in the store's database: PostgreSQL, or SQLite in a file of the data folder that the
 * first batch creates; for a store in memory, in memory. */
#ifndef SERVER_JOBS_BATCH_RUNNER_H
#define SERVER_JOBS_BATCH_RUNNER_H

#include "server/config/config.h"
#include "server/exchange/exchange.h"
#include "server/jobs/batch_queue.h"

struct server_batch_runner;

/* Host and configuration are borrowed. NULL without memory or thread, with a sentence. */
struct server_batch_runner *server_batch_runner_create(struct server_host *host,
                                                       const struct server_config *config,
                                                       char *error, size_t error_size);

/* Starts no more items and returns those under way to the queue. */
void server_batch_runner_drain(struct server_batch_runner *runner);

/* No item is under way any more. NULL is harmless. */
void server_batch_runner_destroy(struct server_batch_runner *runner);

/* The queue's database. NULL with a sentence: it can't be opened. By workers. */
struct server_store_sql *server_batch_runner_sql(struct server_batch_runner *runner, char *error,
                                                 size_t error_size);

/* NULL, or a sentence: batches are not available. Thread-safe; NULL is harmless. */
const char *server_batch_runner_health(struct server_batch_runner *runner);

/* The queue has a new batch. */
void server_batch_runner_wake(struct server_batch_runner *runner);

/* Cancels this daemon's items of a batch and wakes those who wait for it; NULL: of all batches. */
void server_batch_runner_cancel(struct server_batch_runner *runner, const char *id);

/* The number of answers and changes that this daemon has written. */
uint64_t server_batch_runner_news(struct server_batch_runner *runner);

struct server_batch_wait {
    const char *id;    /* of the batch */
    uint64_t news;     /* those that are known: read before the queue was */
    uint64_t until_ns; /* the end */
};

/* For a worker: parks the running job until there may be news; the last act of its `run`. False:
 * not parked. */
bool server_batch_runner_wait(struct server_batch_runner *runner, struct server_job *job,
                              const struct server_batch_wait *wait);

struct server_batch_statistics {
    uint64_t answered, returned; /* items, since the start */
    uint32_t running;
};
/* NULL: all zero. */
struct server_batch_statistics server_batch_runner_statistics(struct server_batch_runner *runner);

#endif
