/* See exchange.h. */
#include "server/exchange/exchange.h"

#include <ctype.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

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

static void exchange_clear(struct server_exchange *exchange, struct server_host *host,
                           const struct server_transport *transport)
{
    memset(exchange, 0, offsetof(struct server_exchange, response.headers));
    exchange->host = host;
    exchange->transport = transport;
    exchange->tenant = "";
    exchange->started_ns = gd_now_ns();
    exchange->job.run = server_exchange_job_run;
    exchange->job.refuse = server_exchange_job_refuse;
}

bool server_exchange_begin(struct server_exchange *exchange, struct server_host *host,
                           const struct server_transport *transport, const char *target)
{
    exchange_clear(exchange, host, transport);
    return read_target(exchange, target);
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
    exchange_clear(detached, exchange->host, transport);
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
