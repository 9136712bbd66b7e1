/* See executor.h. */
#include "server/work/executor.h"

#include <pthread.h>
#include <stdlib.h>

struct helper;

/* One run. */
struct crew {
    struct server_workers *workers;
    void (*task)(void *context, uint32_t index);
    void *context;
    uint32_t count;

    pthread_mutex_t lock;
    pthread_cond_t idle;
    uint32_t next, running; /* tasks: the next to be handed out, and those that helpers are at */
    uint32_t references;    /* the caller's and the helpers' */
    struct helper {
        struct server_job job; /* first */
        struct crew *crew;
    } helpers[];
};

static void crew_release(struct crew *crew)
{
    pthread_mutex_lock(&crew->lock);
    bool is_last = --crew->references == 0;
    pthread_mutex_unlock(&crew->lock);
    if (!is_last) return;
    pthread_cond_destroy(&crew->idle);
    pthread_mutex_destroy(&crew->lock);
    free(crew);
}

/* Takes the next task; false: there is none left. */
static bool begin_task(struct crew *crew, uint32_t *out)
{
    pthread_mutex_lock(&crew->lock);
    bool found = crew->next < crew->count;
    if (found) {
        *out = crew->next++;
        crew->running++;
    }
    pthread_mutex_unlock(&crew->lock);
    return found;
}

/* True: there is more to do. */
static bool end_task(struct crew *crew)
{
    pthread_mutex_lock(&crew->lock);
    if (--crew->running == 0) pthread_cond_signal(&crew->idle);
    bool is_more = crew->next < crew->count;
    pthread_mutex_unlock(&crew->lock);
    return is_more;
}

static bool do_task(struct crew *crew)
{
    uint32_t task;
    if (!begin_task(crew, &task)) return false;
    crew->task(crew->context, task);
    return end_task(crew);
}

/* --- helpers ---------------------------------------------------------------------------------- */

static void help(struct server_job *job)
{
    struct crew *crew = ((struct helper *)job)->crew;
    if (do_task(crew) && server_workers_submit(crew->workers, job)) return;
    crew_release(crew);
}

static void dismiss(struct server_job *job, enum server_refusal why)
{
    (void)why;
    crew_release(((struct helper *)job)->crew);
}

static struct crew *crew_create(const struct server_executor *executor, uint32_t helpers)
{
    struct crew *crew = calloc(1, sizeof *crew + helpers * sizeof crew->helpers[0]);
    if (!crew) return NULL;
    pthread_mutex_init(&crew->lock, NULL);
    pthread_cond_init(&crew->idle, NULL);
    crew->workers = executor->workers;
    crew->references = helpers + 1;
    for (uint32_t i = 0; i < helpers; i++)
        crew->helpers[i] = (struct helper){
            .job = {.run = help, .refuse = dismiss, .deadline_ns = executor->deadline_ns},
            .crew = crew};
    return crew;
}

static void call_helpers(struct crew *crew, uint32_t helpers)
{
    for (uint32_t i = 0; i < helpers; i++)
        if (!server_workers_submit(crew->workers, &crew->helpers[i].job)) crew_release(crew);
}

/* --- the run ---------------------------------------------------------------------------------- */

static void run(void *user, void (*task)(void *context, uint32_t index), void *context,
                uint32_t count)
{
    const struct server_executor *executor = user;
    uint32_t width = executor->executor.width, helpers = (width < count ? width : count) - 1;
    struct crew *crew = crew_create(executor, helpers);
    if (!crew) {
        gd_executor_run(NULL, task, context, count);
        return;
    }
    crew->task = task;
    crew->context = context;
    crew->count = count;
    call_helpers(crew, helpers);
    while (do_task(crew)) continue;
    pthread_mutex_lock(&crew->lock);
    while (crew->running) pthread_cond_wait(&crew->idle, &crew->lock);
    pthread_mutex_unlock(&crew->lock);
    crew_release(crew);
}

const struct gd_executor *server_executor_of(struct server_executor *out,
                                             struct server_workers *workers, uint64_t deadline_ns)
{
    *out = (struct server_executor){
        .executor = {.width = server_workers_load(workers).threads, .run = run, .user = out},
        .workers = workers,
        .deadline_ns = deadline_ns};
    return &out->executor;
}
