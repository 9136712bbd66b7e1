/* Thread priority: the priorities of HTTP threads and workers, and the cores of HTTP threads. What
 * the system refuses stays as it was. Figures: server/doc/008.
 *
 * DESIGN. HTTP threads run a little before other programs: otherwise a client on the same machine
 * preempts them at every answer. While no worker is busy, each has a core of its own, if there are
 * as many cores as HTTP threads: the kernel often runs all of them on one core and their clients on
 * the other. While workers are busy, it may run on all cores: a worker would leave its core at the
 * next tick only.
 *
 * Workers run at nice 10. A job that runs for long gets idle priority (SCHED_IDLE): the kernel
 * treats its core as an idle one, and a thread that wakes there runs at once. So that it does not
 * starve on a full machine, a job that gets less than an eighth of its time returns to normal
 * priority for one second, later for two, then four. Leaving idle priority needs a right
 * (CAP_SYS_NICE, LimitNICE=): without it a worker never enters it. */
#ifndef SERVER_WORK_THREAD_PRIORITY_H
#define SERVER_WORK_THREAD_PRIORITY_H

#include <stdbool.h>
#include <stdint.h>

#define SERVER_HTTP_NICE   (-3) /* the lowest nice value that a thread of the daemon asks for */
#define SERVER_WORKER_NICE 10

/* Places the calling thread, one of `threads` HTTP threads, for the request that it begins. */
void server_thread_place(uint32_t threads, bool are_workers_busy, uint64_t now_ns);

/* Lowers the calling thread, a new worker. */
void server_worker_lower(void);

/* Gives the calling thread idle or normal priority. Does nothing where it could not return. */
void server_worker_set_idle(bool is_idle);

/* The priority of one job; not shared. */
struct server_priority {
    bool is_idle;
    uint64_t not_before_ns;    /* normal until then */
    uint64_t return_ns;        /* length of the next return to normal */
    uint64_t since_ns, cpu_ns; /* start of the period in which its share is measured */
};

void server_priority_begin(struct server_priority *priority, uint64_t now_ns);

/* Returns whether the job has idle priority from now on. `cpu_ns`: processor time of its thread. */
bool server_priority_update(struct server_priority *priority, uint64_t now_ns, uint64_t cpu_ns);

#endif
