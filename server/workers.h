/* Workers: the second lane. A bounded queue of jobs and the threads that run them.
 *
 * DESIGN. Each submitted job ends in exactly one call of `run` that does not park it or of `refuse` (job.h); a parked
 * one comes back through server_workers_resume. One mutex guards queue and state; `run` and `refuse` are called
 * without it, so they may take any lock.
 *
 * States: open -> cancelled (jobs in the queue and coming ones are refused, running ones see
 * server_workers_cancelled and stop) -> destroyed. */
#ifndef SERVER_WORKERS_H
#define SERVER_WORKERS_H

#include <stdbool.h>
#include <stdint.h>

#include "server/job.h"

struct server_workers;

/* Starts `count` threads; at most `queue_length` jobs wait. NULL when memory or threads can't be had. */
struct server_workers *server_workers_create(uint32_t count, uint32_t queue_length);

/* Queues a job; false when the queue is full (the job stays the caller's). After a cancel the job is refused at
 * once. */
bool server_workers_submit(struct server_workers *workers, struct server_job *job);

/* Queues a parked job again, ahead of the others and whatever the queue's length: it was admitted before. */
void server_workers_resume(struct server_workers *workers, struct server_job *job);

/* Refuses the queued jobs whose deadline has passed. */
void server_workers_expire(struct server_workers *workers, uint64_t now_ns);

/* Refuses all queued and coming jobs and makes server_workers_cancelled true. */
void server_workers_cancel(struct server_workers *workers);
bool server_workers_cancelled(struct server_workers *workers);

struct server_workers_load {
    uint32_t threads, running, queued;
};
struct server_workers_load server_workers_load(struct server_workers *workers);

/* Cancels, waits for the running jobs, frees. NULL is harmless. */
void server_workers_destroy(struct server_workers *workers);

#endif
