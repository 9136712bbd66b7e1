#include "server/query/request.h"

#include <malloc.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "proto/queries/many.h"
#include "server/store/kind.h"
#include "server/surfaces/loader.h"
#include "server/exchange/events.h"
#include "server/exchange/reply.h"
#include "server/query/api.h"

#define KIND_SEGMENT   1                    /* index of the path's segment */
#define WAIT_MARGIN_NS UINT64_C(1000000000) /* time between the end of a wait and the deadline */
/* the budget does not count the document of a shorter text */
#define PARSED_UNCOUNTED ((size_t)16 << 10)
/* after a larger document, malloc_trim is called */
#define PARSED_TRIMMED ((size_t)16 << 20)

/* Returns the kind that the route's path "/v1/<plural>…" names, or NULL. */
static const struct server_kind *request_find_kind(const struct proto_route *route)
{
    const char *plural =
        route && route->segment_count > KIND_SEGMENT ? route->segments[KIND_SEGMENT] : NULL;
    return plural ? server_kind_by_plural(plural) : NULL;
}

const struct server_kind *server_request_kind(const struct server_exchange *exchange)
{
    const struct server_kind *kind = request_find_kind(exchange->match.route);
    return kind ? kind : &server_kind_mesh;
}

bool server_request_key(struct server_exchange *exchange, struct server_key *key)
{
    const struct proto_capture *capture = &exchange->match.captures[0];
    struct proto_problem problem;
    bool is_valid = proto_mesh_name_check(capture->text, capture->length, &problem);
    if (!server_reply_check(exchange, is_valid, &problem)) return false;
    memcpy(exchange->name, capture->text, capture->length);
    exchange->name[capture->length] = '\0';
    *key = (struct server_key){exchange->tenant, server_request_kind(exchange), exchange->name};
    return true;
}

bool server_request_is_plain(struct server_exchange *exchange)
{
    struct proto_problem problem;
    bool is_plain = proto_parameters_check(&exchange->parameters, NULL, &problem);
    return server_reply_check(exchange, is_plain, &problem);
}

bool server_request_wait(struct server_exchange *exchange, uint64_t *wait_s)
{
    struct proto_problem problem;
    return server_reply_check(
        exchange, proto_many_parse_wait(&exchange->parameters, wait_s, &problem), &problem);
}

uint64_t server_request_wait_end(const struct server_exchange *exchange, uint64_t wait_s)
{
    uint64_t until_ns = exchange->started_ns + wait_s * UINT64_C(1000000000);
    uint64_t last_ns = exchange->job.deadline_ns - WAIT_MARGIN_NS;
    return until_ns < last_ns ? until_ns : last_ns;
}

bool server_request_page(struct server_exchange *exchange, struct proto_page *page)
{
    struct proto_problem problem;
    return server_reply_check(exchange, proto_page_parse(&exchange->parameters, page, &problem),
                              &problem);
}

bool server_request_page_of_names(struct server_exchange *exchange, struct proto_page *page)
{
    struct proto_problem problem;
    return server_reply_check(
        exchange, proto_page_parse_names(&exchange->parameters, page, &problem), &problem);
}

static void reply_store_unavailable(struct server_exchange *exchange, const char *what)
{
    struct proto_problem problem;
    (void)proto_problem_set(&problem, PROTO_PROBLEM_STORE_UNAVAILABLE,
                            "the database does not answer, %s; try again in a moment", what);
    problem.retry_after = 1;
    server_reply_problem(exchange, &problem);
}

/* Replies not_found. The problem's text is the same for every name, so that it does not reveal
 * names of other tenants. */
static void reply_absent(struct server_exchange *exchange)
{
    const struct server_kind *kind = server_request_kind(exchange);
    struct server_registry *registry = exchange->host->api->registry;
    if (server_registry_is_shared(registry) && server_registry_health(registry)) {
        reply_store_unavailable(exchange, "and this daemon does not know the name");
        return;
    }
    server_reply_refusal(exchange, PROTO_PROBLEM_NOT_FOUND,
                         "there is no %s of this name; GET /v1/%s lists those that there are",
                         kind->noun, kind->plural);
}

bool server_request_record(struct server_exchange *exchange, struct server_listed *out)
{
    struct server_key key;
    if (!server_request_key(exchange, &key)) return false;
    if (server_registry_find(exchange->host->api->registry, &key, out)) return true;
    reply_absent(exchange);
    return false;
}

/* --- changes by other daemons ----------------------------------------------------------------- */

/* Runs on a worker. */
static bool registry_follow(struct server_exchange *exchange)
{
    struct server_registry *registry = exchange->host->api->registry;
    struct server_key key;
    struct server_listed listed;
    enum server_outcome outcome = server_registry_follow(registry, exchange->started_ns);
    if (outcome && exchange->match.capture_count > 0) {
        if (!server_request_key(exchange, &key)) return true;
        if (!server_registry_find(registry, &key, &listed)) {
            server_request_fail(exchange, outcome);
            return true;
        }
        server_listed_release(&listed);
    }
    exchange->match.route->handle(exchange);
    return true;
}

