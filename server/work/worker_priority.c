/* See worker_priority.h. */
#include "server/work/worker_priority.h"

#include <sched.h>
#include <sys/resource.h>

#define LONG_NS    UINT64_C(50000000)   /* a job that runs longer gets idle priority */
#define MEASURE_NS UINT64_C(100000000)  /* period over which its share is measured */
#define SHARE      8                    /* one part in so many is enough */
#define RETURN_NS  UINT64_C(1000000000) /* the first return to normal */

/* --- the thread ------------------------------------------------------------------------------- */

static _Thread_local bool can_return, is_now_idle;

/* On Linux this is the nice value of the calling thread only. */
static bool thread_set_nice(int nice)
{
    return setpriority(PRIO_PROCESS, 0, nice) == 0;
}

/* The kernel lets a thread leave SCHED_IDLE if it lets the thread lower its nice value. */
void server_worker_lower(void)
{
    can_return = thread_set_nice(SERVER_WORKER_NICE) && thread_set_nice(SERVER_WORKER_NICE - 1) &&
                 thread_set_nice(SERVER_WORKER_NICE);
}

void server_worker_set_idle(bool is_idle)
{
    static const struct sched_param none;
    if (is_idle == is_now_idle || !can_return) return;
    if (sched_setscheduler(0, is_idle ? SCHED_IDLE : SCHED_OTHER, &none) == 0)
        is_now_idle = is_idle;
}

/* --- its job ---------------------------------------------------------------------------------- */

void server_priority_begin(struct server_priority *priority, uint64_t now_ns)
{
    *priority = (struct server_priority){.not_before_ns = now_ns + LONG_NS, .return_ns = RETURN_NS};
}

bool server_priority_update(struct server_priority *priority, uint64_t now_ns, uint64_t cpu_ns)
{
    bool was_idle = priority->is_idle;
    uint64_t period_ns = now_ns - priority->since_ns;
    priority->is_idle = now_ns >= priority->not_before_ns;
    if (!priority->is_idle || (was_idle && period_ns < MEASURE_NS)) return priority->is_idle;
    if (was_idle && (cpu_ns - priority->cpu_ns) * SHARE < period_ns) {
        priority->is_idle = false;
        priority->not_before_ns = now_ns + priority->return_ns;
        priority->return_ns *= 2;
    }
    priority->since_ns = now_ns;
    priority->cpu_ns = cpu_ns;
    return priority->is_idle;
}
