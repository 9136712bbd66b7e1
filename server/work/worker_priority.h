/* Worker priority: workers run after all other threads. What the system refuses stays as it was.
 * Figures: server/doc/008.
 *
 * DESIGN. Workers run at nice 10. A job that runs for long gets idle priority (SCHED_IDLE): the
 * kernel treats its core as an idle one, and a thread that wakes there runs at once. Such a policy
 * starves on a full machine. So a job that gets less than an eighth of its time returns to normal
 * priority for one second, later for two, then four: it may be slow, but it never starves. Leaving
 * idle priority needs a right (CAP_SYS_NICE, LimitNICE=): without it a worker never enters it. */
#ifndef SERVER_WORK_WORKER_PRIORITY_H
#define SERVER_WORK_WORKER_PRIORITY_H

#include <stdbool.h>
#include <stdint.h>

#define SERVER_WORKER_NICE 10

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