bool server_request_follows_first(struct server_exchange *exchange)
{
    struct server_registry *registry = exchange->host->api->registry;
    const struct server_kind *kind = request_find_kind(exchange->match.route);
    const struct proto_capture *capture = &exchange->match.captures[0];
    bool names_one = exchange->match.capture_count > 0;
    if (!server_registry_is_shared(registry) || !kind) return false;
    /* the name is invalid, which the handler reports */
    if (names_one && capture->length > PROTO_MESH_NAME) return false;
    if (names_one)
        snprintf(exchange->name, sizeof exchange->name, "%.*s", (int)capture->length,
                 capture->text);
    const struct server_key key = {exchange->tenant, kind, exchange->name};
    if (server_registry_is_fresh(registry, names_one ? &key : NULL)) return false;
    server_exchange_defer(exchange, registry_follow, NULL);
    return true;
}

/* --- a surface that is not in memory ---------------------------------------------------------- */

/* Runs on a worker: loads the surface and runs the handler. If the name has another record after
 * the load, looks up the name again without replying. Returns false if the exchange is parked; this
 * function is called again when the load has ended. */
static bool surface_bring(struct server_exchange *exchange)
{
    struct server_listed listed;
    struct server_surface *surface;
    struct proto_problem problem;
    enum server_loader_outcome outcome = SERVER_LOADER_LOADED;
    if (!server_request_record(exchange, &listed)) return true;
    if (listed.surface)
        surface = server_surface_retain(listed.surface);
    else
        outcome = server_loader_load(exchange->host->api->loader, listed.record, &exchange->job,
                                     &surface, &problem);
    server_listed_release(&listed);
    if (outcome == SERVER_LOADER_LOADED) {
        exchange->surface = surface;
        exchange->release_surface = server_surface_release;
        exchange->match.route->handle(exchange);
    } else if (outcome != SERVER_LOADER_WAITING && outcome != SERVER_LOADER_GONE) {
        server_reply_problem(exchange, &problem);
    }
    return outcome != SERVER_LOADER_WAITING;
}

static bool surface_join(struct server_exchange *exchange)
{
    struct server_listed listed;
    struct server_key key;
    if (!server_request_key(exchange, &key) ||
        !server_registry_find(exchange->host->api->registry, &key, &listed))
        return false;
    bool joined = !listed.surface &&
                  server_loader_join(exchange->host->api->loader, listed.record, &exchange->job);
    server_listed_release(&listed);
    return joined;
}

/* Finds the surface if it is in memory. Otherwise defers the exchange or replies with a problem. */
static void surface_find(struct server_exchange *exchange)
{
    struct server_key key;
    if (exchange->surface || !server_request_key(exchange, &key)) return;
    exchange->release_surface = server_surface_release;
    if (!server_registry_use(exchange->host->api->registry, &key, &exchange->surface))
        reply_absent(exchange);
    else if (!exchange->surface)
        server_exchange_defer(exchange, surface_bring, surface_join);
}

struct server_surface *server_request_surface(struct server_exchange *exchange)
{
    surface_find(exchange);
    struct server_surface *surface = exchange->surface;
    if (!surface || !server_exchange_is(exchange, "POST")) return surface;
    const struct server_precondition precondition = server_precondition_read(exchange);
    if (server_precondition_holds(&precondition, surface->record->etag)) return surface;
    server_request_fail(exchange, SERVER_STORE_PRECONDITION);
    return NULL;
}

void *server_request_allocate(struct server_exchange *exchange, size_t size,
                              void (*free_state)(void *state))
{
    void *state = calloc(1, size);
    if (state)
        server_exchange_keep(exchange, state, free_state);
    else
        server_request_fail(exchange, SERVER_STORE_NO_MEMORY);
    return state;
}

bool server_request_write(struct server_exchange *exchange,
                          bool (*work)(struct server_exchange *exchange))
{
    server_exchange_defer(exchange, work, NULL);
    (void)server_workers_submit(exchange->host->api->writer, &exchange->job); /* never full */
    return false;
}

static bool list_submit(struct server_exchange *exchange)
{
    (void)server_workers_submit(exchange->host->api->lister, &exchange->job); /* never full */
    return true;
}

void server_request_list(struct server_exchange *exchange,
                         bool (*work)(struct server_exchange *exchange))
{
    server_exchange_defer(exchange, work, list_submit);
}

/* --- bodies and failures ---------------------------------------------------------------------- */

bool server_request_is_json(const struct server_exchange *exchange)
{
    static const char json[] = "application/json";
    const char *type = server_exchange_header(exchange, "Content-Type");
    if (!type) return true;
    size_t size = strcspn(type, "; \t");
    return size == strlen(json) && strncasecmp(type, json, size) == 0;
}

bool server_request_take(struct server_exchange *exchange, const char *what, size_t bytes,
                         struct proto_problem *problem)
{
    struct server_budget *budget = exchange->host->budget;
    if (!server_budget_take(budget, SERVER_BUDGET_FLIGHT, bytes))
        return server_budget_refuse(budget, what, bytes, problem);
    exchange->held += bytes;
    return true;
}

