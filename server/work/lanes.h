/* Lanes: jobs, and the queue in which they wait for workers. Each tenant with waiting or running
 * jobs has a lane.
 *
 * DESIGN. A job has one owner at a time: its maker, this queue, the worker that runs it, or the
 * list in which it is parked. `next` belongs to the owner. A job ends with one call of `refuse`, or
 * with a call of `run` that does not park it.
 *
 * A worker takes a job of the tenant with the fewest running jobs. Among several such tenants it
 * takes the tenant that has used the least time (start-time fair queueing: a lane that becomes
 * active starts at the least time of the others). Each lane is first in, first out. Urgent jobs,
 * for which clients wait, precede patient jobs, but after 16 urgent jobs a patient job follows.
 *
 * Limits, which hold separately for urgent and for patient jobs: all lanes together have at most
 * `length` waiting jobs. A tenant with n waiting jobs may queue another job only while all lanes
 * together have room for more than n further jobs (dynamic thresholds, Choudhury and Hahne, 1998).
 *
 * Spare workers are threads beyond the number of workers. A spare worker takes an urgent job while
 * patient jobs occupy workers, or a job whose tenant has no running job.
 *
 * Not thread-safe: the lock of the workers guards the lanes. */
#pragma once

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

enum server_refusal { SERVER_REFUSAL_DEADLINE, SERVER_REFUSAL_DRAINING, SERVER_REFUSAL_MEMORY };

struct server_job {
    struct server_job *next;
    uint64_t deadline_ns; /* on the clock of gd_now_ns() */
    /* tenant whose lane the job uses; NULL means the tenant of the submitting job */
    const char *tenant;
    struct server_lane *lane; /* used by the workers */
    const void *parked_at;    /* see server_workers_park */
    uint64_t parked_until_ns; /* 0 means no limit */
    bool is_patient;          /* true if no client waits for the job on a connection */
    atomic_bool is_unwanted;  /* set by any thread; has the effect of a passed deadline */
    void (*run)(struct server_job *job);
    void (*refuse)(struct server_job *job, enum server_refusal why);
};

/* Returns true if the deadline is at most `now_ns` or the job is unwanted. */
bool server_job_is_late(const struct server_job *job, uint64_t now_ns);

/* Removes the late jobs from a list and returns them as a list. */
struct server_job *server_jobs_expire(struct server_job **list, uint64_t now_ns);

/* Refuses each job of a list. Call this function without a lock: `refuse` may take any. */
void server_jobs_refuse(struct server_job *list, enum server_refusal why);

enum server_lane_kind { SERVER_LANE_URGENT, SERVER_LANE_PATIENT, SERVER_LANE_KINDS };

struct server_lane {
    struct server_lane *next;
    const char *tenant; /* stored in the lane's allocation */
    struct server_lane_queue {
        struct server_job *head, **tail; /* `tail` points to the last `next` */
        uint32_t count;
    } queues[SERVER_LANE_KINDS];
    uint32_t running[SERVER_LANE_KINDS];
    uint64_t used_ns; /* time used by ended jobs, plus the virtual time at which the lane started */
};

struct server_lanes {
    struct server_lane own; /* lane of the tenant "" and of jobs without a tenant */
    struct server_lane *active;
    uint32_t queued[SERVER_LANE_KINDS], running[SERVER_LANE_KINDS];
    uint32_t length, workers;
    bool is_shared; /* true if tenants share the queue */
    unsigned turns; /* number of urgent jobs that were taken while a patient job waited */
};

/* Initialises `*lanes`, which must be all zero. */
void server_lanes_init(struct server_lanes *lanes, uint32_t workers, uint32_t length);

/* Returns the lane of a tenant; NULL means the tenant "". A new lane must get a job before the next
 * call. */
struct server_lane *server_lanes_of(struct server_lanes *lanes, const char *tenant);

/* Queues a job at the end of the lane. Returns false if the queue is full. With `is_first`, queues
 * the job at the front, even if the queue is full. */
bool server_lanes_push(struct server_lanes *lanes, struct server_lane *lane, struct server_job *job,
                       bool is_first);

/* Takes the next job, which counts as running until server_lanes_end. NULL means that there is no
 * job for this worker. */
struct server_job *server_lanes_take(struct server_lanes *lanes, bool is_spare);

/* Records that a job of that lane, patient or urgent, has run for `ns`. */
void server_lanes_end(struct server_lanes *lanes, struct server_lane *lane, bool is_patient,
                      uint64_t ns);

/* Removes the late jobs and returns them as a list. */
struct server_job *server_lanes_expire(struct server_lanes *lanes, uint64_t now_ns);

uint32_t server_lanes_queued(const struct server_lanes *lanes);
uint32_t server_lanes_running(const struct server_lanes *lanes);
