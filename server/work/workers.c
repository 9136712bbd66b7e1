/* See workers.h. */
#include "server/work/workers.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <time.h>

#include "gd/control.h"
#include "server/base/thread.h"
#include "server/work/thread_priority.h"

#define UPDATE_NS 500000 /* between two updates of the priority */

struct server_workers {
    pthread_mutex_t lock;
    pthread_cond_t work, spare_work;
    struct server_lanes lanes;
    uint32_t thread_count;     /* without spare ones */
    atomic_uint working;       /* threads that run a job, without spare ones; set under the lock */
    struct server_job *parked; /* see server_workers_park */
    struct server_job *background; /* jobs for idle times, the latest first */
    bool is_hosting;               /* a thread runs one of them */
    bool is_leaving;               /* threads end after the job that they run */
    atomic_bool cancelled;
    struct server_thread *threads[]; /* first those that are not spare, then as many spare ones */
};

/* The job that this thread runs; all zero: none. Jobs that a queued job submits get its lane and
 * kind. */
static _Thread_local struct running {
    const struct server_workers *workers; /* NULL: a background job */
    struct server_lane *lane;
    bool is_patient;
    struct server_priority priority;
} own;

/* --- the queue, under the lock ---------------------------------------------------------------- */

static bool workers_are_all_at_work(const struct server_workers *workers)
{
    return workers->working == workers->thread_count;
}

/* Wakes a thread for a queued job: a spare one if all others are at work. */
static void workers_wake(struct server_workers *workers)
{
    pthread_cond_signal(workers_are_all_at_work(workers) ? &workers->spare_work : &workers->work);
}

/* Returns false, and leaves the job to the caller, when the queue is full. */
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

/* Removes the job from the list. Returns NULL if it is not in there. */
static struct server_job *list_remove(struct server_job **list, const struct server_job *job)
{
    while (*list && *list != job) list = &(*list)->next;
    struct server_job *found = *list;
    if (found) *list = found->next;
    return found;
}

/* --- threads ---------------------------------------------------------------------------------- */

bool server_workers_are_busy(const struct server_workers *workers)
{
    return atomic_load_explicit(&workers->working, memory_order_relaxed) > 0;
}

bool server_workers_go_on(struct server_workers *workers)
{
    static _Thread_local uint64_t updated_ns;
    uint64_t now_ns = gd_now_ns();
    if (now_ns - updated_ns >= UPDATE_NS) {
        struct timespec cpu;
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &cpu);
        uint64_t cpu_ns = (uint64_t)cpu.tv_sec * 1000000000 + (uint64_t)cpu.tv_nsec;
        server_worker_set_idle(server_priority_update(&own.priority, now_ns, cpu_ns));
        updated_ns = now_ns;
    }
    return !server_workers_cancelled(workers);
}

/* Runs a job, perhaps within a longer one (server_workers_yield). Releases the lock meanwhile. */
static void workers_run(struct server_workers *workers, struct server_job *job,
                        struct running running)
{
    const struct running outer = own;
    uint64_t begun_ns = gd_now_ns();
    own = running;
    pthread_mutex_unlock(&workers->lock);
    server_worker_set_idle(false);
    server_priority_begin(&own.priority, begun_ns);
    if (server_workers_cancelled(workers))
        job->refuse(job, SERVER_REFUSAL_DRAINING);
    else if (server_job_is_late(job, begun_ns))
        job->refuse(job, SERVER_REFUSAL_DEADLINE);
    else
        job->run(job);
    own = outer;
    server_worker_set_idle(own.priority.is_idle);
    uint64_t ns = gd_now_ns() - begun_ns;
    pthread_mutex_lock(&workers->lock);
    if (running.lane) server_lanes_end(&workers->lanes, running.lane, running.is_patient, ns);
}

/* Runs a job that was taken from the lanes. */
static void workers_run_taken(struct server_workers *workers, struct server_job *job)
{
    if (server_lanes_queued(&workers->lanes))
        workers_wake(workers); /* perhaps for a spare thread */
    workers_run(workers, job, (struct running){workers, job->lane, job->is_patient, {0}});
}

/* Runs the latest background job, unless one runs already. Returns false if it ran none. */
static bool workers_run_background(struct server_workers *workers)
{
    struct server_job *job = workers->background;
    if (!job || workers->is_hosting) return false;
    workers->background = job->next;
    workers->is_hosting = true;
    workers_run(workers, job, (struct running){0});
    workers->is_hosting = false;
    return true;
}

