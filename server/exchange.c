/* See exchange.h. */
#include "server/exchange.h"

#include <ctype.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "server/cache.h"
#include "server/reply.h"
#include "server/server.h"

#define GONE_INTERVAL_NS UINT64_C(20000000) /* between two looks at the client's socket */

/* --- the target --------------------------------------------------------------------------------------------------- */

static int hex_digit(char c)
{
    return isdigit((unsigned char)c) ? c - '0' : isxdigit((unsigned char)c) ? tolower((unsigned char)c) - 'a' + 10 : -1;
}

/* Decodes %XX in place. A plus sign stands for itself: numbers have exponents. False at a broken escape or an
 * encoded NUL. */
static bool percent_decode(char *text)
{
    char *out = text;
    for (const char *in = text; *in; in++) {
        if (*in != '%') {
            *out++ = *in;
            continue;
        }
        int high = hex_digit(in[1]), low = high < 0 ? -1 : hex_digit(in[2]);
        if (low < 0 || high + low == 0) return false;
        *out++ = (char)(high << 4 | low);
        in += 2;
    }
    *out = '\0';
    return true;
}

/* An encoded slash would make two segments of one, a control character has no place in any name. */
static const char *decode_path(char *path)
{
    if (strcasestr(path, "%2f")) return "a path segment of this API can't hold an encoded slash";
    if (!percent_decode(path)) return "the path has a broken percent escape";
    for (const char *c = path; *c; c++)
        if (iscntrl((unsigned char)*c)) return "the path holds a control character";
    return NULL;
}

static const char *split_query(struct server_exchange *exchange)
{
    char *rest = exchange->query;
    for (char *part; (part = strsep(&rest, "&"));) {
        if (!*part) continue;
        if (exchange->parameter_count == SERVER_EXCHANGE_PARAMETERS) return "the query string has too many parameters";
        char *equals = strchr(part, '=');
        if (equals) *equals = '\0';
        char *value = equals ? equals + 1 : part + strlen(part);
        if (!percent_decode(part) || !percent_decode(value)) return "the query string has a broken percent escape";
        exchange->parameters[exchange->parameter_count++] = (struct server_named_value){part, value};
    }
    return NULL;
}

static bool read_target(struct server_exchange *exchange, const char *target)
{
    size_t path_size = strcspn(target, "?");
    exchange->path = strndup(target, path_size);
    exchange->query = strdup(target[path_size] ? target + path_size + 1 : "");
    if (!exchange->path || !exchange->query) return false;
    exchange->fault = decode_path(exchange->path);
    if (!exchange->fault) exchange->fault = split_query(exchange);
    return true;
}

/* --- life --------------------------------------------------------------------------------------------------------- */

static void run(struct server_job *job);
static void refuse(struct server_job *job, enum server_refusal why);

struct server_exchange *server_exchange_create(struct server *server, const struct server_transport *transport,
                                               const char *target)
{
    struct server_exchange *exchange = calloc(1, sizeof *exchange);
    if (!exchange) return NULL;
    exchange->server = server;
    exchange->transport = transport;
    exchange->started_ns = gd_now_ns();
    exchange->job.run = run;
    exchange->job.refuse = refuse;
    if (read_target(exchange, target)) return exchange;
    server_exchange_destroy(exchange);
    return NULL;
}

static void drop_state(struct server_exchange *exchange)
{
    if (exchange->free_state) exchange->free_state(exchange->state);
    exchange->free_state = NULL;
    exchange->state = NULL;
}

void server_exchange_destroy(struct server_exchange *exchange)
{
    if (!exchange) return;
    drop_state(exchange);
    server_surface_release(exchange->surface);
    server_body_drop(&exchange->body, &exchange->server->budget);
    server_budget_give(&exchange->server->budget, SERVER_BUDGET_FLIGHT, exchange->held);
    free(exchange->response.owned);
    free(exchange->path);
    free(exchange->query);
    free(exchange);
}

void server_exchange_keep(struct server_exchange *exchange, void *state, void (*free_state)(void *state))
{
    exchange->state = state;
    exchange->free_state = free_state;
}

/* --- the request -------------------------------------------------------------------------------------------------- */

void server_exchange_add_header(struct server_exchange *exchange, const char *name, const char *value)
{
    if (exchange->header_count == SERVER_EXCHANGE_HEADERS)
        exchange->fault = "the request has too many headers";
    else
        exchange->headers[exchange->header_count++] = (struct server_named_value){name, value ? value : ""};
}

