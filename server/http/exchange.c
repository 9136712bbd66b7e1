/* See exchange.h. */
#include "server/http/exchange.h"

#include <ctype.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "server/http/events.h"
#include "server/http/reply.h"

/* --- the target ------------------------------------------------------------------------------- */

static int hex_digit(char c)
{
    return isdigit((unsigned char)c)    ? c - '0'
           : isxdigit((unsigned char)c) ? tolower((unsigned char)c) - 'a' + 10
                                        : -1;
}

/* Decodes %XX in place. A plus sign stands for itself: numbers have exponents. False at a broken
 * escape or an encoded NUL. */
static bool percent_decode(char *text)
{
    char *out = strchr(text, '%');
    if (!out) return true;
    for (const char *in = out; *in; in++) {
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
    if (strchr(path, '%') && strcasestr(path, "%2f"))
        return "a path segment of this API can't hold an encoded slash";
    if (!percent_decode(path)) return "the path has a broken percent escape";
    for (const char *c = path; *c; c++)
        if (iscntrl((unsigned char)*c)) return "the path holds a control character";
    return NULL;
}

static const char *split_query(struct server_exchange *exchange, char *query)
{
    bool has_escapes = strchr(query, '%');
    for (char *part = query, *rest; part; part = rest) {
        rest = strchr(part, '&');
        if (rest) *rest++ = '\0';
        if (!*part) continue;
        if (exchange->parameter_count == SERVER_EXCHANGE_PARAMETERS)
            return "the query string has too many parameters";
        char *equals = strchr(part, '=');
        if (equals) *equals = '\0';
        char *value = equals ? equals + 1 : part + strlen(part);
        if (has_escapes && (!percent_decode(part) || !percent_decode(value)))
            return "the query string has a broken percent escape";
        exchange->parameters[exchange->parameter_count++] =
            (struct server_named_value){part, value};
    }
    return NULL;
}

/* Takes the target apart, in a copy. */
static bool read_target(struct server_exchange *exchange, const char *target)
{
    exchange->target_size = strlen(target) + 1;
    exchange->target = malloc(exchange->target_size);
    if (!exchange->target) return false;
    memcpy(exchange->target, target, exchange->target_size);
    char *path = exchange->target, *query = strchr(path, '?');
    if (query) *query++ = '\0';
    exchange->path = path;
    exchange->fault = decode_path(path);
    if (!exchange->fault && query) exchange->fault = split_query(exchange, query);
    return true;
}

/* --- life ------------------------------------------------------------------------------------- */

static void run(struct server_job *job);
static void refuse(struct server_job *job, enum server_refusal why);

static void clear(struct server_exchange *exchange, struct server_host *host,
                  const struct server_transport *transport)
{
    memset(exchange, 0, offsetof(struct server_exchange, response.headers));
    exchange->host = host;
    exchange->transport = transport;
    exchange->tenant = "";
    exchange->started_ns = gd_now_ns();
    exchange->job.run = run;
    exchange->job.refuse = refuse;
}

bool server_exchange_begin(struct server_exchange *exchange, struct server_host *host,
                           const struct server_transport *transport, const char *target)
{
    clear(exchange, host, transport);
    return read_target(exchange, target);
}

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
    server_stream_close(exchange->response.stream);
    server_grant_end(&exchange->grant);
    server_reply_drop_body(exchange);
    free(exchange->copies);
    free(exchange->target);
}

