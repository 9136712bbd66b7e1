#include "server/work/workers.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "gd/control.h"
#include "server/base/thread.h"
#include "server/work/thread_priority.h"

#define UPDATE_NS 500000 /* between two updates of the priority */

struct server_workers {
    pthread_mutex_t lock;
    pthread_cond_t work, spare_work;
    struct server_lanes lanes;
    uint32_t thread_count; /* without the spare threads */
    /* number of threads that run a job, without spare threads; set under the lock */
    atomic_uint working;
    atomic_uint guests;
    /* number of threads; those after the first `thread_count` are spare */
    atomic_uint started;
    struct server_job *parked; /* see server_workers_park */
    bool is_leaving;           /* true if each thread ends after its current job */
    atomic_bool cancelled;
    struct server_thread *threads[]; /* 2 * `thread_count` entries */
};

/* The job that this thread runs; all zero means none. Jobs that the running job submits get the
 * same lane, and are patient if the running job is patient. */
static _Thread_local struct running {
    const struct server_workers *workers;
    struct server_lane *lane;
    bool is_patient;
    struct server_priority priority;
} own;

/* --- the queue, under the lock ---------------------------------------------------------------- */

static bool workers_are_all_at_work(const struct server_workers *workers)
{
    return workers->working == workers->thread_count;
}

/* Wakes a thread for a queued job. Wakes a spare thread if all others are busy. */
static void workers_wake(struct server_workers *workers)
{
    pthread_cond_signal(workers_are_all_at_work(workers) ? &workers->spare_work : &workers->work);
}

/* Queues a job. If the queue is full, returns false; the caller then still owns the job. */
static bool workers_put(struct server_workers *workers, struct server_job *job, bool is_first)
{
    struct server_lane *lane = own.lane;
    if (job->tenant || own.workers != workers)
        lane = server_lanes_of(&workers->lanes, job->tenant);
    else
        job->is_patient = own.is_patient;
    if (!server_lanes_push(&workers->lanes, lane, job, is_first)) return false;
    workers_wake(workers);
    return true;
}

/* --- threads ---------------------------------------------------------------------------------- */

bool server_workers_are_busy(const struct server_workers *workers)
{
    return atomic_load_explicit(&workers->working, memory_order_relaxed) > 0 ||
           atomic_load_explicit(&workers->guests, memory_order_relaxed) > 0;
}

void server_workers_begin_guest(struct server_workers *workers)
{
    server_worker_lower();
    server_priority_begin(&own.priority, gd_now_ns());
    atomic_fetch_add(&workers->guests, 1);
}

void server_workers_end_guest(struct server_workers *workers)
{
    server_worker_set_idle(false);
    atomic_fetch_sub(&workers->guests, 1);
}

bool server_workers_go_on(struct server_workers *workers)
{
    static _Thread_local uint64_t updated_ns;
    uint64_t now_ns = gd_now_ns();
    if (now_ns - updated_ns >= UPDATE_NS) {
        server_worker_set_idle(
            server_priority_update(&own.priority, now_ns, server_thread_cpu_ns()));
        updated_ns = now_ns;
    }
    return !server_workers_cancelled(workers);
}

/* Runs a job that was taken from the lanes, without the lock. */
static void workers_run(struct server_workers *workers, struct server_job *job)
{
    uint64_t begun_ns = gd_now_ns();
    if (server_lanes_queued(&workers->lanes))
        workers_wake(workers); /* a spare thread may take the next job */
    own = (struct running){workers, job->lane, job->is_patient, {0}};
    pthread_mutex_unlock(&workers->lock);
    server_priority_begin(&own.priority, begun_ns);
    if (server_workers_cancelled(workers))
        job->refuse(job, SERVER_REFUSAL_DRAINING);
    else if (server_job_is_late(job, begun_ns))
        job->refuse(job, SERVER_REFUSAL_DEADLINE);
    else
        job->run(job);
    server_worker_set_idle(false);
    const struct running ended = own;
    own = (struct running){0};
    pthread_mutex_lock(&workers->lock);
    server_lanes_end(&workers->lanes, ended.lane, ended.is_patient, gd_now_ns() - begun_ns);
}

/* Runs jobs until the workers are destroyed. */
static void worker_run(void *user, struct server_thread *thread)
{
    struct server_workers *workers = user;
    bool is_spare = atomic_fetch_add(&workers->started, 1) >= workers->thread_count;
    (void)thread;
    server_worker_lower();
    SERVER_LOCK(&workers->lock);
    while (!workers->is_leaving) {
        struct server_job *job = !is_spare || workers_are_all_at_work(workers)
                                     ? server_lanes_take(&workers->lanes, is_spare)
                                     : NULL;
        if (job) {
            workers->working += !is_spare;
            workers_run(workers, job);
            workers->working -= !is_spare;
        } else {
            pthread_cond_wait(is_spare ? &workers->spare_work : &workers->work, &workers->lock);
        }
    }
}

/* Starts as many threads as there are workers. */
static bool threads_start(struct server_workers *workers, uint32_t first)
{
    for (uint32_t i = first; i < first + workers->thread_count; i++)
        if (!(workers->threads[i] = server_thread_start(worker_run, workers))) return false;
    return true;
}