/* Runs jobs until the end. */
static void workers_serve(struct server_workers *workers, bool is_spare)
{
    server_worker_lower();
    pthread_mutex_lock(&workers->lock);
    while (!workers->is_leaving) {
        bool has_run = false;
        struct server_job *job = !is_spare || workers_are_all_at_work(workers)
                                     ? server_lanes_take(&workers->lanes, is_spare)
                                     : NULL;
        workers->working += !is_spare;
        if (job)
            workers_run_taken(workers, job);
        else if (!is_spare)
            has_run = workers_run_background(workers);
        workers->working -= !is_spare;
        if (!job && !has_run)
            pthread_cond_wait(is_spare ? &workers->spare_work : &workers->work, &workers->lock);
    }
    pthread_mutex_unlock(&workers->lock);
}

static void worker_run(void *user, struct server_thread *thread)
{
    (void)thread;
    workers_serve(user, false);
}

static void spare_run(void *user, struct server_thread *thread)
{
    (void)thread;
    workers_serve(user, true);
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
    bool has_all = true;
    for (uint32_t i = 0; i < count && has_all; i++)
        has_all = (workers->threads[i] = server_thread_start(worker_run, workers)) != NULL;
    if (has_all) return workers;
    server_workers_destroy(workers);
    return NULL;
}

bool server_workers_add_spare(struct server_workers *workers)
{
    bool has_all = true;
    for (uint32_t i = workers->thread_count; i < 2 * workers->thread_count && has_all; i++)
        has_all = (workers->threads[i] = server_thread_start(spare_run, workers)) != NULL;
    return has_all;
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

/* Lists the job unless there was a cancel. */
static bool workers_list(struct server_workers *workers, struct server_job **list,
                         struct server_job *job)
{
    pthread_mutex_lock(&workers->lock);
    bool is_listed = !server_workers_cancelled(workers);
    if (is_listed) {
        job->next = *list;
        *list = job;
        pthread_cond_signal(&workers->work);
    }
    pthread_mutex_unlock(&workers->lock);
    return is_listed;
}

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

void server_workers_submit_background(struct server_workers *workers, struct server_job *job)
{
    if (!workers_list(workers, &workers->background, job))
        job->refuse(job, SERVER_REFUSAL_DRAINING);
}

bool server_workers_withdraw(struct server_workers *workers, struct server_job *job)
{
    pthread_mutex_lock(&workers->lock);
    bool is_found = list_remove(&workers->background, job) != NULL;
    pthread_mutex_unlock(&workers->lock);
    return is_found;
}

bool server_workers_park(struct server_workers *workers, struct server_job *job, const void *at,
                         uint64_t until_ns)
{
    job->parked_at = at;
    job->parked_until_ns = until_ns;
    return workers_list(workers, &workers->parked, job);
}

/* Under the lock: the link to the first job that is parked there; it points to NULL: none is. */
static struct server_job **parked_find(struct server_workers *workers, const void *at)
{
    struct server_job **link = &workers->parked;
    while (*link && (*link)->parked_at != at) link = &(*link)->next;
    return link;
}

void server_workers_unpark(struct server_workers *workers, const void *at)
{
    pthread_mutex_lock(&workers->lock);
    for (struct server_job **link, *job; (job = *(link = parked_find(workers, at)));) {
        *link = job->next;
        (void)workers_put(workers, job, true);
    }
    pthread_mutex_unlock(&workers->lock);
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
    pthread_mutex_lock(&workers->lock);
    bool is_awaited = *parked_find(workers, at) != NULL;
    pthread_mutex_unlock(&workers->lock);
    return is_awaited;
}

void server_workers_yield(struct server_workers *workers)
{
    struct server_job *job;
    pthread_mutex_lock(&workers->lock);
    while (server_lanes_running(&workers->lanes) + 1 >= workers->thread_count &&
           (job = server_lanes_take(&workers->lanes, false)))
        workers_run_taken(workers, job);
    pthread_mutex_unlock(&workers->lock);
}

void server_workers_refuse_background(struct server_workers *workers, enum server_refusal why)
{
    pthread_mutex_lock(&workers->lock);
    struct server_job *background = workers->background;
    workers->background = NULL;
    pthread_mutex_unlock(&workers->lock);
    server_jobs_refuse(background, why);
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

/* A job that is queued later sees the cancel, since that comes before the lock. */
void server_workers_cancel(struct server_workers *workers)
{
    atomic_store(&workers->cancelled, true);
    workers_refuse_late(workers, UINT64_MAX, SERVER_REFUSAL_DRAINING);
    server_workers_refuse_background(workers, SERVER_REFUSAL_DRAINING);
}

bool server_workers_cancelled(struct server_workers *workers)
{
    return atomic_load_explicit(&workers->cancelled, memory_order_relaxed);
}

struct server_workers_load server_workers_load(struct server_workers *workers)
{
    pthread_mutex_lock(&workers->lock);
    struct server_workers_load load = {.threads = workers->thread_count,
                                       .running = server_lanes_running(&workers->lanes),
                                       .queued = server_lanes_queued(&workers->lanes),
                                       .background = workers->is_hosting};
    pthread_mutex_unlock(&workers->lock);
    return load;
}
