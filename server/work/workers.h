/* Workers: the threads that run jobs, and the bounded queue in front of them (lanes.h).
 *
 * DESIGN. Each submitted job ends with exactly one call of `refuse`, or with a call of `run` that
 * does not park it. A parked job waits for an event without a worker. It returns to the queue
 * through server_workers_resume or server_workers_unpark. One mutex guards the queue. `run` and
 * `refuse` are called without the mutex, so they may take any lock.
 *
 * States: open -> cancelled (queued and new jobs are refused, running ones see
 * server_workers_cancelled and stop) -> destroyed. All functions are thread-safe. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "server/work/lanes.h"

struct server_workers;

/* Starts `count` threads. Up to `queue_length` urgent jobs and as many patient ones can wait.
 * Returns NULL if there is no memory or no thread. */
struct server_workers *server_workers_create(uint32_t count, uint32_t queue_length);

/* Starts as many spare threads (lanes.h) as there are workers, before the first job. Returns false
 * if a thread can't be started. */
bool server_workers_add_spare(struct server_workers *workers);

/* Lets tenants share the queue (lanes.h). Call this function before the first job. */
void server_workers_share(struct server_workers *workers);

/* Queues a job. If the queue is full, returns false; the caller then still owns the job. After a
 * cancel the job is refused at once. */
bool server_workers_submit(struct server_workers *workers, struct server_job *job);

/* Queues a parked job at the front of its lane, even if the queue is full, because the job was
 * admitted before. */
void server_workers_resume(struct server_workers *workers, struct server_job *job);

/* Parks a job at an address until server_workers_unpark is called for this address, or until a
 * time; 0 means no limit. This must be the last call of the job's `run`. A parked job is refused at
 * its own deadline, or when the workers are cancelled. If they are already cancelled, returns false
 * and does not park the job. This and the next function take only the workers' lock. */
bool server_workers_park(struct server_workers *workers, struct server_job *job, const void *at,
                         uint64_t until_ns);

/* Queues the jobs that are parked at the address, at the front of their lanes. The second function
 * refuses them instead. */
void server_workers_unpark(struct server_workers *workers, const void *at);
void server_workers_refuse_parked(struct server_workers *workers, const void *at,
                                  enum server_refusal why);

/* Returns true if jobs are parked at the address. */
bool server_workers_await(struct server_workers *workers, const void *at);

/* Refuses late queued and parked jobs, and queues jobs whose parking time has ended. */
void server_workers_expire(struct server_workers *workers, uint64_t now_ns);

/* Refuses all queued, parked and future jobs. */
void server_workers_cancel(struct server_workers *workers);
bool server_workers_cancelled(struct server_workers *workers);

/* Adjusts the priority of the calling thread. Running jobs and guests (see below) call this
 * function every millisecond. Returns false if the workers were cancelled. */
bool server_workers_go_on(struct server_workers *workers);

struct server_workers_load {
    uint32_t threads; /* number of threads, without the spare threads */
    uint32_t running; /* number of running jobs, including those on spare threads */
    uint32_t queued;  /* jobs */
};
struct server_workers_load server_workers_load(struct server_workers *workers);

/* A guest is a thread of another part of the daemon that computes for a long time, with the
 * priority of a long job. The two functions begin and end the state of the calling thread as a
 * guest. */
void server_workers_begin_guest(struct server_workers *workers);
void server_workers_end_guest(struct server_workers *workers);

/* Returns true if a worker that is not spare runs a job, or if a guest computes. Takes no lock. */
bool server_workers_are_busy(const struct server_workers *workers);

/* Cancels the workers, waits for the running jobs, and frees the workers. NULL is allowed. */
void server_workers_destroy(struct server_workers *workers);
