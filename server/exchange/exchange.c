#include "server/exchange/exchange.h"

#include <ctype.h>
#include <errno.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "server/base/thread.h"
#include "server/exchange/events.h"

#define TARGET_MOST 8192 /* bytes */
/* limit on the bytes of a request's head; the library needs the rest of its memory for answers */
#define HEAD_MOST 12288
#define BLANKS    " \t"

#define QUOTE_(number) #number
#define QUOTE(number)  QUOTE_(number)

/* --- the target ------------------------------------------------------------------------------- */

static int hex_digit(char c)
{
    return isdigit((unsigned char)c)    ? c - '0'
           : isxdigit((unsigned char)c) ? tolower((unsigned char)c) - 'a' + 10
                                        : -1;
}

/* Decodes %XX in place. Keeps plus signs, because numbers contain them ("1e+3"). Returns false for
 * a malformed escape or a NUL. */
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

/* Decodes the path. Returns NULL, or the reason why the path is malformed. Rejects an encoded
 * slash, because the decoded slash would split a segment. */
static const char *path_decode(char *path)
{
    if (strchr(path, '%') && strcasestr(path, "%2f"))
        return "a path segment of this API can't hold an encoded slash";
    if (!percent_decode(path)) return "the path has a broken percent escape";
    for (const char *c = path; *c; c++)
        if (iscntrl((unsigned char)*c)) return "the path holds a control character";
    return NULL;
}

static const char *query_split(struct server_exchange *exchange, char *query)
{
    bool has_escapes = strchr(query, '%');
    for (char *part = query, *rest; part; part = rest) {
        rest = strchr(part, '&');
        if (rest) *rest++ = '\0';
        if (!*part) continue;
        if (exchange->parameters.count == SERVER_EXCHANGE_PARAMETERS)
            return "the query string has too many parameters";
        char *equals = strchr(part, '=');
        if (equals) *equals = '\0';
        char *value = equals ? equals + 1 : part + strlen(part);
        if (has_escapes && (!percent_decode(part) || !percent_decode(value)))
            return "the query string has a broken percent escape";
        exchange->parameter_list[exchange->parameters.count++] =
            (struct proto_parameter){part, value};
    }
    return NULL;
}

/* Returns the path and the query of a target in place. Of a target in absolute form (RFC 9112,
 * 3.2.2), moves the authority to the beginning of the text and sets `*authority`; the scheme leaves
 * room for the terminator, and for the slash of an empty path. */
static char *target_split(char *target, const char **authority)
{
    size_t scheme = strncasecmp(target, "http://", 7) == 0    ? 7
                    : strncasecmp(target, "https://", 8) == 0 ? 8
                                                              : 0;
    size_t size = strcspn(target + scheme, "/?");
    *authority = NULL;
    if (!scheme) return target;
    char *path = target + scheme + size;
    memmove(target, target + scheme, size);
    target[size] = '\0';
    *authority = target;
    if (*path != '/') *--path = '/';
    return path;
}

/* --- the end ---------------------------------------------------------------------------------- */

void server_exchange_drop_state(struct server_exchange *exchange)
{
    if (exchange->free_state) exchange->free_state(exchange->state);
    if (exchange->surface) exchange->release_surface(exchange->surface);
    exchange->free_state = NULL;
    exchange->state = NULL;
    exchange->surface = NULL;
}

void server_exchange_drop_body(struct server_exchange *exchange)
{
    struct server_response *response = &exchange->response;
    server_stream_close(response->stream);
    free(response->owned);
    if (response->lent.bytes) response->lent.release(response->lent.lender);
    server_share_give_answer(exchange->share, response->held);
    response->stream = NULL;
    response->owned = NULL;
    response->body = NULL;
    response->lent = (struct server_lent){0};
    response->size = response->held = 0;
}