struct server_workers *server_workers_create(uint32_t count, uint32_t queue_length)
{
    struct server_workers *workers =
        calloc(1, sizeof *workers + 2 * count * sizeof workers->threads[0]);
    if (!workers) return NULL;
    pthread_mutex_init(&workers->lock, NULL);
    pthread_cond_init(&workers->work, NULL);
    pthread_cond_init(&workers->spare_work, NULL);
    server_lanes_init(&workers->lanes, count, queue_length);
    workers->thread_count = count;
    if (threads_start(workers, 0)) return workers;
    server_workers_destroy(workers);
    return NULL;
}

bool server_workers_add_spare(struct server_workers *workers)
{
    return threads_start(workers, workers->thread_count);
}

void server_workers_share(struct server_workers *workers)
{
    workers->lanes.is_shared = true;
}

void server_workers_destroy(struct server_workers *workers)
{
    if (!workers) return;
    server_workers_cancel(workers);
    pthread_mutex_lock(&workers->lock);
    workers->is_leaving = true;
    pthread_cond_broadcast(&workers->work);
    pthread_cond_broadcast(&workers->spare_work);
    pthread_mutex_unlock(&workers->lock);
    for (uint32_t i = 0; i < 2 * workers->thread_count; i++)
        server_thread_stop(workers->threads[i]);
    pthread_cond_destroy(&workers->spare_work);
    pthread_cond_destroy(&workers->work);
    pthread_mutex_destroy(&workers->lock);
    free(workers);
}

/* --- jobs in and out -------------------------------------------------------------------------- */

static bool workers_queue(struct server_workers *workers, struct server_job *job, bool is_first)
{
    pthread_mutex_lock(&workers->lock);
    bool is_cancelled = server_workers_cancelled(workers);
    bool is_taken = is_cancelled || workers_put(workers, job, is_first);
    pthread_mutex_unlock(&workers->lock);
    if (is_cancelled) job->refuse(job, SERVER_REFUSAL_DRAINING);
    return is_taken;
}

bool server_workers_submit(struct server_workers *workers, struct server_job *job)
{
    return workers_queue(workers, job, false);
}

void server_workers_resume(struct server_workers *workers, struct server_job *job)
{
    (void)workers_queue(workers, job, true);
}

bool server_workers_park(struct server_workers *workers, struct server_job *job, const void *at,
                         uint64_t until_ns)
{
    SERVER_LOCK(&workers->lock);
    if (server_workers_cancelled(workers)) return false;
    job->parked_at = at;
    job->parked_until_ns = until_ns;
    job->next = workers->parked;
    workers->parked = job;
    return true;
}

/* Under the lock: returns the link to the first job that is parked at the address. The link is NULL
 * if there is none. */
static struct server_job **parked_find(struct server_workers *workers, const void *at)
{
    struct server_job **link = &workers->parked;
    while (*link && (*link)->parked_at != at) link = &(*link)->next;
    return link;
}

void server_workers_unpark(struct server_workers *workers, const void *at)
{
    SERVER_LOCK(&workers->lock);
    for (struct server_job **link, *job; (job = *(link = parked_find(workers, at)));) {
        *link = job->next;
        (void)workers_put(workers, job, true);
    }
}

void server_workers_refuse_parked(struct server_workers *workers, const void *at,
                                  enum server_refusal why)
{
    struct server_job *refused = NULL;
    pthread_mutex_lock(&workers->lock);
    for (struct server_job **link, *job; (job = *(link = parked_find(workers, at)));) {
        *link = job->next;
        job->next = refused;
        refused = job;
    }
    pthread_mutex_unlock(&workers->lock);
    server_jobs_refuse(refused, why);
}

bool server_workers_await(struct server_workers *workers, const void *at)
{
    SERVER_LOCK(&workers->lock);
    return *parked_find(workers, at) != NULL;
}

static void workers_refuse_late(struct server_workers *workers, uint64_t now_ns,
                                enum server_refusal why)
{
    pthread_mutex_lock(&workers->lock);
    struct server_job *queued = server_lanes_expire(&workers->lanes, now_ns);
    struct server_job *parked = server_jobs_expire(&workers->parked, now_ns);
    pthread_mutex_unlock(&workers->lock);
    server_jobs_refuse(queued, why);
    server_jobs_refuse(parked, why);
}

void server_workers_expire(struct server_workers *workers, uint64_t now_ns)
{
    pthread_mutex_lock(&workers->lock);
    for (struct server_job **link = &workers->parked, *job; (job = *link);) {
        if (job->parked_until_ns && job->parked_until_ns <= now_ns) {
            *link = job->next;
            (void)workers_put(workers, job, true);
        } else {
            link = &job->next;
        }
    }
    pthread_mutex_unlock(&workers->lock);
    workers_refuse_late(workers, now_ns, SERVER_REFUSAL_DEADLINE);
}

/* Sets the flag before taking the lock, so that a job that is queued later is refused. */
void server_workers_cancel(struct server_workers *workers)
{
    atomic_store(&workers->cancelled, true);
    workers_refuse_late(workers, UINT64_MAX, SERVER_REFUSAL_DRAINING);
}

bool server_workers_cancelled(struct server_workers *workers)
{
    return atomic_load_explicit(&workers->cancelled, memory_order_relaxed);
}

struct server_workers_load server_workers_load(struct server_workers *workers)
{
    SERVER_LOCK(&workers->lock);
    return (struct server_workers_load){.threads = workers->thread_count,
                                        .running = server_lanes_running(&workers->lanes),
                                        .queued = server_lanes_queued(&workers->lanes)};
}
