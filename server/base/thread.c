#include "server/base/thread.h"

#include <errno.h>
#include <stdlib.h>
#include <time.h>

#include "gd/control.h"

#define SECOND_NS UINT64_C(1000000000)

struct server_thread {
    pthread_mutex_t lock;
    pthread_cond_t change;
    bool is_woken, is_stopping, has_ended, is_abandoned; /* under the lock */
    void (*run)(void *user, struct server_thread *thread);
    void *user;
    pthread_t thread;
};

static void thread_set(struct server_thread *thread, bool *flag)
{
    SERVER_LOCK(&thread->lock);
    *flag = true;
    pthread_cond_broadcast(&thread->change);
}

static void thread_free(struct server_thread *thread)
{
    pthread_cond_destroy(&thread->change);
    pthread_mutex_destroy(&thread->lock);
    free(thread);
}

static void *thread_run(void *user)
{
    struct server_thread *thread = user;
    thread->run(thread->user, thread);
    pthread_mutex_lock(&thread->lock);
    bool is_abandoned = thread->is_abandoned;
    thread->has_ended = true;
    pthread_cond_broadcast(&thread->change);
    pthread_mutex_unlock(&thread->lock);
    if (is_abandoned) thread_free(thread);
    return NULL;
}

struct server_thread *server_thread_start(void (*run)(void *user, struct server_thread *thread),
                                          void *user)
{
    struct server_thread *thread = calloc(1, sizeof *thread);
    if (!thread) return NULL;
    thread->run = run;
    thread->user = user;
    pthread_mutex_init(&thread->lock, NULL);
    pthread_cond_init(&thread->change, NULL);
    if (pthread_create(&thread->thread, NULL, thread_run, thread) == 0) return thread;
    thread_free(thread);
    return NULL;
}

bool server_condition_wait(pthread_cond_t *condition, pthread_mutex_t *lock, uint64_t until_ns)
{
    const struct timespec until = {.tv_sec = (time_t)(until_ns / SECOND_NS),
                                   .tv_nsec = (long)(until_ns % SECOND_NS)};
    if (until_ns == SERVER_THREAD_FOREVER) return pthread_cond_wait(condition, lock) == 0;
    return pthread_cond_clockwait(condition, lock, CLOCK_MONOTONIC, &until) != ETIMEDOUT;
}

void server_pause(uint64_t ns)
{
    struct timespec rest = {.tv_sec = (time_t)(ns / SECOND_NS), .tv_nsec = (long)(ns % SECOND_NS)};
    while (nanosleep(&rest, &rest) != 0) continue;
}

uint64_t server_thread_cpu_ns(void)
{
    struct timespec cpu;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &cpu);
    return (uint64_t)cpu.tv_sec * SECOND_NS + (uint64_t)cpu.tv_nsec;
}

static uint64_t time_after(uint64_t ns)
{
    uint64_t now = gd_now_ns();
    return ns < SERVER_THREAD_FOREVER - now ? now + ns : SERVER_THREAD_FOREVER;
}

static bool thread_rest(struct server_thread *thread, uint64_t ns, bool ends_by_wake)
{
    uint64_t until_ns = time_after(ns);
    bool has_time = true;
    SERVER_LOCK(&thread->lock);
    while (has_time && !thread->is_stopping && !(ends_by_wake && thread->is_woken))
        has_time = server_condition_wait(&thread->change, &thread->lock, until_ns);
    if (ends_by_wake) thread->is_woken = false;
    return !thread->is_stopping;
}

bool server_thread_pause(struct server_thread *thread, uint64_t ns)
{
    return thread_rest(thread, ns, true);
}

bool server_thread_sleep(struct server_thread *thread, uint64_t ns)
{
    return thread_rest(thread, ns, false);
}

void server_thread_wake(struct server_thread *thread)
{
    thread_set(thread, &thread->is_woken);
}

bool server_thread_stop_within(struct server_thread *thread, uint64_t ns)
{
    uint64_t until_ns = time_after(ns);
    thread_set(thread, &thread->is_stopping);
    pthread_mutex_lock(&thread->lock);
    while (!thread->has_ended && server_condition_wait(&thread->change, &thread->lock, until_ns))
        continue;
    bool has_ended = thread->has_ended;
    if (!has_ended) pthread_detach(thread->thread);
    thread->is_abandoned = !has_ended;
    pthread_mutex_unlock(&thread->lock);
    if (!has_ended) return false;
    pthread_join(thread->thread, NULL);
    thread_free(thread);
    return true;
}

void server_thread_stop(struct server_thread *thread)
{
    if (thread) (void)server_thread_stop_within(thread, SERVER_THREAD_FOREVER);
}
