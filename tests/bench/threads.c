/* An executor with its own threads. The threads wait by spinning, since the tasks of one field
 * follow each other within microseconds. */
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/bench/bench.h"

#define LOOKS 20000 /* number of spins before a thread yields */

static struct {
    void (*task)(void *context, uint32_t index);
    void *context;
    uint32_t count;
    atomic_uint round, next, left;
} job;

static void work(void)
{
    for (uint32_t i; (i = atomic_fetch_add(&job.next, 1)) < job.count;) {
        job.task(job.context, i);
        atomic_fetch_sub(&job.left, 1);
    }
}

static void wait_until_not(atomic_uint *value, unsigned was)
{
    for (uint32_t looks = 1; atomic_load(value) == was; looks++)
        if (looks % LOOKS == 0) sched_yield();
}

static void *help(void *unused)
{
    (void)unused;
    for (unsigned seen = 0;; seen++) {
        wait_until_not(&job.round, seen);
        work();
        atomic_fetch_sub(&job.left, 1);
    }
    return NULL;
}

static uint32_t helpers;

/* Runs the tasks. A round also waits until each helper has left the round. So no helper still reads
 * the data of a round when the next round begins. */
static void run(void *user, void (*task)(void *context, uint32_t index), void *context,
                uint32_t count)
{
    (void)user;
    job.task = task;
    job.context = context;
    job.count = count;
    atomic_store(&job.next, 0);
    atomic_store(&job.left, count + helpers);
    atomic_fetch_add(&job.round, 1);
    work();
    for (uint32_t looks = 1; atomic_load(&job.left); looks++)
        if (looks % LOOKS == 0) sched_yield();
}

const struct gd_executor *bench_executor(uint32_t threads)
{
    static struct gd_executor executor = {.run = run};
    for (; helpers + 1 < threads; helpers++) {
        pthread_t thread;
        if (pthread_create(&thread, NULL, help, NULL)) {
            fprintf(stderr, "gd_bench: --threads %u: no more threads.\n", threads);
            exit(1);
        }
        pthread_detach(thread);
    }
    executor.width = threads;
    return threads > 1 ? &executor : NULL;
}
