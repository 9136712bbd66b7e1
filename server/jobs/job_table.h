/* Job table: the requests that were accepted to be answered later (202), and their answers.
 *
 *     job = server_job_table_start(table, exchange, &problem);
 *     state = server_deferred_job_describe(job);
 *     server_deferred_job_release(job);
 *
 * DESIGN. A deferred job is a transport (exchange.h): it carries an exchange of its own through
 * dispatch, handler and workers as a connection does, and saves the answer. Handlers know nothing
 * of jobs.
 *
 * States: queued -> running -> done | failed, and cancelled from the first two. A cancelled job
 * shows its state at once; its exchange is refused where it waits or stopped by its control.
 *
 * Bounds: ended jobs are dropped when their time to live is over, and earlier when the table or the
 * memory for answers (SERVER_BUDGET_JOBS) is full: then the oldest job of the largest user. Jobs
 * that have not ended are never dropped; with keys a tenant has at most as many of them as it
 * leaves places free. Ids grow, so the table is sorted by both id and age.
 *
 * A job is counted, once for the table, once for its exchange, once for each holder. One mutex
 * guards the table and the states. Under it nothing is called that takes a lock. All functions are
 * thread-safe. */
#ifndef SERVER_JOBS_JOB_TABLE_H
#define SERVER_JOBS_JOB_TABLE_H

#include "proto/http/job.h"
#include "server/exchange/exchange.h"

#define SERVER_JOB_ID 25 /* with the NUL */

struct server_deferred_job;
struct server_job_table;

/* Writes an id of a job or a batch: 12 hexadecimal digits that grow with time and 12 random ones,
 * above all earlier ones of this process; returns the time, in seconds since 1970. Thread-safe. */
int64_t server_job_id_create(char id[SERVER_JOB_ID]);

struct server_job_limits {
    uint32_t jobs;
    size_t answer_bytes;
    uint64_t ttl_s;    /* after the end of a job */
    bool are_tenanted; /* there are keys: tenants share the table */
};

/* The host is borrowed. NULL without memory. */
struct server_job_table *server_job_table_create(struct server_host *host,
                                                 const struct server_job_limits *limits);

/* No exchange is deferred any more. NULL is harmless. */
void server_job_table_destroy(struct server_job_table *table);

/* Makes a job of a request whose body is read, and starts it; the caller gets a reference. The
 * exchange can still be answered, but its body belongs to the job. NULL with overloaded, draining
 * or insufficient_memory. */
struct server_deferred_job *server_job_table_start(struct server_job_table *table,
                                                   struct server_exchange *exchange,
                                                   struct proto_problem *problem);

/* The tenant's job of that id, for the caller to release, or NULL. */
struct server_deferred_job *server_job_table_find(struct server_job_table *table,
                                                  const char *tenant, const char *id, size_t size);

/* Writes at most `most` of the tenant's jobs with ids above `after` (NULL: from the first), for the
 * caller to release; returns their number. */
uint32_t server_job_table_list(struct server_job_table *table, const char *tenant,
                               const char *after, uint32_t most, struct server_deferred_job **out);

/* Cancels a job that has not ended, removes one that has. */
void server_job_table_cancel(struct server_job_table *table, struct server_deferred_job *job);

bool server_job_table_is_empty(struct server_job_table *table);

/* Drops the jobs whose time to live is over; checks at most once a second. */
void server_job_table_expire(struct server_job_table *table, uint64_t now_ns);

/* Refuses the queued jobs and all later ones. */
void server_job_table_drain(struct server_job_table *table);

struct server_job_statistics {
    uint64_t now[PROTO_JOB_STATE_COUNT];   /* jobs in the table */
    uint64_t ended[PROTO_JOB_STATE_COUNT]; /* since the start; the last three states */
};

/* Of one tenant, without `ended`; NULL: of all. */
struct server_job_statistics server_job_table_statistics(struct server_job_table *table,
                                                         const char *tenant);

struct server_deferred_job *server_deferred_job_retain(struct server_deferred_job *job);
void server_deferred_job_release(struct server_deferred_job *job); /* NULL is harmless */

/* The current state. Its pointers live as long as the caller's reference. */
struct proto_job server_deferred_job_describe(struct server_deferred_job *job);

/* The name of the key that started the job; "": the daemon has no keys. */
const char *server_deferred_job_key(const struct server_deferred_job *job);

#endif
