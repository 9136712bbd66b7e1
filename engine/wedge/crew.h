/* Crew: the threads of an executor doing the jobs of one round after the other.
 *
 * A propagation has thousands of rounds of some microseconds, too short to be handed to an executor each. So the executor is asked once, for as
 * many tasks as it is wide: the first to arrive leads, the others wait for rounds by spinning. Jobs are claimed one by one, by the leader too: a helper that
 * never comes, or comes late, costs nothing, and on one thread the leader does all. */
#ifndef GD_WEDGE_CREW_H
#define GD_WEDGE_CREW_H

#include <stdatomic.h>
#include <stdint.h>

#include "gd/executor.h"

#define GD__CREW_MOST 8 /* members */

struct gd__crew {
    void (*lead)(void *user);
    void (*work)(void *user, uint32_t job, uint32_t member);
    void *user;
    _Atomic uint64_t ticket; /* round << 32 | jobs << 16 | next job */
    atomic_uint done, over, arrived;
    uint32_t members;
};

/* Runs lead(user) once; within it gd__crew_round may be called. work(user, job, member) runs on any of the threads, 0 <= member < GD__CREW_MOST, the leader
 * is member 0; no two run with the same member at the same time. Returns when all have returned. NULL executor: one thread. */
void gd__crew_run(struct gd__crew *crew, const struct gd_executor *executor);

/* Does jobs [0, count), count < 2^15, each once; returns when all are done. */
void gd__crew_round(struct gd__crew *crew, uint32_t count);

#endif
