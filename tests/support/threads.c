#include "tests/support/threads.h"

#include <pthread.h>
#include <stdatomic.h>

enum { THREADS_MOST = 16 };

struct run {
    void (*task)(void *context, uint32_t index);
    void *context;
    uint32_t count;
    atomic_uint next;
};

static void *do_tasks(void *user)
{
    struct run *run = user;
    for (uint32_t i; (i = atomic_fetch_add(&run->next, 1)) < run->count;) run->task(run->context, i);
    return NULL;
}

/* A thread that can't be started is done without. */
static void run_tasks(void *user, void (*task)(void *context, uint32_t index), void *context, uint32_t count)
{
    uint32_t width = (uint32_t)(uintptr_t)user, started = 0;
    struct run run = {.task = task, .context = context, .count = count};
    pthread_t threads[THREADS_MOST];
    while (started + 1 < width && started + 1 < count && !pthread_create(&threads[started], NULL, do_tasks, &run))
        started++;
    do_tasks(&run);
    while (started) pthread_join(threads[--started], NULL);
}

struct gd_executor test_threads(uint32_t width)
{
    if (width > THREADS_MOST) width = THREADS_MOST;
    return (struct gd_executor){.width = width, .run = run_tasks, .user = (void *)(uintptr_t)width};
}
