/* Pending loads: the stored surfaces that are being loaded, and the jobs that wait for them. Each
 * surface is loaded once, for all requests.
 *
 *     switch (server_pending_loads_enter(loads, record, job, &load)) {
 *     case SERVER_PENDING_LOADS_LOAD: load it; server_pending_loads_end(load); ...
 *     case SERVER_PENDING_LOADS_WAIT: the job is parked: return; it will be resumed, to look again
 *     }
 *
 * One mutex guards the list. All functions are thread-safe. */
#ifndef SERVER_SURFACES_PENDING_LOADS_H
#define SERVER_SURFACES_PENDING_LOADS_H

#include "server/store/record.h"
#include "server/work/workers.h"

struct server_pending_loads;
struct server_pending_load;

/* `workers` resume parked jobs; borrowed. NULL without memory. */
struct server_pending_loads *server_pending_loads_create(struct server_workers *workers);
void server_pending_loads_destroy(struct server_pending_loads *loads); /* NULL is harmless */

enum server_pending_loads_turn {
    SERVER_PENDING_LOADS_LOAD, /* `*load` is the caller's to end */
    SERVER_PENDING_LOADS_WAIT, /* the job is parked until the load ends or its deadline passes */
    SERVER_PENDING_LOADS_NO_MEMORY
};

/* `job` may be NULL: then the caller does not wait. */
enum server_pending_loads_turn server_pending_loads_enter(struct server_pending_loads *loads,
                                                          struct server_record *record,
                                                          struct server_job *job,
                                                          struct server_pending_load **load);

/* Parks a job as WAIT does if the record is being loaded; false: it is not. */
bool server_pending_loads_join(struct server_pending_loads *loads,
                               const struct server_record *record, struct server_job *job);

/* Ends a load, successful or not, and resumes the parked jobs. */
void server_pending_loads_end(struct server_pending_load *load);

/* Ends a load that would fail for all, and refuses the parked jobs. */
void server_pending_loads_fail(struct server_pending_load *load, enum server_refusal why);

/* Refuses the parked jobs whose deadline has passed. */
void server_pending_loads_expire(struct server_pending_loads *loads, uint64_t now_ns);

#endif
