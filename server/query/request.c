/* See request.h. */
#include "server/query/request.h"

#include <malloc.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "server/store/kind.h"
#include "server/surfaces/loader.h"
#include "server/http/reply.h"
#include "server/query/api.h"

#define KIND_SEGMENT     1                    /* of the path */
#define PARSED_UNCOUNTED SERVER_REQUEST_SMALL /* bytes of a text whose document is not counted */
/* bytes of a document after which freed memory is given back to the system */
#define PARSED_TRIMMED ((size_t)16 << 20)

const struct server_kind *server_request_kind(const struct server_exchange *exchange)
{
    const struct proto_route *route = exchange->match.route;
    const char *plural =
        route && route->segment_count > KIND_SEGMENT ? route->segments[KIND_SEGMENT] : NULL;
    const struct server_kind *kind = plural ? server_kind_by_plural(plural) : NULL;
    return kind ? kind : &server_kind_mesh;
}

bool server_request_key(struct server_exchange *exchange, char name[PROTO_MESH_NAME + 1],
                        struct server_key *key)
{
    const struct proto_capture *capture = &exchange->match.captures[0];
    struct proto_problem problem;
    if (!proto_mesh_name_check(capture->text, capture->length, &problem)) {
        server_reply_problem(exchange, &problem);
        return false;
    }
    memcpy(name, capture->text, capture->length);
    name[capture->length] = '\0';
    *key = (struct server_key){exchange->tenant, server_request_kind(exchange), name};
    return true;
}

bool server_request_is_plain(struct server_exchange *exchange)
{
    struct proto_parameters parameters = server_exchange_parameters(exchange);
    struct proto_problem problem;
    if (proto_parameters_check(&parameters, NULL, &problem)) return true;
    server_reply_problem(exchange, &problem);
    return false;
}

bool server_request_page(struct server_exchange *exchange, struct proto_page *page)
{
    struct proto_parameters parameters = server_exchange_parameters(exchange);
    struct proto_problem problem;
    if (proto_page_parse(&parameters, page, &problem)) return true;
    server_reply_problem(exchange, &problem);
    return false;
}

static void reply_out_of_reach(struct server_exchange *exchange, const char *what)
{
    struct proto_problem problem;
    (void)proto_problem_set(&problem, PROTO_PROBLEM_STORE_UNAVAILABLE,
                            "the database does not answer, %s; try again in a moment", what);
    problem.retry_after = 1;
    server_reply_problem(exchange, &problem);
}

/* Is it not known for now what other daemons have? */
static bool is_cut_off(const struct server_exchange *exchange)
{
    struct server_registry *registry = exchange->host->api->registry;
    return server_registry_is_shared(registry) && server_registry_health(registry);
}

/* The same for every name, so that it tells nothing of names that exist for others. */
static void reply_absent(struct server_exchange *exchange)
{
    const struct server_kind *kind = server_request_kind(exchange);
    if (is_cut_off(exchange)) {
        reply_out_of_reach(exchange, "and this daemon does not know the name");
        return;
    }
    server_reply_refusal(exchange, PROTO_PROBLEM_NOT_FOUND,
                         "there is no %s of this name; GET /v1/%s lists those that there are",
                         kind->noun, kind->plural);
}

bool server_request_record(struct server_exchange *exchange, struct server_listed *out)
{
    char name[PROTO_MESH_NAME + 1];
    struct server_key key;
    if (!server_request_key(exchange, name, &key)) return false;
    if (server_registry_find(exchange->host->api->registry, &key, out)) return true;
    reply_absent(exchange);
    return false;
}

/* --- what other daemons have changed ---------------------------------------------------------- */

