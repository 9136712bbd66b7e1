/* See team.h. */
#include "server/work/team.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <time.h>

#include "gd/control.h"
#include "server/work/traffic.h"

#define LOOKS    20000   /* for news, before a thread goes to sleep: some ten microseconds */
#define SLEEP_NS 1000000 /* then the helper looks whether its worker is wanted */
#define REST_NS  2000000 /* of a helper that would be in the way of requests */

struct server_team {
    struct server_job job; /* first: the helper */
    struct server_workers *workers;
    struct gd_executor executor;
    uint32_t references; /* the caller's and the helper's */

    pthread_mutex_t lock;
    pthread_cond_t news;
    atomic_uint news_count; /* changes with all that a thread may wait for */
    void (*task)(void *context, uint32_t index);
    void *context;
    /* tasks: of the run, the next to be begun, those that are begun and not done */
    uint32_t count, next, running;
    bool is_over; /* the call has ended */
};

static void release(struct server_team *team)
{
    pthread_mutex_lock(&team->lock);
    bool is_last = --team->references == 0;
    pthread_mutex_unlock(&team->lock);
    if (!is_last) return;
    pthread_cond_destroy(&team->news);
    pthread_mutex_destroy(&team->lock);
    free(team);
}

/* Under the lock. */
static void announce(struct server_team *team)
{
    atomic_fetch_add(&team->news_count, 1);
    pthread_cond_broadcast(&team->news);
}

/* Under the lock, which is given up meanwhile: until something has changed, or a millisecond has
 * passed. */
static void wait_for_news(struct server_team *team)
{
    struct timespec until;
    unsigned seen = atomic_load(&team->news_count);
    pthread_mutex_unlock(&team->lock);
    for (int look = 0;
         look < LOOKS && atomic_load_explicit(&team->news_count, memory_order_relaxed) == seen;
         look++)
        continue;
    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_nsec += SLEEP_NS;
    until.tv_sec += until.tv_nsec / 1000000000;
    until.tv_nsec %= 1000000000;
    pthread_mutex_lock(&team->lock);
    if (atomic_load(&team->news_count) == seen)
        pthread_cond_timedwait(&team->news, &team->lock, &until);
}

/* Under the lock, which is given up meanwhile. */
static void do_task(struct server_team *team)
{
    uint32_t task = team->next++;
    team->running++;
    pthread_mutex_unlock(&team->lock);
    team->task(team->context, task);
    pthread_mutex_lock(&team->lock);
    if (--team->running == 0) announce(team);
}

/* Under the lock, which is given up meanwhile. */
static void rest(struct server_team *team)
{
    const struct timespec while_others_are_served = {.tv_nsec = REST_NS};
    pthread_mutex_unlock(&team->lock);
    nanosleep(&while_others_are_served, NULL);
    pthread_mutex_lock(&team->lock);
}

/* --- the helper ------------------------------------------------------------------------------- */

static bool is_wanted_elsewhere(const struct server_team *team)
{
    struct server_workers_load load = server_workers_load(team->workers);
    return (team->job.is_patient ? load.queued : load.urgent) > 0;
}

/* Till the call ends or somebody else wants the worker. It rests while requests come densely, whose
 * threads want the core. */
static void help(struct server_job *job)
{
    struct server_team *team = (struct server_team *)job;
    struct server_traffic traffic = {0};
    pthread_mutex_lock(&team->lock);
    while (!team->is_over && !is_wanted_elsewhere(team)) {
        if (server_traffic_is_dense(&traffic, gd_now_ns()))
            rest(team);
        else if (team->next < team->count)
            do_task(team);
        else
            wait_for_news(team);
    }
    pthread_mutex_unlock(&team->lock);
    release(team);
}

static void refuse(struct server_job *job, enum server_refusal why)
{
    (void)why;
    release((struct server_team *)job);
}

/* --- the caller ------------------------------------------------------------------------------- */

static void run(void *user, void (*task)(void *context, uint32_t index), void *context,
                uint32_t count)
{
    struct server_team *team = user;
    pthread_mutex_lock(&team->lock);
    team->task = task;
    team->context = context;
    team->count = count;
    team->next = 0;
    announce(team);
    while (team->next < team->count) do_task(team);
    while (team->running) wait_for_news(team);
    pthread_mutex_unlock(&team->lock);
}

struct server_team *server_team_call(struct server_workers *workers, uint64_t deadline_ns)
{
    struct server_team *team =
        server_workers_load(workers).threads > 1 ? calloc(1, sizeof *team) : NULL;
    if (!team) return NULL;
    *team = (struct server_team){.job = {.run = help, .refuse = refuse, .deadline_ns = deadline_ns},
                                 .workers = workers,
                                 .executor = {.width = 2, .run = run, .user = team},
                                 .references = 2};
    pthread_mutex_init(&team->lock, NULL);
    pthread_cond_init(&team->news, NULL);
    if (!server_workers_submit(workers, &team->job)) release(team);
    return team;
}

const struct gd_executor *server_team_executor(struct server_team *team)
{
    return team ? &team->executor : NULL;
}

void server_team_dismiss(struct server_team *team)
{
    if (!team) return;
    pthread_mutex_lock(&team->lock);
    team->is_over = true;
    announce(team);
    pthread_mutex_unlock(&team->lock);
    release(team);
}
