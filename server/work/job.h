/* Job: a piece of work for the second lane, and lists of jobs.
 *
 * A job has one owner at a time: its maker, the workers' queue, the thread that runs it, or a
 * pending build of the cache that it was parked in; `next` belongs to that owner. It ends in one
 * call of `run` that does not park it, or of `refuse`. */
#ifndef SERVER_WORK_JOB_H
#define SERVER_WORK_JOB_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

struct server_lane;

enum server_refusal { SERVER_REFUSAL_DEADLINE, SERVER_REFUSAL_DRAINING, SERVER_REFUSAL_MEMORY };

struct server_job {
    struct server_job *next;
    uint64_t deadline_ns; /* on the clock of gd_now_ns() */
    const char *tenant;   /* whose share of the workers it uses (lanes.h), as long as the job lives;
                             NULL: that of the   job that submits it */
    struct server_lane *lane; /* the workers' own */
    bool is_patient;          /* no client waits on the line for it */
    atomic_bool is_unwanted;  /* set by any thread: as if the deadline had passed */
    void (*run)(struct server_job *job);
    void (*refuse)(struct server_job *job, enum server_refusal why);
};

/* True when the deadline is at most `now_ns`, or the job is not wanted any more. */
bool server_job_is_late(const struct server_job *job, uint64_t now_ns);

/* Takes the jobs that are late out of a list and returns them as another. */
struct server_job *server_jobs_expire(struct server_job **list, uint64_t now_ns);

/* Refuses each job of a list. To be called without any lock: what refuses may take them. */
void server_jobs_refuse(struct server_job *list, enum server_refusal why);

#endif
