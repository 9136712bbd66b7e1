/* See thread_affinity.h. */
#include "server/work/thread_affinity.h"

#include <sched.h>
#include <stdatomic.h>
#include <sys/resource.h>

#define MOVE_NS UINT64_C(10000000) /* at least, between two moves of a thread */

/* Chooses the next core for a thread. Returns false unless each thread can have one. */
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
        (void)setpriority(PRIO_PROCESS, 0, SERVER_HTTP_NICE); /* Linux: of this thread only */
    }
    if (!place.has_core || place.is_bound != are_workers_busy) return;
    if (now_ns - place.moved_ns < MOVE_NS) return;
    place.moved_ns = now_ns;
    place.is_bound = !are_workers_busy;
    (void)sched_setaffinity(0, sizeof place.all, place.is_bound ? &place.own : &place.all);
}
