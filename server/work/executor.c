#include "server/work/executor.h"

#include <pthread.h>
#include <stdlib.h>

#include "gd/control.h"
#include "server/base/thread.h"

#define SLEEP_NS   1000000 /* longest sleep before a helper checks the queue of jobs */
#define QUANTUM_NS 1000000 /* time after which a helper yields to waiting jobs */

#define SHARED_FACES 20000 /* two threads work on a mesh with more faces */

struct executor;

struct helper {
    struct server_job job; /* must be the first member */
    struct executor *executor;
};

struct executor {
    struct gd_executor base; /* `user` is this struct */
    struct server_workers *workers;
    uint32_t references; /* references of the caller and of the helpers */

    pthread_mutex_t lock;
    pthread_cond_t change;
    void (*task)(void *context, uint32_t index);
    void *context;
    /* tasks of the current run: their number, the next one to begin, the number of running ones */
    uint32_t count, next, running;
    bool is_stopped;
    struct helper helpers[];
};

static void executor_release(struct executor *executor)
{
    pthread_mutex_lock(&executor->lock);
    bool is_last = --executor->references == 0;
    pthread_mutex_unlock(&executor->lock);
    if (!is_last) return;
    pthread_cond_destroy(&executor->change);
    pthread_mutex_destroy(&executor->lock);
    free(executor);
}

/* Waits for a signal, at most SLEEP_NS. Releases the lock meanwhile. */
static void executor_wait(struct executor *executor)
{
    (void)server_condition_wait(&executor->change, &executor->lock, gd_now_ns() + SLEEP_NS);
}

/* Runs the next task. Releases the lock meanwhile. */
static void executor_run_task(struct executor *executor)
{
    uint32_t task = executor->next++;
    executor->running++;
    pthread_mutex_unlock(&executor->lock);
    executor->task(executor->context, task);
    /* a helper checks no control, so its priority is adjusted here */
    (void)server_workers_go_on(executor->workers);
    pthread_mutex_lock(&executor->lock);
    if (--executor->running == 0) pthread_cond_broadcast(&executor->change);
}

/* The job of a helper: runs tasks until the executor stops. If other jobs need the worker, queues
 * the job again and returns. */
static void helper_run(struct server_job *job)
{
    struct executor *executor = ((struct helper *)job)->executor;
    uint64_t end_ns = gd_now_ns() + QUANTUM_NS;
    bool comes_back = false;
    pthread_mutex_lock(&executor->lock);
    while (!comes_back && !executor->is_stopped) {
        if (executor->next < executor->count)
            executor_run_task(executor);
        else
            executor_wait(executor);
        comes_back = gd_now_ns() >= end_ns && server_workers_load(executor->workers).queued;
    }
    pthread_mutex_unlock(&executor->lock);
    if (!comes_back || !server_workers_submit(executor->workers, job)) executor_release(executor);
}

static void helper_refuse(struct server_job *job, enum server_refusal why)
{
    (void)why;
    executor_release(((struct helper *)job)->executor);
}

static void executor_run(void *user, void (*task)(void *context, uint32_t index), void *context,
                         uint32_t count)
{
    struct executor *executor = user;
    SERVER_LOCK(&executor->lock);
    executor->task = task;
    executor->context = context;
    executor->count = count;
    executor->next = 0;
    pthread_cond_broadcast(&executor->change);
    while (executor->next < executor->count) executor_run_task(executor);
    while (executor->running) executor_wait(executor);
}

const struct gd_executor *server_executor_start(struct server_workers *workers, uint32_t width,
                                                uint64_t deadline_ns)
{
    uint32_t threads = server_workers_load(workers).threads;
    if (width > threads) width = threads;
    struct executor *executor =
        width > 1 ? calloc(1, sizeof *executor + (width - 1) * sizeof executor->helpers[0]) : NULL;
    if (!executor) return NULL;
    executor->base = (struct gd_executor){.width = width, .run = executor_run, .user = executor};
    executor->workers = workers;
    executor->references = width;
    pthread_mutex_init(&executor->lock, NULL);
    pthread_cond_init(&executor->change, NULL);
    for (uint32_t i = 0; i < width - 1; i++) {
        executor->helpers[i] = (struct helper){
            .job = {.run = helper_run, .refuse = helper_refuse, .deadline_ns = deadline_ns},
            .executor = executor};
        if (!server_workers_submit(workers, &executor->helpers[i].job)) executor_release(executor);
    }
    return &executor->base;
}

const struct gd_executor *server_executor_start_for(struct server_workers *workers, uint32_t faces,
                                                    uint64_t deadline_ns)
{
    return server_executor_start(workers, faces > SHARED_FACES ? 2 : 1, deadline_ns);
}

void server_executor_stop(const struct gd_executor *base)
{
    if (!base) return;
    struct executor *executor = base->user;
    pthread_mutex_lock(&executor->lock);
    executor->is_stopped = true;
    pthread_cond_broadcast(&executor->change);
    pthread_mutex_unlock(&executor->lock);
    executor_release(executor);
}