/* By a worker. */
static bool follow(struct server_exchange *exchange)
{
    struct server_registry *registry = exchange->host->api->registry;
    char name[PROTO_MESH_NAME + 1];
    struct server_key key;
    struct server_listed listed;
    bool names_one = exchange->match.capture_count > 0;
    enum server_store_outcome outcome = server_registry_follow(registry, exchange->started_ns);
    if (outcome && names_one) {
        if (!server_request_key(exchange, name, &key)) return true;
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
    const struct proto_route *route = exchange->match.route;
    const struct proto_capture *capture = &exchange->match.captures[0];
    char name[PROTO_MESH_NAME + 1];
    if (!server_registry_is_shared(exchange->host->api->registry) ||
        route->segment_count <= KIND_SEGMENT)
        return false;
    if (!route->segments[KIND_SEGMENT] || !server_kind_by_plural(route->segments[KIND_SEGMENT]))
        return false;
    bool names_one = exchange->match.capture_count > 0;
    /* no name: the handler says so */
    if (names_one && capture->length > PROTO_MESH_NAME) return false;
    if (names_one) snprintf(name, sizeof name, "%.*s", (int)capture->length, capture->text);
    const struct server_key key = {exchange->tenant, server_request_kind(exchange), name};
    if (server_registry_is_fresh(exchange->host->api->registry, names_one ? &key : NULL))
        return false;
    server_exchange_defer(exchange, follow, NULL);
    return true;
}

/* --- a surface that is not in memory ---------------------------------------------------------- */

static void rerun(struct server_exchange *exchange, struct server_surface *surface)
{
    exchange->surface = surface;
    exchange->release_surface = server_surface_release;
    exchange->match.route->handle(exchange);
}

/* Loads the record and replies; there is no reply if the name is another mesh by now: then the
 * dispatcher looks it up again. False: parked. */
static bool load_record(struct server_exchange *exchange, struct server_record *record)
{
    struct server_surface *surface;
    struct proto_problem problem;
    switch (server_loader_load(exchange->host->api->loader, record, &exchange->job, &surface,
                               &problem)) {
    case SERVER_LOADER_LOADED:
        rerun(exchange, surface);
        return true;
    case SERVER_LOADER_WAITING:
        return false;
    case SERVER_LOADER_GONE:
        return true;
    default:
        server_reply_problem(exchange, &problem);
        return true;
    }
}

/* False: parked, then this is called again. */
static bool bring(struct server_exchange *exchange)
{
    struct server_listed listed;
    bool is_done = true;
    if (!server_request_record(exchange, &listed)) return true;
    if (listed.surface)
        rerun(exchange, server_surface_retain(listed.surface));
    else
        is_done = load_record(exchange, listed.record);
    server_listed_release(&listed);
    return is_done;
}

static bool join(struct server_exchange *exchange)
{
    struct server_listed listed;
    char name[PROTO_MESH_NAME + 1];
    struct server_key key;
    if (!server_request_key(exchange, name, &key) ||
        !server_registry_find(exchange->host->api->registry, &key, &listed))
        return false;
    bool joined = !listed.surface &&
                  server_loader_join(exchange->host->api->loader, listed.record, &exchange->job);
    server_listed_release(&listed);
    return joined;
}

/* The surface in memory, or NULL with the exchange deferred or a problem replied. */
static struct server_surface *find_surface(struct server_exchange *exchange)
{
    char name[PROTO_MESH_NAME + 1];
    struct server_key key;
    struct server_surface *surface;
    if (exchange->surface) return server_surface_retain(exchange->surface);
    if (!server_request_key(exchange, name, &key)) return NULL;
    if (!server_registry_use(exchange->host->api->registry, &key, &surface)) {
        reply_absent(exchange);
        return NULL;
    }
    if (!surface) server_exchange_defer(exchange, bring, join);
    return surface;
}

struct server_surface *server_request_surface(struct server_exchange *exchange)
{
    struct server_surface *surface = find_surface(exchange);
    if (!surface || !server_exchange_is(exchange, "POST")) return surface;
    const struct server_precondition precondition = server_precondition_read(exchange);
    if (server_precondition_holds(&precondition, surface->record->etag)) return surface;
    server_request_fail(exchange, SERVER_STORE_PRECONDITION);
    server_surface_release(surface);
    return NULL;
}

bool server_request_write(struct server_exchange *exchange,
                          bool (*work)(struct server_exchange *exchange))
{
    server_exchange_defer(exchange, work, NULL);
    server_registry_submit(exchange->host->api->registry, &exchange->job);
    return false;
}

static bool submit_list(struct server_exchange *exchange)
{
    server_registry_submit_list(exchange->host->api->registry, &exchange->job);
    return true;
}

void server_request_list(struct server_exchange *exchange,
                         bool (*work)(struct server_exchange *exchange))
{
    server_exchange_defer(exchange, work, submit_list);
}

/* --- bodies and failures ---------------------------------------------------------------------- */

static bool is_json(const char *content_type)
{
    static const char json[] = "application/json";
    if (!content_type) return true;
    size_t size = strcspn(content_type, "; \t");
    return size == strlen(json) && strncasecmp(content_type, json, size) == 0;
}

bool server_request_begin_parsing(struct server_exchange *exchange, const char *text, size_t size,
                                  struct proto_problem *problem)
{
    struct server_budget *budget = exchange->host->budget;
    struct server_monitor monitor = {.exchange = exchange};
    const struct gd_control control = server_exchange_control(&monitor);
    size_t cost = size > PARSED_UNCOUNTED ? proto_decode_cost(text, size, &control) : 0;
    if (cost && !server_budget_take(budget, SERVER_BUDGET_FLIGHT, cost))
        return server_budget_refuse(budget, "the request's JSON", cost, problem);
    exchange->parsed = cost;
    exchange->held += cost;
    return true;
}

/* Of many small blocks the allocator keeps what lies before the last one that is still in use. */
void server_request_end_parsing(struct server_exchange *exchange)
{
    size_t parsed = exchange->parsed;
    server_budget_give(exchange->host->budget, SERVER_BUDGET_FLIGHT, parsed);
    exchange->held -= parsed;
    exchange->parsed = 0;
    if (parsed > PARSED_TRIMMED) malloc_trim(0);
}

static json_t *parse_body(struct server_exchange *exchange, struct proto_problem *problem)
{
    const struct server_body *body = &exchange->body;
    struct server_monitor monitor = {.exchange = exchange};
    const struct gd_control control = server_exchange_control(&monitor);
    if (!server_request_begin_parsing(exchange, body->bytes, body->size, problem)) return NULL;
    json_t *document = proto_decode_document_within(body->bytes, body->size, &control, problem);
    if (!document) server_request_end_parsing(exchange);
    return document;
}

json_t *server_request_document(struct server_exchange *exchange, struct proto_problem *problem)
{
    if (is_json(server_exchange_header(exchange, "Content-Type")))
        return parse_body(exchange, problem);
    proto_problem_set(problem, PROTO_PROBLEM_UNSUPPORTED_MEDIA_TYPE,
                      "a query is JSON: send it with the header Content-Type: application/json");
    return NULL;
}

void server_request_fail(struct server_exchange *exchange, enum server_store_outcome outcome)
{
    switch (outcome) {
    case SERVER_STORE_ABSENT:
        reply_absent(exchange);
        break;
    case SERVER_STORE_PRECONDITION:
        server_reply_refusal(exchange, PROTO_PROBLEM_PRECONDITION_FAILED,
                             "the %s is not in the state that If-Match or If-None-Match asks for; "
                             "get its ETag and try again",
                             server_request_kind(exchange)->noun);
        break;
    case SERVER_STORE_NO_MEMORY:
        server_reply_refusal(exchange, PROTO_PROBLEM_INSUFFICIENT_MEMORY,
                             "there is no memory for this; delete meshes, raise --memory-budget, "
                             "or try again later");
        break;
    case SERVER_STORE_FULL:
        server_reply_refusal(exchange, PROTO_PROBLEM_INSUFFICIENT_STORAGE,
                             "the server's disk is full; nothing was changed: delete surfaces, or "
                             "try again when there is "
                             "room");
        break;
    case SERVER_STORE_REFUSED:
        server_reply_refusal(
            exchange, PROTO_PROBLEM_INSUFFICIENT_STORAGE,
            "the server's system refuses to write; nothing was changed: tell its operator");
        break;
    case SERVER_STORE_READ_ONLY:
    case SERVER_STORE_DAMAGED:
        server_reply_refusal(exchange, PROTO_PROBLEM_INSUFFICIENT_STORAGE,
                             "the server's store takes no changes since a write failed; queries go "
                             "on: tell its operator, "
                             "/readyz says more");
        break;
    case SERVER_STORE_STALE:
    case SERVER_STORE_UNAVAILABLE:
        reply_out_of_reach(
            exchange, "and it is not known whether the change was made: to repeat it does no harm");
        break;
    case SERVER_STORE_DONE:
    case SERVER_STORE_CREATED:
    case SERVER_STORE_REPLACED:
        break;
    }
}