void server_exchange_end(struct server_exchange *exchange)
{
    server_exchange_drop_state(exchange);
    server_body_drop(&exchange->body);
    server_budget_give(exchange->host->budget, SERVER_BUDGET_FLIGHT, exchange->held);
    server_grant_end(&exchange->grant);
    server_exchange_drop_body(exchange);
    free(exchange->joined);
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

static bool on_progress(void *user, double fraction)
{
    struct server_monitor *monitor = user;
    struct server_exchange *exchange = monitor->exchange;
    const struct server_transport *transport = exchange->transport;
    double share = monitor->share > 0 ? monitor->share : 1;
    if (transport->report) transport->report(exchange, monitor->begun + share * fraction);
    if (!server_workers_go_on(exchange->host->workers)) return false;
    monitor->is_over_limit =
        monitor->cpu_limit_ns && server_thread_cpu_ns() > monitor->cpu_limit_ns;
    if (monitor->is_over_limit) return false;
    return !transport->is_gone(exchange) || (monitor->build && monitor->is_awaited(monitor->build));
}

struct gd_control server_exchange_control(struct server_monitor *monitor)
{
    uint64_t deadline_ns = monitor->exchange->job.deadline_ns;
    if (monitor->limit_ns && monitor->limit_ns < deadline_ns) deadline_ns = monitor->limit_ns;
    return (struct gd_control){
        .deadline_ns = deadline_ns, .progress = on_progress, .user = monitor};
}

/* --- life ------------------------------------------------------------------------------------- */

static void exchange_clear(struct server_exchange *exchange, struct server_host *host,
                           const struct server_transport *transport)
{
    memset(exchange, 0, offsetof(struct server_exchange, response.headers));
    exchange->host = host;
    exchange->transport = transport;
    exchange->tenant = "";
    exchange->share = &host->budget->common;
    exchange->parameters.all = exchange->parameter_list;
    exchange->started_ns = gd_now_ns();
    exchange->job.run = server_exchange_job_run;
    exchange->job.refuse = server_exchange_job_refuse;
}

bool server_exchange_begin(struct server_exchange *exchange, struct server_host *host,
                           const struct server_transport *transport, const char *target)
{
    exchange_clear(exchange, host, transport);
    exchange->target_size = strlen(target) + 1;
    exchange->target = malloc(exchange->target_size);
    if (!exchange->target) return false;
    memcpy(exchange->target, target, exchange->target_size);
    char *path = target_split(exchange->target, &exchange->authority), *query = strchr(path, '?');
    if (query) *query++ = '\0';
    exchange->path = path;
    exchange->fault = path_decode(path);
    if (!exchange->fault && query) exchange->fault = query_split(exchange, query);
    return true;
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

/* Copies the text to `*at` and advances `*at` past the copy. */
static char *text_copy(char **at, const char *text)
{
    size_t size = strlen(text) + 1;
    char *copy = memcpy(*at, text, size);
    *at += size;
    return copy;
}

static bool head_copy(struct server_exchange *to, const struct server_exchange *from)
{
    size_t size = strlen(from->method) + 1;
    for (uint32_t i = 0; i < from->header_count; i++)
        size += strlen(from->headers[i].name) + strlen(from->headers[i].value) + 2;
    char *at = to->copies = malloc(size);
    if (!at) return false;
    to->method = text_copy(&at, from->method);
    to->header_count = from->header_count;
    for (uint32_t i = 0; i < from->header_count; i++) {
        to->headers[i].name = text_copy(&at, from->headers[i].name);
        to->headers[i].value = text_copy(&at, from->headers[i].value);
    }
    return true;
}

/* Moves the target, and everything that points into it, to `to`. `from` keeps the copy `path`. */
static void target_pass(struct server_exchange *from, struct server_exchange *to, char *path)
{
    to->target = from->target;
    to->target_size = from->target_size;
    to->path = from->path;
    to->match = from->match;
    to->deprecation = from->deprecation;
    to->parameters.count = from->parameters.count;
    memcpy(to->parameter_list, from->parameter_list,
           from->parameters.count * sizeof *from->parameter_list);
    from->path = from->target = path;
    from->authority = NULL; /* the router has checked it */
    from->parameters.count = from->match.capture_count = 0;
}

struct server_exchange *server_exchange_detach(struct server_exchange *exchange,
                                               const struct server_transport *transport)
{
    struct server_exchange *detached = malloc(sizeof *detached);
    size_t bytes = sizeof *detached + exchange->target_size;
    if (!detached) return NULL;
    exchange_clear(detached, exchange->host, transport);
    if (server_budget_take(exchange->host->budget, SERVER_BUDGET_FLIGHT, bytes))
        detached->held = bytes;
    char *path = strdup(exchange->path);
    if (!detached->held || !path || !head_copy(detached, exchange)) {
        free(path);
        server_exchange_destroy(detached);
        return NULL;
    }
    target_pass(exchange, detached, path);
    detached->has_conditions = exchange->has_conditions;
    detached->is_http10 = exchange->is_http10;
    memcpy(detached->request_id, exchange->request_id, sizeof detached->request_id);
    server_grant_pass(&exchange->grant, &detached->grant);
    detached->tenant = detached->job.tenant = exchange->tenant;
    detached->share = exchange->share;
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
        exchange->fault = "the request has more than 64 headers; send fewer";
    else
        exchange->headers[exchange->header_count++] =
            (struct server_request_header){name, value ? value : ""};
    if (strncasecmp(name, "If-", 3) == 0) exchange->has_conditions = true;
}

/* Compares names, ignoring case. Compares the first letters first, because most names differ in
 * them. */
static inline bool name_equal(const char *a, const char *b)
{
    return ((*a ^ *b) & ~('a' ^ 'A')) == 0 && strcasecmp(a, b) == 0;
}

const char *server_exchange_host(const struct server_exchange *exchange)
{
    return exchange->authority ? exchange->authority : server_exchange_header(exchange, "Host");
}

const char *server_exchange_header(const struct server_exchange *exchange, const char *name)
{
    for (uint32_t i = 0; i < exchange->header_count; i++)
        if (name_equal(exchange->headers[i].name, name)) return exchange->headers[i].value;
    return NULL;
}

uint32_t server_exchange_count_headers(const struct server_exchange *exchange, const char *name)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < exchange->header_count; i++)
        count += name_equal(exchange->headers[i].name, name);
    return count;
}

