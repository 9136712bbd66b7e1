/* See thread.h. */
#include "server/base/thread.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <time.h>

#include "gd/control.h"

#define SECOND_NS UINT64_C(1000000000)

struct server_thread {
    pthread_mutex_t lock;
    pthread_cond_t change;
    bool is_woken, is_stopping; /* under the lock */
    void (*run)(void *user, struct server_thread *thread);
    void *user;
    pthread_t thread;
};

static void *begin(void *user)
{
    struct server_thread *thread = user;
    thread->run(thread->user, thread);
    return NULL;
}

static void destroy(struct server_thread *thread)
{
    pthread_cond_destroy(&thread->change);
    pthread_mutex_destroy(&thread->lock);
    free(thread);
}

struct server_thread *server_thread_start(void (*run)(void *user, struct server_thread *thread),
                                          void *user)
{
    struct server_thread *thread = calloc(1, sizeof *thread);
    pthread_condattr_t attributes;
    if (!thread) return NULL;
    thread->run = run;
    thread->user = user;
    pthread_mutex_init(&thread->lock, NULL);
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC); /* that of gd_now_ns */
    pthread_cond_init(&thread->change, &attributes);
    pthread_condattr_destroy(&attributes);
    if (pthread_create(&thread->thread, NULL, begin, thread) == 0) return thread;
    destroy(thread);
    return NULL;
}

/* Under the lock, which is given up meanwhile: until a change, or that time; false: it has come. */
static bool wait_until(struct server_thread *thread, uint64_t until_ns)
{
    const struct timespec until = {.tv_sec = (time_t)(until_ns / SECOND_NS),
                                   .tv_nsec = (long)(until_ns % SECOND_NS)};
    if (until_ns == SERVER_THREAD_FOREVER)
        return pthread_cond_wait(&thread->change, &thread->lock) == 0;
    return pthread_cond_timedwait(&thread->change, &thread->lock, &until) != ETIMEDOUT;
}

/* False: it is to end. */
static bool rest(struct server_thread *thread, uint64_t ns, bool ends_by_wake)
{
    uint64_t now = gd_now_ns(),
             until_ns = ns < SERVER_THREAD_FOREVER - now ? now + ns : SERVER_THREAD_FOREVER;
    bool has_time = true;
    pthread_mutex_lock(&thread->lock);
    while (has_time && !thread->is_stopping && !(ends_by_wake && thread->is_woken))
        has_time = wait_until(thread, until_ns);
    if (ends_by_wake) thread->is_woken = false;
    bool goes_on = !thread->is_stopping;
    pthread_mutex_unlock(&thread->lock);
    return goes_on;
}

bool server_thread_pause(struct server_thread *thread, uint64_t ns)
{
    return rest(thread, ns, true);
}

bool server_thread_sleep(struct server_thread *thread, uint64_t ns)
{
    return rest(thread, ns, false);
}

static void set(struct server_thread *thread, bool *what)
{
    pthread_mutex_lock(&thread->lock);
    *what = true;
    pthread_cond_signal(&thread->change);
    pthread_mutex_unlock(&thread->lock);
}

void server_thread_wake(struct server_thread *thread)
{
    set(thread, &thread->is_woken);
}

void server_thread_stop(struct server_thread *thread)
{
    if (!thread) return;
    set(thread, &thread->is_stopping);
    pthread_join(thread->thread, NULL);
    destroy(thread);
}
