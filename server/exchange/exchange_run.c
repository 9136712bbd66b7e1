/* See exchange.h. How workers take up an exchange, and how it ends. */
#include "server/exchange/exchange.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "server/exchange/events.h"
#include "server/exchange/reply.h"

/* --- the end ---------------------------------------------------------------------------------- */

static void drop_state(struct server_exchange *exchange)
{
    if (exchange->free_state) exchange->free_state(exchange->state);
    exchange->free_state = NULL;
    exchange->state = NULL;
}

void server_exchange_end(struct server_exchange *exchange)
{
    drop_state(exchange);
    if (exchange->surface) exchange->release_surface(exchange->surface);
    server_body_drop(&exchange->body, exchange->host->budget);
    server_budget_give(exchange->host->budget, SERVER_BUDGET_FLIGHT, exchange->held);
    server_grant_end(&exchange->grant);
    server_reply_drop_body(exchange);
    free(exchange->copies);
    free(exchange->target);
}

void server_exchange_destroy(struct server_exchange *exchange)
{
    if (!exchange) return;
    server_exchange_end(exchange);
    free(exchange);
}

void server_exchange_keep(struct server_exchange *exchange, void *state,
                          void (*free_state)(void *state))
{
    exchange->state = state;
    exchange->free_state = free_state;
}

/* --- work ------------------------------------------------------------------------------------- */

struct server_exchange *server_exchange_of(struct server_job *job)
{
    return (struct server_exchange *)((char *)job - offsetof(struct server_exchange, job));
}

void server_exchange_shorten(struct server_exchange *exchange, uint64_t timeout_ms)
{
    uint64_t limit_ms = exchange->host->timeout_ms;
    if (!timeout_ms || timeout_ms >= limit_ms) return;
    exchange->job.deadline_ns -= (limit_ms - timeout_ms) * 1000000;
}

void server_exchange_defer(struct server_exchange *exchange,
                           bool (*work)(struct server_exchange *exchange),
                           bool (*join)(struct server_exchange *exchange))
{
    exchange->work = work;
    exchange->join = join;
}

static void exchange_finish(struct server_exchange *exchange)
{
    struct server_host *host = exchange->host;
    drop_state(exchange); /* now: others may wait for what it holds */
    exchange->transport->finish(exchange);
    atomic_fetch_sub(&host->deferred, 1);
}

void server_exchange_job_run(struct server_job *job)
{
    struct server_exchange *exchange = server_exchange_of(job);
    if (exchange->transport->begin) exchange->transport->begin(exchange);
    do {
        if (!exchange->work(exchange)) return; /* parked: it may be another thread's by now */
    } while (!exchange->response.status);
    exchange_finish(exchange);
}

/* A job that is not wanted is late. */
void server_exchange_job_refuse(struct server_job *job, enum server_refusal why)
{
    struct server_exchange *exchange = server_exchange_of(job);
    struct proto_problem problem;
    switch (why) {
    case SERVER_REFUSAL_DEADLINE:
        (void)proto_problem_from_status(
            &problem, atomic_load(&job->is_unwanted) ? GD_CANCELLED : GD_DEADLINE, NULL);
        break;
    case SERVER_REFUSAL_DRAINING:
        (void)proto_problem_from_status(&problem, GD_CANCELLED, NULL);
        break;
    case SERVER_REFUSAL_MEMORY:
        (void)server_budget_refuse(exchange->host->budget, "the mesh", 0, &problem);
        break;
    }
    server_reply_problem(exchange, &problem);
    exchange_finish(exchange);
}

void server_exchange_count_deferred(struct server_host *host)
{
    if (atomic_fetch_add(&host->deferred, 1) == 0) host->watch(host->watcher);
}

void server_exchange_submit(struct server_exchange *exchange)
{
    struct server_host *host = exchange->host;
    server_exchange_count_deferred(host);
    exchange->job.tenant = exchange->tenant;
    if (exchange->join && exchange->join(exchange)) return;
    if (server_workers_submit(host->workers, &exchange->job)) return;
    server_reply_refusal(
        exchange, PROTO_PROBLEM_OVERLOADED,
        "all workers are busy, and as many requests wait as may (%llu, which tenants share); "
        "try again in a moment",
        (unsigned long long)host->queue_length);
    exchange_finish(exchange);
}

static bool on_progress(void *user, double fraction)
{
    struct server_monitor *monitor = user;
    struct server_exchange *exchange = monitor->exchange;
    const struct server_transport *transport = exchange->transport;
    double share = monitor->share > 0 ? monitor->share : 1;
    if (transport->report) transport->report(exchange, monitor->begun + share * fraction);
    if (!server_workers_go_on(exchange->host->workers)) return false;
    return !transport->is_gone(exchange) || (monitor->build && monitor->is_awaited(monitor->build));
}

struct gd_control server_exchange_control(struct server_monitor *monitor)
{
    return (struct gd_control){.deadline_ns = monitor->exchange->job.deadline_ns,
                               .progress = on_progress,
                               .user = monitor};
}
