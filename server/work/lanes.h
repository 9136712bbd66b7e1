/* Lanes: the jobs that wait for workers, shared fairly by tenants. Each tenant with jobs that wait
 * or run has a lane.
 *
 * DESIGN. A worker takes the job of the tenant that has the fewest running, and among those of the
 * tenant whose jobs took the least time since it came (start-time fair queueing: a lane that
 * becomes active starts at the least time of the others, so that idle tenants save nothing up).
 * Within a lane jobs are taken in order. Urgent jobs, whose clients wait on the line, go before
 * patient ones; but after TURNS urgent ones a patient one has its turn.
 *
 * Bounds, for either kind: all lanes together hold `length` jobs. Where tenants share the queue,
 * each takes at most as many places as it leaves free (dynamic thresholds: Choudhury and Hahne,
 * 1998), so that there is room for another tenant, whatever one sends.
 *
 * A spare worker is one beyond the number of workers. It takes a job only if that keeps a promise
 * to a tenant: an urgent one while fewer urgent jobs run than there are workers, because patient
 * ones have them, or one whose tenant has none running.
 *
 * Not thread-safe: the workers' lock guards them. */
#ifndef SERVER_WORK_LANES_H
#define SERVER_WORK_LANES_H

#include <stdbool.h>
#include <stdint.h>

#include "server/work/job.h"
#include "server/store/key.h"

enum server_lane_kind { SERVER_LANE_URGENT, SERVER_LANE_PATIENT, SERVER_LANE_KINDS };

struct server_lane {
    struct server_lane *next;
    char tenant[SERVER_TENANT + 1];
    struct server_lane_queue {
        struct server_job *head, **tail; /* `tail` points to the last `next` */
        uint32_t count;
    } queues[SERVER_LANE_KINDS];
    uint32_t running[SERVER_LANE_KINDS];
    uint64_t used_ns; /* time of its jobs that have ended, from where it started */
};

struct server_lanes {
    struct server_lane own; /* of the tenant "", and of jobs without a tenant */
    struct server_lane *active;
    uint32_t queued[SERVER_LANE_KINDS], running[SERVER_LANE_KINDS];
    uint32_t length, workers;
    bool is_shared; /* by tenants */
    unsigned turns; /* urgent jobs that were taken while a patient one waited */
};

/* The initial value of `lanes` is all zero. */
void server_lanes_init(struct server_lanes *lanes, uint32_t workers, uint32_t length);

/* The lane of a tenant (NULL: ""). It is active, or has to be given a job before another call. */
struct server_lane *server_lanes_of(struct server_lanes *lanes, const char *tenant);

/* Queues a job in the lane behind all others; false: there is no place. */
bool server_lanes_push(struct server_lanes *lanes, struct server_lane *lane,
                       struct server_job *job);

/* Queues a job ahead of the others of its lane and kind, whether there is a place or not. */
void server_lanes_push_front(struct server_lanes *lanes, struct server_lane *lane,
                             struct server_job *job);

/* Takes the next job, which is running then, until server_lanes_end; NULL: there is none for
 * such a worker. */
struct server_job *server_lanes_take(struct server_lanes *lanes, bool is_spare);

/* A job of that lane and kind has run for so long. */
void server_lanes_end(struct server_lanes *lanes, struct server_lane *lane, bool is_patient,
                      uint64_t ns);

/* Takes the jobs that are late, as a list. */
struct server_job *server_lanes_expire(struct server_lanes *lanes, uint64_t now_ns);

uint32_t server_lanes_queued(const struct server_lanes *lanes);
uint32_t server_lanes_running(const struct server_lanes *lanes);

#endif
