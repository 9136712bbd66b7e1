/* See workers.h. */
#include "server/work/workers.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdlib.h>
#include <time.h>

#include "gd/control.h"
#include "server/work/worker_priority.h"

#define UPDATE_NS 500000 /* between two updates of the priority */

struct server_workers {
    pthread_mutex_t lock;
    pthread_cond_t work, spare_work;
    struct server_lanes lanes;
    uint32_t thread_count, spare_count;
    atomic_uint working;       /* threads that run a job, without spare ones; set under the lock */
    struct server_job *parked; /* see server_workers_park */
    struct server_job *background; /* jobs for idle times, the latest first */
    bool is_hosting;               /* a thread runs one of them */
    bool leaving;                  /* threads end once the queue is empty */
    atomic_bool cancelled;
    pthread_t threads[]; /* first those that are not spare, then as many spare ones */
};

/* The queued job that this thread runs. Jobs that it submits get its lane and kind. */
static _Thread_local struct running {
    const struct server_workers *workers;
    struct server_lane *lane;
    bool is_patient;
} own;

/* --- the queue, under the lock ---------------------------------------------------------------- */

static struct server_lane *workers_lane_for(struct server_workers *workers, struct server_job *job)
{
    if (job->tenant || own.workers != workers) return server_lanes_of(&workers->lanes, job->tenant);
    job->is_patient = own.is_patient;
    return own.lane;
}

static bool workers_are_all_at_work(const struct server_workers *workers)
{
    return workers->working == workers->thread_count;
}

/* Wakes a thread for a queued job: a spare one if all others are at work. */
static void workers_wake(struct server_workers *workers)
{
    pthread_cond_signal(workers_are_all_at_work(workers) ? &workers->spare_work : &workers->work);
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

static _Thread_local struct server_priority
    priority; /* of the thread's job; all zero between jobs */

/* Runs a job, perhaps within a longer one (server_workers_yield), whose priority returns after
 * it. */
static void workers_run(struct server_workers *workers, struct server_job *job)
{
    const struct server_priority outer = priority;
    uint64_t now_ns = gd_now_ns();
    server_worker_set_idle(false);
    server_priority_begin(&priority, now_ns);
    if (atomic_load(&workers->cancelled))
        job->refuse(job, SERVER_REFUSAL_DRAINING);
    else if (server_job_is_late(job, now_ns))
        job->refuse(job, SERVER_REFUSAL_DEADLINE);
    else
        job->run(job);
    priority = outer;
    server_worker_set_idle(priority.is_idle);
}

bool server_workers_are_busy(const struct server_workers *workers)
{
    return atomic_load_explicit(&workers->working, memory_order_relaxed) > 0;
}

static uint64_t processor_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (uint64_t)t.tv_sec * 1000000000 + (uint64_t)t.tv_nsec;
}

bool server_workers_go_on(struct server_workers *workers)
{
    static _Thread_local uint64_t updated_ns;
    uint64_t now_ns = gd_now_ns();
    if (now_ns - updated_ns >= UPDATE_NS) {
        server_worker_set_idle(server_priority_update(&priority, now_ns, processor_ns()));
        updated_ns = now_ns;
    }
    return !server_workers_cancelled(workers);
}

/* Runs a job that was taken from the lanes. Releases the lock meanwhile. */
static void workers_run_taken(struct server_workers *workers, struct server_job *job)
{
    const struct running outer = own;
    struct server_lane *lane = job->lane;
    bool is_patient = job->is_patient;
    if (server_lanes_queued(&workers->lanes))
        workers_wake(workers); /* perhaps for a spare thread */
    own = (struct running){workers, lane, is_patient};
    pthread_mutex_unlock(&workers->lock);
    uint64_t begun_ns = gd_now_ns();
    workers_run(workers, job);
    uint64_t ns = gd_now_ns() - begun_ns;
    pthread_mutex_lock(&workers->lock);
    own = outer;
    server_lanes_end(&workers->lanes, lane, is_patient, ns);
}

/* Runs the latest background job. Releases the lock meanwhile. */
static void workers_run_background(struct server_workers *workers)
{
    struct server_job *job = workers->background;
    workers->background = job->next;
    workers->is_hosting = true;
    pthread_mutex_unlock(&workers->lock);
    workers_run(workers, job);
    pthread_mutex_lock(&workers->lock);
    workers->is_hosting = false;
}

/* Runs the next job, if there is one, and returns whether there was. Releases the lock
 * meanwhile. */
static bool workers_run_next(struct server_workers *workers)
{
    struct server_job *job = server_lanes_take(&workers->lanes, false);
    if (!job && (!workers->background || workers->is_hosting)) return false;
    workers->working++;
    if (job)
        workers_run_taken(workers, job);
    else
        workers_run_background(workers);
    workers->working--;
    return true;
}

