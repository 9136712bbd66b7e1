/* Workers: the threads that run jobs, and the bounded queue in front of them (lanes.h).
 *
 * DESIGN. Each submitted job ends in exactly one call of `refuse`, or of a `run` that does not park
 * it. A parked job comes back through server_workers_resume, or waits here for an unpark. One mutex
 * guards the queue. `run` and `refuse` are called without it, so they may take any lock.
 *
 * A background job starts when the queue is empty; one runs at a time. It calls
 * server_workers_yield about every millisecond, to run the queued jobs that find no free thread.
 *
 * States: open -> cancelled (queued and new jobs are refused, running ones see
 * server_workers_cancelled and stop) -> destroyed. All functions are thread-safe. */
#ifndef SERVER_WORK_WORKERS_H
#define SERVER_WORK_WORKERS_H

#include <stdbool.h>
#include <stdint.h>

#include "server/work/lanes.h"

struct server_workers;

/* Starts `count` threads. At most `queue_length` urgent jobs and as many patient ones wait. NULL
 * without memory or threads. */
struct server_workers *server_workers_create(uint32_t count, uint32_t queue_length);

/* Starts as many spare threads (lanes.h), before the first job. Returns false if one fails. */
bool server_workers_add_spare(struct server_workers *workers);

/* Lets tenants share the queue (lanes.h). Call it before the first job. */
void server_workers_share(struct server_workers *workers);

/* Queues a job. Returns false, and leaves the job to the caller, when the queue is full. After a
 * cancel the job is refused at once. */
bool server_workers_submit(struct server_workers *workers, struct server_job *job);

/* Queues a parked job ahead of its lane, even into a full queue: it was admitted before. */
void server_workers_resume(struct server_workers *workers, struct server_job *job);

/* Queues a background job. Its deadline is checked when it starts. */
void server_workers_submit_background(struct server_workers *workers, struct server_job *job);

/* Parks a job at an address, until it is unparked there, or until a time (0: none): the last act of
 * its `run`. It is refused when it gets late or at a cancel. Returns false after a cancel: the job
 * is not parked. This and the next function take only the workers' lock. */
bool server_workers_park(struct server_workers *workers, struct server_job *job, const void *at,
                         uint64_t until_ns);

/* Queues the jobs that are parked there, ahead of their lanes; or refuses them. */
void server_workers_unpark(struct server_workers *workers, const void *at);
void server_workers_refuse_parked(struct server_workers *workers, const void *at,
                                  enum server_refusal why);

/* Are jobs parked there? */
bool server_workers_await(struct server_workers *workers, const void *at);

/* Removes a background job that has not started: the caller owns it again. Returns false when it
 * has started or was refused. The job must still exist. */
bool server_workers_withdraw(struct server_workers *workers, struct server_job *job);

/* For a running background job: runs the jobs for which no other thread is free. */
void server_workers_yield(struct server_workers *workers);

/* Refuses the background jobs that have not started. */
void server_workers_refuse_background(struct server_workers *workers, enum server_refusal why);

/* Refuses the queued and parked jobs that are late, and queues those whose parking has ended. */
void server_workers_expire(struct server_workers *workers, uint64_t now_ns);

/* Refuses all queued, parked, background and future jobs. */
void server_workers_cancel(struct server_workers *workers);
bool server_workers_cancelled(struct server_workers *workers);

/* For running jobs, about every millisecond. Returns false after a cancel. */
bool server_workers_go_on(struct server_workers *workers);

struct server_workers_load {
    uint32_t threads;    /* without spare ones */
    uint32_t running;    /* jobs, also on spare threads, without the background job */
    uint32_t queued;     /* jobs, without background jobs */
    uint32_t background; /* 0 or 1: a background job runs */
};
struct server_workers_load server_workers_load(struct server_workers *workers);

/* Does a worker that is not spare run a job? Takes no lock. */
bool server_workers_are_busy(const struct server_workers *workers);

/* Cancels, waits for the running jobs, and frees. NULL is harmless. */
void server_workers_destroy(struct server_workers *workers);

#endif