void server_exchange_log(const struct server_exchange *exchange, struct server_log_line *line,
                         uint64_t nanoseconds)
{
    const struct server_response *response = &exchange->response;
    server_log_text(line, "method", exchange->method);
    server_log_text(line, "path", exchange->path);
    server_log_text(line, "route", exchange->match.route ? exchange->match.route->path : NULL);
    server_log_integer(line, "status", response->status);
    if (response->problem != PROTO_PROBLEM_NONE)
        server_log_text(line, "code", proto_problem_name(response->problem));
    server_log_text(line, "key", server_grant_name(&exchange->grant));
    server_log_integer(line, "bytes", (int64_t)response->size);
    server_log_milliseconds(line, "ms", nanoseconds);
    server_log_text(line, "request_id", exchange->request_id);
    server_log_text(line, "traceparent", server_exchange_header(exchange, "traceparent"));
}

bool server_exchange_is(const struct server_exchange *exchange, const char *method)
{
    return strcmp(exchange->method, method) == 0;
}

/* --- former names --------------------------------------------------------------------------- */

static bool parameter_rename(struct server_exchange *exchange,
                             const struct proto_deprecation *deprecation,
                             struct proto_problem *problem)
{
    const char *former = deprecation->name, *name = deprecation->replacement;
    struct proto_parameter *found = NULL;
    for (uint32_t i = 0; i < exchange->parameters.count; i++) {
        if (strcmp(exchange->parameter_list[i].name, former) != 0) continue;
        exchange->deprecation = deprecation;
        if (found)
            return proto_problem_refuse(problem, former,
                                        "the parameter \"%s\" stands more than once", former);
        found = &exchange->parameter_list[i];
    }
    if (found && proto_parameters_get(&exchange->parameters, name))
        return proto_problem_refuse(problem, former,
                                    "\"%s\" is the former name of \"%s\"; send only \"%s\"", former,
                                    name, name);
    if (found) found->name = name;
    return true;
}