static void *worker_main(void *user)
{
    struct server_workers *workers = user;
    server_worker_lower();
    pthread_mutex_lock(&workers->lock);
    for (;;) {
        if (workers_run_next(workers)) continue;
        if (workers->leaving) break;
        pthread_cond_wait(&workers->work, &workers->lock);
    }
    pthread_mutex_unlock(&workers->lock);
    return NULL;
}

static void *spare_main(void *user)
{
    struct server_workers *workers = user;
    server_worker_lower();
    pthread_mutex_lock(&workers->lock);
    while (!workers->leaving) {
        struct server_job *job =
            workers_are_all_at_work(workers) ? server_lanes_take(&workers->lanes, true) : NULL;
        if (job)
            workers_run_taken(workers, job);
        else
            pthread_cond_wait(&workers->spare_work, &workers->lock);
    }
    pthread_mutex_unlock(&workers->lock);
    return NULL;
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
    for (pthread_t *thread = workers->threads; workers->thread_count < count; thread++) {
        if (pthread_create(thread, NULL, worker_main, workers) != 0) {
            server_workers_destroy(workers);
            return NULL;
        }
        workers->thread_count++;
    }
    return workers;
}

bool server_workers_add_spare(struct server_workers *workers)
{
    pthread_t *thread = &workers->threads[workers->thread_count];
    for (; workers->spare_count < workers->thread_count; workers->spare_count++)
        if (pthread_create(thread++, NULL, spare_main, workers) != 0) return false;
    return true;
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
    workers->leaving = true;
    pthread_cond_broadcast(&workers->work);
    pthread_cond_broadcast(&workers->spare_work);
    pthread_mutex_unlock(&workers->lock);
    for (uint32_t i = 0; i < workers->thread_count + workers->spare_count; i++)
        pthread_join(workers->threads[i], NULL);
    pthread_cond_destroy(&workers->spare_work);
    pthread_cond_destroy(&workers->work);
    pthread_mutex_destroy(&workers->lock);
    free(workers);
}

/* --- jobs in and out -------------------------------------------------------------------------- */

enum place { PLACE_LAST, PLACE_FIRST, PLACE_BACKGROUND };

static bool workers_put(struct server_workers *workers, struct server_job *job, enum place place)
{
    if (place == PLACE_BACKGROUND) {
        job->next = workers->background;
        workers->background = job;
        pthread_cond_signal(&workers->work);
        return true;
    }
    struct server_lane *lane = workers_lane_for(workers, job);
    if (place == PLACE_FIRST)
        server_lanes_push_front(&workers->lanes, lane, job);
    else if (!server_lanes_push(&workers->lanes, lane, job))
        return false;
    workers_wake(workers);
    return true;
}

/* Returns false, and leaves the job to the caller, when the queue is full. */
static bool workers_add(struct server_workers *workers, struct server_job *job, enum place place)
{
    pthread_mutex_lock(&workers->lock);
    bool is_cancelled = atomic_load(&workers->cancelled);
    bool is_taken = is_cancelled || workers_put(workers, job, place);
    pthread_mutex_unlock(&workers->lock);
    if (is_cancelled) job->refuse(job, SERVER_REFUSAL_DRAINING);
    return is_taken;
}

bool server_workers_submit(struct server_workers *workers, struct server_job *job)
{
    return workers_add(workers, job, PLACE_LAST);
}

void server_workers_resume(struct server_workers *workers, struct server_job *job)
{
    (void)workers_add(workers, job, PLACE_FIRST);
}

void server_workers_submit_background(struct server_workers *workers, struct server_job *job)
{
    (void)workers_add(workers, job, PLACE_BACKGROUND);
}

bool server_workers_withdraw(struct server_workers *workers, struct server_job *job)
{
    pthread_mutex_lock(&workers->lock);
    bool is_found = list_remove(&workers->background, job) != NULL;
    pthread_mutex_unlock(&workers->lock);
    return is_found;
}

bool server_workers_park(struct server_workers *workers, struct server_job *job)
{
    pthread_mutex_lock(&workers->lock);
    bool cancelled = atomic_load(&workers->cancelled);
    if (!cancelled) {
        job->next = workers->parked;
        workers->parked = job;
    }
    pthread_mutex_unlock(&workers->lock);
    return !cancelled;
}

void server_workers_unpark(struct server_workers *workers, const struct server_job *job)
{
    pthread_mutex_lock(&workers->lock);
    struct server_job *parked = list_remove(&workers->parked, job);
    if (parked) (void)workers_put(workers, parked, PLACE_FIRST);
    pthread_mutex_unlock(&workers->lock);
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
    const struct server_lanes *lanes = &workers->lanes;
    struct server_workers_load load = {.threads = workers->thread_count,
                                       .running = server_lanes_running(lanes),
                                       .queued = server_lanes_queued(lanes),
                                       .background = workers->is_hosting};
    pthread_mutex_unlock(&workers->lock);
    return load;
}