bool server_request_check_file(enum gd_status status, struct proto_problem *problem)
{
    if (status == GD_EXTENT)
        return proto_problem_set(problem, PROTO_PROBLEM_NOT_ACCEPTABLE,
                                 "the mesh is too large or too small for this format, which stores "
                                 "floats; use another format");
    return !status || proto_problem_from_status(problem, status, NULL);
}

bool server_request_begin_parsing(struct server_exchange *exchange, const char *text, size_t size,
                                  struct proto_problem *problem)
{
    struct server_monitor monitor = {.exchange = exchange};
    const struct gd_control control = server_exchange_control(&monitor);
    size_t cost = size > PARSED_UNCOUNTED ? proto_decode_cost(text, size, &control) : 0;
    if (cost && !server_request_take(exchange, "the request's JSON", cost, problem)) return false;
    exchange->parsed = cost;
    return true;
}

/* Trims the heap after a large document, because the allocator does not return memory below the
 * last used block. */
void server_request_end_parsing(struct server_exchange *exchange)
{
    size_t parsed = exchange->parsed;
    server_budget_give(exchange->host->budget, SERVER_BUDGET_FLIGHT, parsed);
    exchange->held -= parsed;
    exchange->parsed = 0;
    if (parsed > PARSED_TRIMMED) malloc_trim(0);
}

json_t *server_request_document(struct server_exchange *exchange, struct proto_problem *problem)
{
    const struct server_body *body = &exchange->body;
    struct server_monitor monitor = {.exchange = exchange};
    const struct gd_control control = server_exchange_control(&monitor);
    if (!server_request_is_json(exchange)) {
        proto_problem_set(
            problem, PROTO_PROBLEM_UNSUPPORTED_MEDIA_TYPE,
            "a query is JSON: send it with the header Content-Type: application/json");
        return NULL;
    }
    if (!server_request_begin_parsing(exchange, body->bytes, body->size, problem)) return NULL;
    json_t *document = proto_decode_document_within(body->bytes, body->size, &control, problem);
    if (!document) server_request_end_parsing(exchange);
    return document;
}

struct server_exchange *server_request_stream(struct server_exchange *exchange,
                                              const struct server_transport *transport,
                                              const char *media_type, struct server_relay **relay)
{
    bool is_packed = server_reply_takes_gzip(exchange);
    struct server_relay *made = server_relay_create(exchange->host, exchange->share, is_packed);
    struct server_stream *stream = made ? server_relay_open(made) : NULL;
    struct server_exchange *rest = stream ? server_exchange_detach(exchange, transport) : NULL;
    if (!rest) {
        server_stream_close(stream);
        server_relay_release(made);
        return NULL;
    }
    rest->job.deadline_ns = exchange->job.deadline_ns;
    rest->work = exchange->work;
    server_reply_coding(exchange, is_packed);
    server_reply_stream(exchange, 200, media_type, stream);
    *relay = made;
    return rest;
}

void server_request_go_on(struct server_exchange *rest)
{
    server_exchange_count_deferred(rest->host);
    server_workers_resume(rest->host->workers, &rest->job);
}

void server_request_fail(struct server_exchange *exchange, enum server_outcome outcome)
{
    static const char *const sentences[] = {
        [SERVER_STORE_NO_MEMORY] = "there is no memory for this; delete meshes, raise "
                                   "--memory-budget, or try again later",
        [SERVER_STORE_FULL] = "the server's disk is full; nothing was changed: delete surfaces, or "
                              "try again when there is room",
        [SERVER_STORE_REFUSED] =
            "the server's system refuses to write; nothing was changed: tell its operator",
        [SERVER_STORE_READ_ONLY] =
            "the server's store accepts no changes, because a write failed; queries still "
            "work: tell its operator, /readyz says why",
    };
    if (outcome == SERVER_STORE_DAMAGED) outcome = SERVER_STORE_READ_ONLY;
    if (outcome == SERVER_STORE_ABSENT)
        reply_absent(exchange);
    else if (outcome == SERVER_STORE_PRECONDITION)
        server_reply_refusal(exchange, PROTO_PROBLEM_PRECONDITION_FAILED,
                             "the %s is not in the state that If-Match or If-None-Match asks for; "
                             "get its ETag and try again",
                             server_request_kind(exchange)->noun);
    else if (outcome == SERVER_STORE_STALE || outcome == SERVER_STORE_UNAVAILABLE)
        reply_store_unavailable(
            exchange, "and it is not known whether the change was made: repeating it does no "
                      "harm");
    else
        server_reply_refusal(exchange,
                             outcome == SERVER_STORE_NO_MEMORY ? PROTO_PROBLEM_INSUFFICIENT_MEMORY
                                                               : PROTO_PROBLEM_INSUFFICIENT_STORAGE,
                             "%s", sentences[outcome]);
}

bool server_request_check_stored(struct server_exchange *exchange, enum server_outcome outcome)
{
    bool is_stored = outcome == SERVER_STORE_CREATED || outcome == SERVER_STORE_REPLACED;
    if (!is_stored) server_request_fail(exchange, outcome);
    return is_stored;
}