bool server_exchange_rename(struct server_exchange *exchange, struct proto_problem *problem)
{
    const struct proto_route *route = exchange->match.route;
    const struct proto_deprecation *each = route->deprecated_parameters;
    exchange->deprecation = route->deprecation;
    for (; each && each->name && exchange->parameters.count; each++)
        if (!parameter_rename(exchange, each, problem)) return false;
    return true;
}

const char *server_exchange_sent_name(const struct server_exchange *exchange, const char *parameter)
{
    const struct proto_route *route = exchange->match.route;
    const struct proto_deprecation *each = route ? route->deprecated_parameters : NULL;
    for (; each && each->name && exchange->deprecation; each++)
        for (uint32_t i = 0; i < exchange->parameters.count; i++)
            /* comparing pointers suffices, because server_exchange_rename set this name */
            if (exchange->parameter_list[i].name == each->replacement &&
                strcmp(parameter, each->replacement) == 0)
                return each->name;
    return parameter;
}

/* --- preferences ------------------------------------------------------------------------------ */

/* Returns the end of the list element at `text`: the next comma outside quotes, or the end. */
static const char *element_end(const char *text)
{
    bool is_quoted = false;
    for (; *text && (is_quoted || *text != ','); text++) {
        if (*text == '"') is_quoted = !is_quoted;
        if (*text == '\\' && is_quoted && text[1]) text++;
    }
    return text;
}

/* Returns true if the element is this preference, with or without parameters. */
static bool element_is_preference(const char *element, const char *preference)
{
    size_t size = strlen(preference);
    element += strspn(element, BLANKS);
    if (strncasecmp(element, preference, size) != 0) return false;
    element += size + strspn(element + size, BLANKS);
    if (*element == '=') {
        element += 1 + strspn(element + 1, BLANKS);
        if (strncmp(element, "\"\"", 2) == 0) element += 2;
        element += strspn(element, BLANKS);
    }
    return *element == '\0' || *element == ',' || *element == ';';
}

bool server_exchange_prefers(const struct server_exchange *exchange, const char *preference)
{
    for (uint32_t i = 0; i < exchange->header_count; i++) {
        if (!name_equal(exchange->headers[i].name, "Prefer")) continue;
        for (const char *element = exchange->headers[i].value;; element++) {
            if (element_is_preference(element, preference)) return true;
            element = element_end(element);
            if (!*element) break;
        }
    }
    return false;
}

/* --- the head --------------------------------------------------------------------------------- */

static const bool is_token_byte[256] = {
    ['!'] = true,         ['#' ... '\''] = true, ['*' ... '+'] = true,
    ['-' ... '.'] = true, ['0' ... '9'] = true,  ['A' ... 'Z'] = true,
    ['^' ... 'z'] = true, ['|'] = true,          ['~'] = true,
};

/* Returns the size of the token at `text`; 0 means that there is no token. */
static size_t token_size(const char *text)
{
    size_t size = 0;
    while (is_token_byte[(unsigned char)text[size]]) size++;
    return text[size] ? 0 : size;
}

static bool byte_is_control(unsigned char byte)
{
    return (byte < ' ' && byte != '\t') || byte == 0x7f;
}

const char *server_exchange_check_target(const char *target)
{
    size_t size = 0;
    for (; target[size]; size++)
        if (target[size] <= ' ' || target[size] > '~' || target[size] == '#')
            return "the request target holds a byte that has to be percent-encoded";
    return size <= TARGET_MOST ? NULL
                               : "the request target has more than " QUOTE(
                                     TARGET_MOST) " bytes; send a POST with a body";
}