struct server_exchange *server_exchange_create(struct server_host *host,
                                               const struct server_transport *transport,
                                               const char *target)
{
    struct server_exchange *exchange = malloc(sizeof *exchange);
    if (exchange && server_exchange_begin(exchange, host, transport, target)) return exchange;
    free(exchange);
    return NULL;
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

/* --- another transport ------------------------------------------------------------------------ */

/* Copies the text to `*at`, which is behind the copy then. */
static char *copy_text(char **at, const char *text)
{
    size_t size = strlen(text) + 1;
    char *copy = memcpy(*at, text, size);
    *at += size;
    return copy;
}

static bool copy_head(struct server_exchange *to, const struct server_exchange *from)
{
    size_t size = strlen(from->method) + 1;
    for (uint32_t i = 0; i < from->header_count; i++)
        size += strlen(from->headers[i].name) + strlen(from->headers[i].value) + 2;
    char *at = to->copies = malloc(size);
    if (!at) return false;
    to->method = copy_text(&at, from->method);
    for (uint32_t i = 0; i < from->header_count; i++) {
        const struct server_named_value *header = &from->headers[i];
        to->headers[i] = (struct server_named_value){copy_text(&at, header->name), NULL};
        to->headers[i].value = copy_text(&at, header->value);
    }
    to->header_count = from->header_count;
    to->has_conditions = from->has_conditions;
    return true;
}

/* What stands at that place of the other's target. */
static const char *find_again(const struct server_exchange *to, const struct server_exchange *from,
                              const char *text)
{
    return to->target + (text - from->target);
}

static bool copy_target(struct server_exchange *to, const struct server_exchange *from)
{
    to->target = malloc(from->target_size);
    if (!to->target) return false;
    memcpy(to->target, from->target, from->target_size);
    to->target_size = from->target_size;
    to->path = find_again(to, from, from->path);
    to->match = from->match;
    for (uint32_t i = 0; i < to->match.capture_count; i++)
        to->match.captures[i].text = find_again(to, from, from->match.captures[i].text);
    to->parameter_count = from->parameter_count;
    for (uint32_t i = 0; i < to->parameter_count; i++)
        to->parameters[i] =
            (struct server_named_value){find_again(to, from, from->parameters[i].name),
                                        find_again(to, from, from->parameters[i].value)};
    return true;
}

static struct server_exchange *create_detached(struct server_exchange *exchange,
                                               const struct server_transport *transport)
{
    struct server_exchange *detached = malloc(sizeof *detached);
    if (!detached) return NULL;
    clear(detached, exchange->host, transport);
    size_t bytes = sizeof *detached + exchange->target_size;
    if (server_budget_take(exchange->host->budget, SERVER_BUDGET_FLIGHT, bytes))
        detached->held = bytes;
    if (detached->held && copy_target(detached, exchange) && copy_head(detached, exchange))
        return detached;
    server_exchange_destroy(detached);
    return NULL;
}

struct server_exchange *server_exchange_detach(struct server_exchange *exchange,
                                               const struct server_transport *transport)
{
    struct server_exchange *detached = create_detached(exchange, transport);
    if (!detached) return NULL;
    detached->is_http10 = exchange->is_http10;
    memcpy(detached->request_id, exchange->request_id, sizeof detached->request_id);
    server_grant_pass(&exchange->grant, &detached->grant);
    detached->tenant = detached->job.tenant = exchange->tenant;
    detached->body = exchange->body;
    exchange->body = (struct server_body){0};
    return detached;
}

void server_exchange_run(struct server_exchange *exchange)
{
    exchange->host->dispatch(exchange);
    if (exchange->response.status)
        exchange->transport->finish(exchange);
    else
        server_exchange_submit(exchange);
}

bool server_exchange_is_unwanted(struct server_exchange *exchange)
{
    return atomic_load_explicit(&exchange->job.is_unwanted, memory_order_relaxed);
}

/* --- the request ------------------------------------------------------------------------------ */

void server_exchange_add_header(struct server_exchange *exchange, const char *name,
                                const char *value)
{
    if (exchange->header_count == SERVER_EXCHANGE_HEADERS)
        exchange->fault = "the request has more than 64 headers";
    else
        exchange->headers[exchange->header_count++] =
            (struct server_named_value){name, value ? value : ""};
    if (strncasecmp(name, "If-", 3) == 0) exchange->has_conditions = true;
}

/* The same name, whatever the case; most differ in the first letter. */
static inline bool is_name(const char *a, const char *b)
{
    return ((*a ^ *b) & ~('a' ^ 'A')) == 0 && strcasecmp(a, b) == 0;
}

const char *server_exchange_header(const struct server_exchange *exchange, const char *name)
{
    for (uint32_t i = 0; i < exchange->header_count; i++)
        if (is_name(exchange->headers[i].name, name)) return exchange->headers[i].value;
    return NULL;
}

uint32_t server_exchange_count_headers(const struct server_exchange *exchange, const char *name)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < exchange->header_count; i++)
        count += is_name(exchange->headers[i].name, name);
    return count;
}

const char *server_exchange_code(const struct server_exchange *exchange)
{
    enum proto_problem_code code = exchange->response.problem;
    return code == PROTO_PROBLEM_NONE ? NULL : proto_problem_name(code);
}

bool server_exchange_is(const struct server_exchange *exchange, const char *method)
{
    return strcmp(exchange->method, method) == 0;
}

static const char *parameter_get(void *user, const char *name)
{
    const struct server_exchange *exchange = user;
    for (uint32_t i = 0; i < exchange->parameter_count; i++) {
        const struct server_named_value *parameter = &exchange->parameters[i];
        if (*parameter->name == *name && strcmp(parameter->name, name) == 0)
            return parameter->value;
    }
    return NULL;
}

static void parameter_each(void *user, bool (*visit)(void *context, const char *name),
                           void *context)
{
    const struct server_exchange *exchange = user;
    for (uint32_t i = 0; i < exchange->parameter_count; i++)
        if (!visit(context, exchange->parameters[i].name)) return;
}

struct proto_parameters server_exchange_parameters(struct server_exchange *exchange)
{
    return (struct proto_parameters){
        .get = parameter_get, .each = parameter_each, .user = exchange};
}

/* --- the second lane -------------------------------------------------------------------------- */

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

static void finish(struct server_exchange *exchange)
{
    struct server_host *host = exchange->host;
    drop_state(exchange); /* now: others may wait for what it holds */
    exchange->transport->finish(exchange);
    atomic_fetch_sub(&host->deferred, 1);
}

static void run(struct server_job *job)
{
    struct server_exchange *exchange = server_exchange_of(job);
    if (exchange->transport->begin) exchange->transport->begin(exchange);
    do {
        if (!exchange->work(exchange)) return; /* parked: it may be another thread's by now */
    } while (!exchange->response.status);
    finish(exchange);
}

/* A job that is not wanted is late. */
static void refuse(struct server_job *job, enum server_refusal why)
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
    finish(exchange);
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
    finish(exchange);
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
