/* See place.h. */
#include "server/work/thread_affinity.h"

#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/resource.h>

#define WORKER_NICE 10
#define LOOK_NS     UINT64_C(10000000) /* a thread that speaks HTTP is moved so often at most */

/* The n-th of the cores that the set has. */
static int find_core(const cpu_set_t *cores, unsigned n)
{
    int core = 0;
    while (!CPU_ISSET(core, cores) || n--) core++;
    return core;
}

static bool set_nice(int nice)
{
    return setpriority(PRIO_PROCESS, 0, nice) == 0; /* Linux: of this thread only */
}

/* What is known of the calling thread. */
struct place {
    bool is_known, can_move; /* there are as many cores as threads */
    bool is_at_home;         /* bound to its own core */
    uint64_t looked_ns;
    cpu_set_t all, own;
};

static void find_place(struct place *place, uint32_t threads)
{
    static atomic_uint placed;
    place->is_known = true;
    (void)set_nice(SERVER_PLACE_NICE);
    place->can_move = sched_getaffinity(0, sizeof place->all, &place->all) == 0 &&
                      (uint32_t)CPU_COUNT(&place->all) == threads;
    if (!place->can_move) return;
    CPU_ZERO(&place->own);
    CPU_SET(find_core(&place->all, atomic_fetch_add(&placed, 1) % threads), &place->own);
}

void server_place_http(uint32_t threads, bool is_crowded, uint64_t now_ns)
{
    static _Thread_local struct place place;
    if (!place.is_known) find_place(&place, threads);
    if (!place.can_move || place.is_at_home != is_crowded || now_ns - place.looked_ns < LOOK_NS)
        return;
    place.looked_ns = now_ns;
    place.is_at_home = !is_crowded;
    (void)sched_setaffinity(0, sizeof place.all, is_crowded ? &place.all : &place.own);
}

/* Whether the thread may come back from SCHED_IDLE: the system asks for what it asks of one that
 * becomes less nice. */
static _Thread_local bool can_return, is_behind;

void server_place_worker(void)
{
    can_return = set_nice(WORKER_NICE) && set_nice(WORKER_NICE - 1) && set_nice(WORKER_NICE);
}

void server_place_behind(bool wanted)
{
    static const struct sched_param none;
    if (wanted == is_behind || !can_return) return;
    if (sched_setscheduler(0, wanted ? SCHED_IDLE : SCHED_OTHER, &none) == 0) is_behind = wanted;
}
