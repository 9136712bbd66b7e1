/* Workers: a bounded queue of jobs, shared fairly by tenants (lanes.h), and the threads that run
 * them.
 *
 * DESIGN. Each submitted job ends in exactly one call of `run` that does not park it or of `refuse`
 * (job.h); a parked one comes back through server_workers_resume, or waits here for an unpark. One
 * mutex guards queue and state; `run` and `refuse` are called without it, so they may take any
 * lock.
 *
 * Background jobs are for idle times: one at a time, begun when the queue is empty. Such a job
 * yields every millisecond or so while it computes: when all threads are at work it runs what is
 * queued itself, before it goes on. So no work is lost, and it costs a request a millisecond,
 * unless it is at the disk just then (landmarks.h).
 *
 * States: open -> cancelled (jobs in the queue and coming ones are refused, running ones see
 * server_workers_cancelled and stop) -> destroyed. */
#ifndef SERVER_WORK_WORKERS_H
#define SERVER_WORK_WORKERS_H

#include <stdbool.h>
#include <stdint.h>

#include "server/work/job.h"

struct server_workers;

/* Starts `count` threads; at most `queue_length` jobs wait, and as many patient ones. NULL when
 * memory or threads can't be had. */
struct server_workers *server_workers_create(uint32_t count, uint32_t queue_length);

/* Starts spare threads: each begins a job only when all others are busy and the job's tenant is
 * owed it (lanes.h). False: memory or threads are short. Before any job. */
bool server_workers_add_spare(struct server_workers *workers, uint32_t count);

/* Tenants share the queue: none takes more places than it leaves free. Before any job. */
void server_workers_share(struct server_workers *workers);

/* Queues a job; false when the queue is full (the job stays the caller's). After a cancel the job
 * is refused at once. */
bool server_workers_submit(struct server_workers *workers, struct server_job *job);

/* Queues a parked job again, ahead of the others of its tenant and whatever the queue's length:
 * it was admitted before. */
void server_workers_resume(struct server_workers *workers, struct server_job *job);

/* Queues a background job; it is refused at once after a cancel. Their deadlines are looked at when
 * they begin. */
void server_workers_submit_background(struct server_workers *workers, struct server_job *job);

/* Lets a running job wait for somebody who calls unpark: the last act of its run. It is refused
 * when it gets late or at a cancel; false after one: it is not parked, and goes on. */
bool server_workers_park(struct server_workers *workers, struct server_job *job);

/* Queues a parked job again, ahead of the others. A job that is not parked any more, or not there
 * any more, is let be. Takes no lock but its own, and calls nothing. */
void server_workers_unpark(struct server_workers *workers, const struct server_job *job);

/* Takes a background job back that was not begun: it is the caller's again. False: it runs, or ran,
 * or was refused. The caller sees to it that the job is still there to be asked about. */
bool server_workers_withdraw(struct server_workers *workers, struct server_job *job);

/* To be called by a background job while it runs: runs the jobs that no other thread is free for.
 */
void server_workers_yield(struct server_workers *workers);

/* Refuses the background jobs that were not begun. */
void server_workers_refuse_background(struct server_workers *workers, enum server_refusal why);

/* Refuses the queued and parked jobs that are late. */
void server_workers_expire(struct server_workers *workers, uint64_t now_ns);

/* Refuses all queued, parked and coming jobs, those of the background too, and makes
 * server_workers_cancelled true. */
void server_workers_cancel(struct server_workers *workers);
bool server_workers_cancelled(struct server_workers *workers);

/* To be called by running work about every millisecond: where requests come densely, the thread
 * gives its core up for a moment; long work goes behind all others (yielding.h). False: after a
 * cancel. */
bool server_workers_go_on(struct server_workers *workers);

struct server_workers_load {
    /* running: with those on spare threads, without the background job, 0 or 1, that runs */
    uint32_t threads, running;
    /* urgent: of those that wait, those that are not patient */
    uint32_t queued, urgent, background;
};
struct server_workers_load server_workers_load(struct server_workers *workers);

/* Does one of them run a job? Takes no lock. */
bool server_workers_are_busy(const struct server_workers *workers);

/* Cancels, waits for the running jobs, frees. NULL is harmless. */
void server_workers_destroy(struct server_workers *workers);

#endif
