/* Loads: which stored surfaces are being loaded, and who waits for them. Each is loaded once
 * however many ask.
 *
 *     switch (server_pending_loads_enter(loads, record, job, &load)) {
 *     case SERVER_PENDING_LOADS_LOAD: load it; server_pending_loads_end(load); ...
 *     case SERVER_PENDING_LOADS_WAIT: the job is parked: return, it will be resumed, to look again
 *     }
 *
 * One mutex guards the list; under it nothing calls out. */
#ifndef SERVER_SURFACES_PENDING_LOADS_H
#define SERVER_SURFACES_PENDING_LOADS_H

#include "server/store/record.h"
#include "server/work/workers.h"

struct server_pending_loads;
struct server_pending_load;

/* `workers` resume parked jobs; borrowed. NULL without memory. */
struct server_pending_loads *server_pending_loads_create(struct server_workers *workers);
void server_pending_loads_destroy(
    struct server_pending_loads *loads); /* no load is under way; NULL is harmless */

enum server_pending_loads_turn {
    SERVER_PENDING_LOADS_LOAD,
    SERVER_PENDING_LOADS_WAIT,
    SERVER_PENDING_LOADS_NO_MEMORY
};

/* LOAD: `*load` is the caller's to end. WAIT: the job is parked until that load ends or the job's
 * deadline passes. `job` NULL: somebody who doesn't wait; WAIT then means that another loads it. */
enum server_pending_loads_turn server_pending_loads_enter(struct server_pending_loads *loads,
                                                          struct server_record *record,
                                                          struct server_job *job,
                                                          struct server_pending_load **load);

/* Parks a job as a WAIT does if the record is being loaded; false: it is not. */
bool server_pending_loads_join(struct server_pending_loads *loads,
                               const struct server_record *record, struct server_job *job);

/* Ends a load: the parked jobs are resumed and look again, whether it succeeded or not. */
void server_pending_loads_end(struct server_pending_load *load);

/* Ends a load that would fail for anybody: the parked jobs are refused. */
void server_pending_loads_fail(struct server_pending_load *load, enum server_refusal why);

/* Refuses the parked jobs whose deadline has passed. */
void server_pending_loads_expire(struct server_pending_loads *loads, uint64_t now_ns);

#endif