const char *server_exchange_header(const struct server_exchange *exchange, const char *name)
{
    for (uint32_t i = 0; i < exchange->header_count; i++)
        if (strcasecmp(exchange->headers[i].name, name) == 0) return exchange->headers[i].value;
    return NULL;
}

uint32_t server_exchange_count_headers(const struct server_exchange *exchange, const char *name)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < exchange->header_count; i++) count += strcasecmp(exchange->headers[i].name, name) == 0;
    return count;
}

bool server_exchange_is(const struct server_exchange *exchange, const char *method)
{
    return strcmp(exchange->method, method) == 0;
}

static const char *parameter_get(void *user, const char *name)
{
    const struct server_exchange *exchange = user;
    for (uint32_t i = 0; i < exchange->parameter_count; i++)
        if (strcmp(exchange->parameters[i].name, name) == 0) return exchange->parameters[i].value;
    return NULL;
}

static void parameter_each(void *user, bool (*visit)(void *context, const char *name), void *context)
{
    const struct server_exchange *exchange = user;
    for (uint32_t i = 0; i < exchange->parameter_count; i++)
        if (!visit(context, exchange->parameters[i].name)) return;
}

struct proto_parameters server_exchange_parameters(struct server_exchange *exchange)
{
    return (struct proto_parameters){.get = parameter_get, .each = parameter_each, .user = exchange};
}

/* --- the second lane ---------------------------------------------------------------------------------------------- */

static struct server_exchange *exchange_of(struct server_job *job)
{
    return (struct server_exchange *)((char *)job - offsetof(struct server_exchange, job));
}

void server_exchange_shorten(struct server_exchange *exchange, uint64_t timeout_ms)
{
    uint64_t limit_ms = exchange->server->config.timeout_ms;
    if (!timeout_ms || timeout_ms >= limit_ms) return;
    exchange->job.deadline_ns -= (limit_ms - timeout_ms) * 1000000;
}

void server_exchange_defer(struct server_exchange *exchange, bool (*work)(struct server_exchange *exchange),
                           bool (*join)(struct server_exchange *exchange))
{
    exchange->work = work;
    exchange->join = join;
}

static void finish(struct server_exchange *exchange)
{
    struct server *server = exchange->server;
    server_reply_seal(exchange);
    drop_state(exchange); /* now: others may wait for what it holds */
    exchange->transport->finish(exchange);
    atomic_fetch_sub(&server->deferred, 1);
}

static void run(struct server_job *job)
{
    struct server_exchange *exchange = exchange_of(job);
    do {
        if (!exchange->work(exchange)) return; /* parked: it may be another thread's by now */
    } while (!exchange->response.status);
    finish(exchange);
}

static void refuse(struct server_job *job, enum server_refusal why)
{
    struct server_exchange *exchange = exchange_of(job);
    struct proto_problem problem;
    switch (why) {
    case SERVER_REFUSAL_DEADLINE:
        (void)proto_problem_from_status(&problem, GD_DEADLINE, NULL);
        break;
    case SERVER_REFUSAL_DRAINING:
        (void)proto_problem_from_status(&problem, GD_CANCELLED, NULL);
        break;
    case SERVER_REFUSAL_MEMORY:
        (void)server_budget_refuse(&exchange->server->budget, "the mesh", 0, &problem);
        break;
    }
    server_reply_problem(exchange, &problem);
    finish(exchange);
}

void server_exchange_submit(struct server_exchange *exchange)
{
    struct server *server = exchange->server;
    server_deferred_begin(server);
    if (exchange->join && exchange->join(exchange)) return;
    if (server_workers_submit(server->workers, &exchange->job)) return;
    server_reply_refusal(exchange, PROTO_PROBLEM_OVERLOADED,
                         "all workers are busy and %llu requests wait already; try again in a moment",
                         (unsigned long long)server->config.queue_length);
    finish(exchange);
}

static bool on_progress(void *user, double fraction)
{
    struct server_monitor *monitor = user;
    struct server_exchange *exchange = monitor->exchange;
    (void)fraction;
    if (server_workers_cancelled(exchange->server->workers)) return false;
    uint64_t now = gd_now_ns();
    if (now - monitor->looked_ns < GONE_INTERVAL_NS) return true;
    monitor->looked_ns = now;
    monitor->is_gone =
        exchange->transport->is_gone(exchange) && !(monitor->flight && server_cache_is_awaited(monitor->flight));
    return !monitor->is_gone;
}

struct gd_control server_exchange_control(struct server_monitor *monitor)
{
    monitor->looked_ns = gd_now_ns();
    return (struct gd_control){
        .deadline_ns = monitor->exchange->job.deadline_ns, .progress = on_progress, .user = monitor};
}
