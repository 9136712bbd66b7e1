/* Job table: requests that were accepted with 202, and their later answers.
 *
 *     job = server_job_table_start(table, exchange, &problem);
 *     state = server_deferred_job_describe(job);
 *     server_deferred_job_release(job);
 *
 * DESIGN. A deferred job is a transport (exchange.h): like a connection, it passes its own exchange
 * through dispatch, handler and workers. Then it saves the answer. Handlers do not depend on jobs.
 *
 * States: queued -> running -> done | failed. A queued or running job can become cancelled. This
 * state is visible at once. The exchange of a cancelled job ends later: it is refused if it waits
 * for a worker, and stopped by its control if it runs.
 *
 * Bounds: an ended job is dropped when its time to live is over. If the table or the memory for
 * answers (SERVER_BUDGET_JOBS) is full before that, the oldest ended job of the largest user (key)
 * is dropped. Jobs that have not ended are never dropped. If the daemon has keys, a tenant with n
 * unfinished jobs may start another job only while the table has room for more than n further
 * unfinished jobs. Ids increase with time, so the order by id is also the order by age.
 *
 * A job is reference-counted; the table, the exchange and each caller that uses the job have a
 * reference. One mutex guards the table and the states. A thread that holds it may take only the
 * workers' lock. All functions are thread-safe. */
#pragma once

#include "proto/http/job.h"
#include "server/exchange/exchange.h"

#define SERVER_JOB_ID 25 /* bytes, with the NUL */

struct server_deferred_job;
struct server_job_table;

/* Writes an id for a job or a batch: 12 hexadecimal digits that increase with time, and 12 random
 * digits. The id is greater than all earlier ids of this process. Returns the time, in seconds
 * since 1970. Thread-safe. */
int64_t server_job_id_create(char id[SERVER_JOB_ID]);

struct server_job_limits {
    uint32_t jobs;
    size_t answer_bytes;
    uint64_t ttl_s;    /* time for which an ended job is kept */
    bool are_tenanted; /* true if the daemon has keys, and tenants share the table */
};

/* Borrows the host. Returns NULL if out of memory. */
struct server_job_table *server_job_table_create(struct server_host *host,
                                                 const struct server_job_limits *limits);

/* Call this function when no exchange is deferred. NULL is allowed. */
void server_job_table_destroy(struct server_job_table *table);

/* Creates and starts a job for a request whose body was read. Returns a reference of the job. The
 * exchange can still be answered, but its body now belongs to the job. On failure, returns NULL
 * with the problem overloaded, draining or insufficient_memory. */
struct server_deferred_job *server_job_table_start(struct server_job_table *table,
                                                   struct server_exchange *exchange,
                                                   struct proto_problem *problem);

/* Returns the tenant's job of that id, which the caller releases, or NULL. */
struct server_deferred_job *server_job_table_find(struct server_job_table *table,
                                                  const char *tenant, const char *id, size_t size);

/* Lists up to `most` of the tenant's jobs with ids above `after`; NULL means all ids. Each job is
 * retained. */
uint32_t server_job_table_list(struct server_job_table *table, const char *tenant,
                               const char *after, uint32_t most, struct server_deferred_job **out);

/* Cancels a job that has not ended, or removes an ended one. */
void server_job_table_cancel(struct server_job_table *table, struct server_deferred_job *job);

bool server_job_table_is_empty(struct server_job_table *table);

/* Drops the jobs whose time to live is over; checks at most once a second. */
void server_job_table_expire(struct server_job_table *table, uint64_t now_ns);

/* Refuses the queued jobs and all later ones. */
void server_job_table_drain(struct server_job_table *table);

struct server_job_statistics {
    uint64_t now[PROTO_JOB_STATE_COUNT]; /* jobs in the table */
    /* number of jobs that ended since the start, for each of the three final states */
    uint64_t ended[PROTO_JOB_STATE_COUNT];
};

/* Returns the statistics of all tenants if `tenant` is NULL. Otherwise returns those of the tenant;
 * `ended` is then 0. */
struct server_job_statistics server_job_table_statistics(struct server_job_table *table,
                                                         const char *tenant);

struct server_deferred_job *server_deferred_job_retain(struct server_deferred_job *job);
void server_deferred_job_release(struct server_deferred_job *job); /* NULL is allowed */

/* Returns the current state. Its pointers live as long as the caller's reference. */
struct proto_job server_deferred_job_describe(struct server_deferred_job *job);

/* Parks a worker's job until the deferred job has ended, the daemon drains, or `until_ns` is
 * reached. Returns false, without parking the job, if one of these conditions already holds. */
bool server_deferred_job_wait(struct server_deferred_job *job, struct server_job *waiting,
                              uint64_t until_ns);

/* Returns the name of the key that started the job, or "" if the daemon has no keys. */
const char *server_deferred_job_key(const struct server_deferred_job *job);
