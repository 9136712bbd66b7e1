/* Batch runner: this daemon's work on batches. All daemons of a store share that work, item by item
 * (batch_queue.h).
 *
 * DESIGN. A thread claims items from the queue while workers are free. Each item becomes an
 * exchange that goes through dispatch, handler and workers as a client's request does. The thread
 * receives the answer. Only this thread writes items of the queue: it renews leases, writes
 * answers, and returns items that failed for lack of time, memory or workers (503, 504, 507). A
 * drain returns all running items to the queue.
 *
 * The queue is in the store's database: in PostgreSQL, or in a SQLite file in the data folder,
 * which the first batch creates. With a store in memory, the queue is in memory, too. */
#pragma once

#include "server/config/config.h"
#include "server/exchange/exchange.h"
#include "server/jobs/batch_queue.h"

struct server_batch_runner;

/* Borrows host and configuration. If there is no memory or no thread, returns NULL with a sentence
 * in `error`. */
struct server_batch_runner *server_batch_runner_create(struct server_host *host,
                                                       const struct server_config *config,
                                                       char error[SERVER_ERROR]);

/* Stops starting items, and returns running items to the queue. */
void server_batch_runner_drain(struct server_batch_runner *runner);

/* Call this function when no item is running. NULL is allowed. */
void server_batch_runner_destroy(struct server_batch_runner *runner);

/* Returns the queue's database. If it can't be opened, returns NULL with a sentence. Call this
 * function on a worker. */
struct server_store_sql *server_batch_runner_sql(struct server_batch_runner *runner,
                                                 char error[SERVER_ERROR]);

/* Returns NULL, or a sentence with the reason why batches are not available. Thread-safe; `runner`
 * may be NULL. */
const char *server_batch_runner_health(struct server_batch_runner *runner);

/* Signals that the queue has a new batch. */
void server_batch_runner_wake(struct server_batch_runner *runner);

/* Cancels this daemon's items of a batch, or of all batches if `id` is NULL. Wakes the jobs that
 * wait for these batches. */
void server_batch_runner_cancel(struct server_batch_runner *runner, const char *id);

/* Returns the number of answers and changes that this daemon has written. */
uint64_t server_batch_runner_news(struct server_batch_runner *runner);

struct server_batch_wait {
    const char *id;    /* id of the batch */
    uint64_t news;     /* the value of server_batch_runner_news before the queue was read */
    uint64_t until_ns; /* end of the wait */
};

/* Parks a worker's job: the job waits without a worker until the batch may have changed. The job's
 * function `run` must call this last. Returns false if the job was not parked. */
bool server_batch_runner_wait(struct server_batch_runner *runner, struct server_job *job,
                              const struct server_batch_wait *wait);

struct server_batch_statistics {
    uint64_t answered, returned; /* numbers of items since the start */
    uint32_t running;
};
/* Returns zeros if `runner` is NULL. */
struct server_batch_statistics server_batch_runner_statistics(struct server_batch_runner *runner);
