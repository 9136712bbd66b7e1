/* Batches: many-source work that any daemon of a store can take a part in, item by item
 * (batch_queue.h). This one's part.
 *
 * DESIGN. A thread of its own takes items from the queue while workers have time, and gives each to
 * them as an exchange of its own, which goes through the router's dispatch, a handler and the
 * workers as a job's does (jobs.h); so what an item is answered is what a client would have been.
 * The answer comes back to the thread, which alone speaks to the queue about items: it renews their
 * leases, writes answers, and returns what could not be done just now (503, 507). At a drain all
 * items under way are given back.
 *
 * The queue is in the store's database: PostgreSQL's, or SQLite's in a file of the data folder,
 * which the first batch makes; or, for a store in memory, in memory. */
#ifndef SERVER_JOBS_BATCHES_H
#define SERVER_JOBS_BATCHES_H

#include "server/jobs/batch_queue.h"

struct server;
struct server_batches;

/* NULL without memory or thread, with a sentence. */
struct server_batches *server_batches_create(struct server *server, char *error, size_t error_size);

/* No more items are begun, and those under way are given back. */
void server_batches_drain(struct server_batches *batches);

/* No item is under way any more. NULL is harmless. */
void server_batches_destroy(struct server_batches *batches);

/* The queue's database. NULL with a sentence: it can't be opened. By workers. */
struct server_store_sql *server_batches_sql(struct server_batches *batches, char *error,
                                            size_t error_size);

/* NULL, or a sentence: batches can't be had. Thread-safe; NULL is harmless. */
const char *server_batches_health(struct server_batches *batches);

/* There is something new to do. */
void server_batches_wake(struct server_batches *batches);

/* Ends this daemon's items of a batch that was cancelled. */
void server_batches_end(struct server_batches *batches, const char *id);

struct server_batches_statistics {
    uint64_t answered, returned; /* items, since the start */
    uint32_t running;
};
/* NULL: all zero */
struct server_batches_statistics server_batches_statistics(struct server_batches *batches);

#endif
