/* Jobs: the table of operations that were accepted to be answered later (202); async.h is one of
 * them. What workers run is smaller: job.h.
 *
 *     job = server_jobs_start(jobs, exchange, &problem);     the request of the exchange becomes a
 * job
 *     ... server_jobs_look(job);                             how it is getting on
 *     server_async_release(job);
 *
 * DESIGN. States: queued -> running -> done | failed, and cancelled from the first two. Cancelled
 * is what the client sees at once; the exchange, which nobody wants any more, is refused where it
 * waits (job.h) or stopped by its control, and its answer is dropped.
 *
 * Bounds: ended jobs are dropped after a time, and before it when there are too many or their
 * answers have too many bytes (SERVER_BUDGET_JOBS): then the oldest of the key that has the most
 * (holdings.h), so that no tenant loses its answers to another one that has more. Jobs that have
 * not ended are never dropped; where there are keys a tenant has no more of them than it leaves
 * places free. Ids grow, so the table is in the order of both id and age.
 *
 * One mutex guards the table and states; under it nothing calls out, but the budget gets bytes
 * back. All functions are thread-safe. */
#ifndef SERVER_JOBS_JOBS_H
#define SERVER_JOBS_JOBS_H

#include "server/jobs/async.h"

struct server;
struct server_jobs;

/* `server` is borrowed. NULL without memory. */
struct server_jobs *server_jobs_create(struct server *server);

/* No exchange is deferred any more. NULL is harmless. */
void server_jobs_destroy(struct server_jobs *jobs);

/* Makes a job of a request whose body is there, and begins it; the caller has a reference. The
 * exchange can be answered, but its body and parameters are the job's. NULL with overloaded,
 * draining or insufficient_memory. */
struct server_async *server_jobs_start(struct server_jobs *jobs, struct server_exchange *exchange,
                                       struct proto_problem *problem);

/* The tenant's job of that id, for the caller to release; NULL: he has none, or none any more. */
struct server_async *server_jobs_find(struct server_jobs *jobs, const char *tenant, const char *id,
                                      size_t size);

/* At most `most` of the tenant's jobs, whose ids follow `after` (NULL: from the first), for the
 * caller to release; returns how many. */
uint32_t server_jobs_list(struct server_jobs *jobs, const char *tenant, const char *after,
                          uint32_t most, struct server_async **out);

/* Cancels a job that has not ended, removes one that has. */
void server_jobs_cancel(struct server_jobs *jobs, struct server_async *job);

/* True when there are no jobs, ended or not. NULL: true. */
bool server_jobs_is_empty(struct server_jobs *jobs);

/* Drops the jobs that ended too long ago; looks once a second. NULL is harmless. */
void server_jobs_sweep(struct server_jobs *jobs, uint64_t now_ns);

/* Refuses the jobs that were not begun, and coming ones. */
void server_jobs_drain(struct server_jobs *jobs);

struct server_jobs_statistics {
    uint64_t now[PROTO_JOB_STATE_COUNT];   /* jobs in the table */
    uint64_t ended[PROTO_JOB_STATE_COUNT]; /* since the start; of the last three states */
};

/* Of a tenant (NULL: of all, and only then `ended`). `jobs` NULL: all zero. */
struct server_jobs_statistics server_jobs_statistics(struct server_jobs *jobs, const char *tenant);

/* --- one job ---------------------------------------------------------------------------------- */

/* How it is getting on. What the pointers point to lives as long as the caller's reference. */
struct proto_job server_jobs_look(struct server_async *job);

/* --- for a job on its way (async.c) ----------------------------------------------------------- */

/* Queued, it is running from now on. */
void server_jobs_begin(struct server_async *job);

/* It is answered: done or failed, by what it has kept, unless it was cancelled. Its state. */
enum proto_job_state server_jobs_end(struct server_async *job);

/* Wakes those who follow its events. */
void server_jobs_tell(struct server_async *job);

/* Makes room for the job's answer of so many bytes, which it holds then, if need be by dropping
 * jobs that have ended. */
bool server_jobs_reserve(struct server_async *job, size_t bytes);
void server_jobs_give(struct server_jobs *jobs, size_t bytes); /* takes no lock */

#endif
