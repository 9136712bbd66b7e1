/* Async: one operation that was accepted to be answered later (jobs.h), and its answer.
 *
 * DESIGN. It is a transport (exchange.h): it carries an exchange of its own, made from the one that
 * asked for it, through the router's dispatch, the handler and the workers, as a connection would,
 * and keeps what it is answered with. So handlers know nothing of jobs, and a job parks on the same
 * pending builds and loads as everybody else.
 *
 * Ownership: counted, once for the table of jobs, once for its exchange, once for each that looks
 * at it. */
#ifndef SERVER_JOBS_ASYNC_H
#define SERVER_JOBS_ASYNC_H

#include "proto/job.h"
#include "server/http/exchange.h"
#include "server/jobs/saved_response.h"
#include "server/store/key.h"

#define SERVER_ASYNC_STEPS 1000000 /* of its progress */
#define SERVER_ASYNC_ID    25      /* 12 digits that grow, 12 that can't be guessed, NUL */

struct server_jobs;

struct server_async {
    struct server_transport transport; /* first: an exchange finds its job by it */
    struct server_jobs *jobs;
    atomic_uint references;
    char id[SERVER_ASYNC_ID];
    char tenant[SERVER_TENANT + 1];   /* whose it is (key.h) */
    char key[SERVER_CREDENTIAL_NAME]; /* which began it; "": the daemon has none */
    char *request;
    int64_t created;
    atomic_uint progress; /* in SERVER_ASYNC_STEPS; only grows */
    /* under the lock of the jobs: */
    enum proto_job_state state;
    struct server_exchange *exchange; /* not answered yet; NULL: it is */
    uint64_t ended_ns;
    struct server_holding *holding; /* NULL: it is not in the table */
    size_t held;                    /* bytes of SERVER_BUDGET_JOBS that are counted for it */
    /* unchanged once the state is DONE or FAILED: */
    struct server_kept kept;
    struct server_budget *budget;
    size_t own; /* bytes of SERVER_BUDGET_RECORDS that are counted for this struct */
};

/* Take no lock: so they may be called under one. */
struct server_async *server_async_retain(struct server_async *job);
void server_async_release(struct server_async *job); /* NULL is harmless */

/* --- for the table of jobs -------------------------------------------------------------------- */

/* A job of a request whose body is there, with a reference and without an id yet. The exchange can
 * be answered, but its body and parameters are the job's. NULL without memory. */
struct server_async *server_async_create(struct server_jobs *jobs,
                                         struct server_exchange *exchange);

/* Sends it on its way, or gives up one that is not to go: then it is released. */
void server_async_run(struct server_async *job);
void server_async_abandon(struct server_async *job);

#endif
