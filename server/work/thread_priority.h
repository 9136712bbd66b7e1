/* Thread priority: the priorities of HTTP threads and workers, and the cores of HTTP threads. If
 * the system refuses a call, nothing changes. server/doc/008 has measurements.
 *
 * DESIGN. HTTP threads have a slightly higher priority than other programs. Otherwise a client on
 * the same machine preempts them at every answer. While no worker is busy, each HTTP thread has its
 * own core, if there are enough cores. Otherwise the kernel often runs all of them on one core and
 * their clients on another. While workers are busy, an HTTP thread may run on all cores, because a
 * worker leaves a core only at the kernel's next timer tick.
 *
 * Workers run at nice 10. A long job gets idle priority (SCHED_IDLE): the kernel treats its core as
 * idle, so a thread that wakes there runs at once. To prevent starvation on a busy machine, a job
 * that gets less than an eighth of a core's time returns to normal priority: the first time for one
 * second, then for two, then for four. Leaving idle priority needs a right (CAP_SYS_NICE,
 * LimitNICE=). Without it a worker never enters idle priority. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#define SERVER_HTTP_NICE   (-3) /* the lowest nice value of the daemon's threads */
#define SERVER_WORKER_NICE 10

/* Called by each of `threads` HTTP threads at a request: sets the cores that it may use. */
void server_thread_place(uint32_t threads, bool are_workers_busy, uint64_t now_ns);

/* Lowers the priority of the calling thread, a new worker. */
void server_worker_lower(void);

/* Gives the calling thread idle priority permanently. */
void server_thread_set_idle(void);

/* Gives the calling thread idle or normal priority; does nothing if the thread could not leave idle
 * priority again. */
void server_worker_set_idle(bool is_idle);

/* The priority of one job. Used by one thread. */
struct server_priority {
    bool is_idle;
    uint64_t not_before_ns; /* the job has normal priority until this time */
    uint64_t return_ns;     /* length of the next return to normal priority */
    /* start of the current measuring period, and processor time at its start */
    uint64_t since_ns, cpu_ns;
};

void server_priority_begin(struct server_priority *priority, uint64_t now_ns);

/* Returns true if the job has idle priority from now on. `cpu_ns` is the processor time of its
 * thread. */
bool server_priority_update(struct server_priority *priority, uint64_t now_ns, uint64_t cpu_ns);
