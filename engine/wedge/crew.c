#include "wedge/crew.h"

#include <sched.h>

#define SPINS 4096 /* before a waiting thread lets others run */

static void relax(uint32_t *spins)
{
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
    if (++*spins % SPINS == 0) sched_yield();
}

/* Claims jobs of the round that the ticket is of until there are none. A ticket says how many jobs its own round has, so a claim that comes late
 * can't take a job of another round. */
static uint32_t claim_all(struct gd__crew *crew, uint32_t member)
{
    for (;;) {
        uint64_t ticket = atomic_fetch_add_explicit(&crew->ticket, 1, memory_order_acquire);
        uint32_t job = ticket & 0xffff, jobs = ticket >> 16 & 0xffff;
        if (job >= jobs) return (uint32_t)(ticket >> 32);
        crew->work(crew->user, job, member);
        atomic_fetch_add_explicit(&crew->done, 1, memory_order_release);
    }
}

void gd__crew_round(struct gd__crew *crew, uint32_t count)
{
    if (crew->members == 1) {
        for (uint32_t job = 0; job < count; job++) crew->work(crew->user, job, 0);
        return;
    }
    uint64_t round = (atomic_load_explicit(&crew->ticket, memory_order_relaxed) >> 32) + 1;
    uint32_t spins = 0;
    atomic_store_explicit(&crew->done, 0, memory_order_relaxed);
    atomic_store_explicit(&crew->ticket, round << 32 | (uint64_t)count << 16, memory_order_release);
    claim_all(crew, 0);
    while (atomic_load_explicit(&crew->done, memory_order_acquire) < count) relax(&spins);
}

/* A helper: from round to round until it is over. It looks before it claims, so that idle looking leaves the ticket alone. */
static void help(struct gd__crew *crew, uint32_t member)
{
    uint32_t seen = 0, spins = 0;
    while (!atomic_load_explicit(&crew->over, memory_order_acquire)) {
        if ((uint32_t)(atomic_load_explicit(&crew->ticket, memory_order_acquire) >> 32) == seen)
            relax(&spins);
        else
            seen = claim_all(crew, member);
    }
}

/* Who arrives first leads: tasks may come in any order, and one after the other. */
static void take_part(void *context, uint32_t index)
{
    (void)index;
    struct gd__crew *crew = context;
    uint32_t member = atomic_fetch_add(&crew->arrived, 1);
    if (member) {
        help(crew, member);
        return;
    }
    crew->lead(crew->user);
    atomic_store_explicit(&crew->over, 1, memory_order_release);
}

void gd__crew_run(struct gd__crew *crew, const struct gd_executor *executor)
{
    uint32_t members = executor ? executor->width : 1;
    crew->members = members < GD__CREW_MOST ? members : GD__CREW_MOST;
    atomic_store(&crew->ticket, 0);
    atomic_store(&crew->over, 0);
    atomic_store(&crew->arrived, 0);
    gd_executor_run(members > 1 ? executor : NULL, take_part, crew, crew->members);
}