/* Checks the headers. `size` is the number of bytes of method and target. */
static const char *headers_check(const struct server_exchange *exchange, size_t size)
{
    for (uint32_t i = 0; i < exchange->header_count; i++) {
        const char *value = exchange->headers[i].value, *end = value;
        size_t name_size = token_size(exchange->headers[i].name);
        if (!name_size)
            return "a header name holds a character that is not allowed, or a blank before its "
                   "colon";
        while (*end && !byte_is_control((unsigned char)*end)) end++;
        if (*end) return "the value of a header holds a control character";
        size += name_size + (size_t)(end - value);
    }
    return size <= HEAD_MOST
               ? NULL
               : "the request line and the headers have more than " QUOTE(HEAD_MOST) " bytes";
}

/* Writes the values of all lines of a list at `*at`, with commas, as the value of its first line.
 * Advances `*at` past the text. */
static void list_join(struct server_exchange *exchange, const char *name, char **at)
{
    struct server_request_header *first = NULL;
    char *list = *at;
    for (uint32_t i = 0; i < exchange->header_count; i++) {
        struct server_request_header *line = &exchange->headers[i];
        if (!name_equal(line->name, name)) continue;
        if (first) *(*at)++ = ',';
        if (!first) first = line;
        *at = stpcpy(*at, line->value);
    }
    first->value = list;
    ++*at;
}

/* Joins the lines of lists (RFC 9110, 5.3). If memory is short, only the first line counts. */
static void lists_join(struct server_exchange *exchange)
{
    static const char *const names[] = {"Accept", "Accept-Encoding"};
    char *at = NULL;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (server_exchange_count_headers(exchange, names[i]) < 2) continue;
        if (!at) at = exchange->joined = malloc(HEAD_MOST); /* names need more than commas */
        if (at) list_join(exchange, names[i], &at);
    }
}

static bool length_read(const char *text, uint64_t *out)
{
    size_t digits = strspn(text, "0123456789");
    if (digits == 0 || text[digits]) return false;
    errno = 0;
    *out = strtoull(text, NULL, 10);
    return errno == 0 && *out != SERVER_BODY_CHUNKED;
}

/* Reads the framing of the body. Refuses two Content-Length headers even if they are equal, because
 * HTTP implementations treat them differently. */
static const char *framing_read(struct server_exchange *exchange)
{
    uint32_t lengths = server_exchange_count_headers(exchange, "Content-Length");
    uint32_t hosts = server_exchange_count_headers(exchange, "Host");
    uint32_t codings = server_exchange_count_headers(exchange, "Transfer-Encoding");
    exchange->has_body = lengths || codings;
    if (hosts > 1) return "Host stands twice; send it once";
    if (hosts == 0 && !exchange->is_http10) return "Host is missing; send it once";
    if (lengths && codings) return "send Content-Length or Transfer-Encoding, not both";
    if (lengths > 1) return "Content-Length stands twice; send it once";
    if (codings > 1) return "Transfer-Encoding stands twice; send it once";
    if (codings) exchange->body.declared = SERVER_BODY_CHUNKED;
    if (codings && (exchange->is_http10 ||
                    strcasecmp(server_exchange_header(exchange, "Transfer-Encoding"), "chunked")))
        return "the only Transfer-Encoding is chunked, from HTTP/1.1 on";
    if (lengths &&
        !length_read(server_exchange_header(exchange, "Content-Length"), &exchange->body.declared))
        return "Content-Length is not a decimal number of bytes";
    return NULL;
}

const char *server_exchange_read_head(struct server_exchange *exchange, const char *version)
{
    size_t method_size = token_size(exchange->method);
    exchange->is_http10 = strcmp(version, "HTTP/1.0") == 0;
    if (!method_size) return "the method holds a character that is not allowed";
    if (!exchange->is_http10 && strcmp(version, "HTTP/1.1") != 0)
        return "the version is neither HTTP/1.1 nor HTTP/1.0";
    const char *fault = headers_check(exchange, method_size + exchange->target_size);
    if (fault) return fault;
    lists_join(exchange);
    return framing_read(exchange);
}
