#include "server/work/thread_priority.h"

#include <sched.h>
#include <stdatomic.h>
#include <sys/resource.h>

#define MOVE_NS    UINT64_C(10000000)   /* least time between two changes of a thread's cores */
#define LONG_NS    UINT64_C(50000000)   /* time after which a job gets idle priority */
#define MEASURE_NS UINT64_C(100000000)  /* period over which the share of a job is measured */
#define SHARE      8                    /* a job that gets less than 1/8 of the time is starving */
#define RETURN_NS  UINT64_C(1000000000) /* length of the first return to normal priority */

/* Sets the nice value. On Linux this concerns only the calling thread. */
static bool thread_set_nice(int nice)
{
    return setpriority(PRIO_PROCESS, 0, nice) == 0;
}

/* Chooses the next core for a thread. Returns false if there are fewer cores than threads. */
static bool core_choose(uint32_t threads, cpu_set_t *all, cpu_set_t *own)
{
    static atomic_uint chosen;
    if (sched_getaffinity(0, sizeof *all, all) != 0) return false;
    if ((uint32_t)CPU_COUNT(all) != threads) return false;
    int core = 0;
    for (unsigned skip = atomic_fetch_add(&chosen, 1) % threads; !CPU_ISSET(core, all) || skip--;)
        core++;
    CPU_ZERO(own);
    CPU_SET(core, own);
    return true;
}

void server_thread_place(uint32_t threads, bool are_workers_busy, uint64_t now_ns)
{
    static _Thread_local struct {
        bool is_known, has_core, is_bound;
        uint64_t moved_ns;
        cpu_set_t all, own;
    } place;
    if (!place.is_known) {
        place.is_known = true;
        place.has_core = core_choose(threads, &place.all, &place.own);
        (void)thread_set_nice(SERVER_HTTP_NICE);
    }
    if (!place.has_core || place.is_bound != are_workers_busy) return;
    if (now_ns - place.moved_ns < MOVE_NS) return;
    place.moved_ns = now_ns;
    place.is_bound = !are_workers_busy;
    (void)sched_setaffinity(0, sizeof place.all, place.is_bound ? &place.own : &place.all);
}

static _Thread_local bool can_return, is_now_idle;

/* Lowers the priority of a new worker. Tests whether the worker may leave idle priority: a thread
 * may leave SCHED_IDLE if it may lower its nice value. */
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

void server_thread_set_idle(void)
{
    static const struct sched_param none;
    (void)sched_setscheduler(0, SCHED_IDLE, &none);
}

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
