/* An executor of two threads, for tests. */
#pragma once

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "gd/executor.h"

struct two_threads_run {
    void (*task)(void *context, uint32_t index);
    void *context;
    uint32_t count;
    atomic_uint next;
};

static inline void *two_threads_work(void *user)
{
    struct two_threads_run *run = user;
    for (uint32_t i; (i = atomic_fetch_add(&run->next, 1)) < run->count;)
        run->task(run->context, i);
    return NULL;
}

static inline void two_threads_execute(void *user, void (*task)(void *context, uint32_t index),
                                       void *context, uint32_t count)
{
    struct two_threads_run run = {task, context, count, 0};
    pthread_t other;
    (void)user;
    if (pthread_create(&other, NULL, two_threads_work, &run)) abort();
    two_threads_work(&run);
    pthread_join(other, NULL);
}

static const struct gd_executor two_threads = {.width = 2, .run = two_threads_execute};
