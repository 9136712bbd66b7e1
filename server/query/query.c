#include "server/query/query.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "proto/http/accept.h"
#include "server/exchange/answer_stream.h"
#include "server/exchange/etag.h"
#include "server/exchange/reply.h"
#include "server/fields/cache.h"
#include "server/query/api.h"
#include "server/query/handlers.h"
#include "server/query/request.h"
#include "server/surfaces/landmarks.h"
#include "server/work/executor.h"

#define JSON  "application/json"
#define BYTES "application/octet-stream"

/* bytes for each edge in a search: the arrays of a workspace and the windows of a distant pair; see
 * doc/003 */
#define BYTES_AN_EDGE  224
#define BYTES_A_SEARCH ((size_t)1 << 20) /* further bytes on a mesh of any size */

enum { MOST_FORMS = 12, LARGE_TEXT = 4096 /* bytes of a request that may be read as text */ };

/* --- life ------------------------------------------------------------------------------------- */

struct server_query *server_query_create(const struct server_query_kind *kind,
                                         struct server_exchange *exchange,
                                         struct server_surface *surface)
{
    /* not calloc, which bypasses glibc's cache of freed blocks */
    struct server_query *query = malloc(kind->size);
    if (!query) return NULL;
    *query = (struct server_query){
        .kind = kind, .exchange = exchange, .surface = server_surface_retain(surface), .share = 1};
    memset(query + 1, 0, kind->size - sizeof *query);
    server_reply_writer(exchange, &query->draft);
    return query;
}

void server_query_destroy(struct server_query *query)
{
    if (!query) return;
    if (query->relay) server_relay_end(query->relay, query->is_whole);
    server_relay_release(query->relay);
    if (query->kind->release) query->kind->release(query);
    server_field_query_release(query);
    for (void **block = query->blocks, **next; block; block = next) {
        next = *block;
        free(block);
    }
    proto_located_points_free(&query->points);
    proto_writer_free(&query->draft);
    if (query->held) server_query_give(query, query->held);
    server_landmark_set_release(query->landmarks);
    server_surface_release(query->surface);
    free(query);
}

enum server_query_turn server_query_try_inline(struct server_query *query)
{
    const struct server_query_kind *kind = query->kind;
    if (kind->try_inline) return kind->try_inline(query);
    if (kind->answer) return server_field_query_try_inline(query);
    return kind->solve ? SERVER_QUERY_AGAIN : SERVER_QUERY_DONE;
}

enum server_query_turn server_query_solve(struct server_query *query)
{
    const struct server_query_kind *kind = query->kind;
    return kind->solve ? kind->solve(query) : server_field_query_solve(query);
}

struct server_monitor server_query_monitor(const struct server_query *query, double begun,
                                           double share)
{
    return (struct server_monitor){.exchange = query->exchange,
                                   .begun = query->begun + query->share * begun,
                                   .share = query->share * share};
}

void server_query_pass(struct server_query *query, double part)
{
    query->begun += query->share * part;
    query->share *= 1 - part;
}

enum server_query_turn server_query_fail(const struct server_query *query, enum gd_status status,
                                         const char *what)
{
    struct proto_problem *problem = query->problem;
    server_metrics_count_status(query->exchange->host->metrics, status);
    if (status != GD_BUDGET)
        proto_problem_from_status(problem, status, NULL);
    else if (query->draft.failure)
        (void)proto_writer_check(&query->draft, problem);
    else
        server_budget_refuse(query->exchange->host->budget, what, 0, problem);
    return SERVER_QUERY_FAILED;
}

enum server_query_turn server_query_fail_file(const struct server_query *query,
                                              enum gd_status status, const char *what)
{
    if (status != GD_EXTENT) return server_query_fail(query, status, what);
    (void)server_request_check_file(status, query->problem);
    return SERVER_QUERY_FAILED;
}

bool server_query_refuse(const struct server_query *query, enum gd_status status, const char *what)
{
    server_query_fail(query, status, what);
    return false;
}

/* --- memory and long calls -------------------------------------------------------------------- */

enum gd_status server_query_take(struct server_query *query, size_t bytes)
{
    if (!server_budget_take(query->exchange->host->budget, SERVER_BUDGET_FLIGHT, bytes))
        return GD_BUDGET;
    query->held += bytes;
    return GD_OK;
}

void server_query_give(struct server_query *query, size_t bytes)
{
    server_budget_give(query->exchange->host->budget, SERVER_BUDGET_FLIGHT, bytes);
    query->held -= bytes;
}

void *server_query_allocate(struct server_query *query, size_t count, size_t size)
{
    union {
        void *next;
        max_align_t alignment;
    } * block;
    size_t bytes = sizeof *block + count * size;
    if (server_query_take(query, bytes)) return NULL;
    block = calloc(1, bytes);
    if (!block) return NULL;
    block->next = query->blocks;
    query->blocks = block;
    return block + 1;
}

bool server_query_locate(struct server_query *query, struct proto_points *points)
{
    bool ok = proto_points_locate(query->surface->mesh, points, &query->points, query->problem);
    proto_points_free(points);
    return ok;
}

struct server_budgeted_call server_query_begin_call(struct server_query *query,
                                                    struct server_monitor *part, size_t grant)
{
    query->whole = server_query_monitor(query, 0, 1);
    return (struct server_budgeted_call){.workspaces = query->exchange->host->workspaces,
                                         .control =
                                             server_exchange_control(part ? part : &query->whole),
                                         .grant = grant,
                                         .held = &query->held};
}

static void task_run(void *user, uint32_t number)
{
    struct server_tasks *tasks = user;
    int none = GD_OK;
    if (atomic_load(&tasks->failure)) return;
    enum gd_status status = tasks->run(tasks->user, number);
    if (status) atomic_compare_exchange_strong(&tasks->failure, &none, (int)status);
}

enum gd_status server_query_run_tasks(const struct server_query *query, struct server_tasks *tasks,
                                      uint32_t count)
{
    const struct server_exchange *exchange = query->exchange;
    const struct gd_executor *executor =
        exchange->work && count > 1
            ? server_executor_start(exchange->host->workers, count, exchange->job.deadline_ns)
            : NULL;
    gd_executor_run(executor, task_run, tasks, count);
    server_executor_stop(executor);
    return (enum gd_status)atomic_load(&tasks->failure);
}

const struct gd_landmarks *server_query_landmarks(struct server_query *query)
{
    if (!query->landmarks)
        query->landmarks =
            server_landmarks_find(query->exchange->host->api->landmarks, query->surface);
    return query->landmarks ? query->landmarks->landmarks : NULL;
}

/* --- pairs ------------------------------------------------------------------------------------ */

/* The budget does not count the result, because a path is small and soon freed. */
enum gd_status server_pair_search(struct server_monitor *part, struct server_surface *surface,
                                  const struct server_pair *pair, struct gd_pair_answer *out)
{
    struct server_host *host = part->exchange->host;
    struct server_landmark_set *set = server_landmarks_find(host->api->landmarks, surface);
    size_t edges = gd_mesh_summary(surface->mesh)->edges;
    struct server_budgeted_call call = {.workspaces = host->workspaces,
                                        .control = server_exchange_control(part),
                                        .grant = BYTES_A_SEARCH + edges * BYTES_AN_EDGE};
    server_metrics_count_search(host->metrics);
    while (server_budgeted_call_next(&call))
        call.status =
            gd_pair_solve(surface->mesh,
                          &(struct gd_pair_request){.from = pair->from,
                                                    .to = pair->to,
                                                    .output = pair->output,
                                                    .landmarks = set ? set->landmarks : NULL},
                          &call.control, out, NULL);
    server_landmark_set_release(set);
    return call.status;
}

const struct server_cached *server_pair_find_field(struct server_surface *surface,
                                                   const struct server_pair *pair)
{
    const struct server_cached *cached = server_cache_find(surface->fields, pair->from);
    return cached ? cached : server_cache_find(surface->fields, pair->to);
}

enum gd_status server_pair_solve(struct server_monitor *part, struct server_surface *surface,
                                 const struct server_pair *pair, struct gd_pair_answer *out)
{
    const struct server_cached *cached = server_pair_find_field(surface, pair);
    if (!cached) return server_pair_search(part, surface, pair, out);
    enum gd_status status =
        gd_pair_from_field(cached->field, pair->from, pair->to, pair->output, out);
    server_cache_unpin(cached);
    return status;
}

/* Appends the leg without its first point, because that is the route's last point. */
static enum gd_status path_append(struct gd_path *route, const struct gd_path *leg)
{
    uint32_t more = leg->count - 1;
    struct gd_point *points =
        realloc(route->points, ((size_t)route->count + more) * sizeof *points);
    if (!points) return GD_NO_MEMORY;
    memcpy(points + route->count, leg->points + 1, more * sizeof *points);
    route->points = points;
    route->count += more;
    route->length += leg->length;
    return GD_OK;
}

enum gd_status server_pair_append(struct gd_pair_answer *route, struct gd_pair_answer *leg)
{
    enum gd_status status = GD_OK;
    route->distance += leg->distance;
    if (isinf(route->distance)) {
        gd_path_free(&route->path);
    } else if (!route->path.count) {
        route->path = leg->path;
        leg->path = (struct gd_path){0};
    } else {
        status = path_append(&route->path, &leg->path);
    }
    gd_pair_answer_free(leg);
    return status;
}

/* --- the draft -------------------------------------------------------------------------------- */

enum gd_status server_query_pause(const struct server_query *query,
                                  const struct gd_control *control, double fraction)
{
    return query->draft.failure ? GD_BUDGET : gd_control_check(control, fraction);
}

enum server_query_turn server_query_end_draft(struct server_query *query, enum gd_status status,
                                              const char *what)
{
    if (status) return server_query_fail(query, status, what);
    return proto_writer_check(&query->draft, query->problem) ? SERVER_QUERY_DONE
                                                             : SERVER_QUERY_FAILED;
}

void server_query_encode(const struct server_query *query, struct proto_writer *writer)
{
    if (query->kind->encode)
        query->kind->encode(query, writer);
    else
        proto_write_raw(writer, query->draft.data, query->draft.size);
}

bool server_query_can_flush(const struct server_query *query)
{
    const struct server_exchange *exchange = query->exchange;
    return query->relay || (query->draft.size >= SERVER_RELAY_BLOCK && !query->form &&
                            exchange->transport->can_stream && exchange->work &&
                            !exchange->is_http10 && !server_exchange_is(exchange, "HEAD"));
}

static void draft_send(struct server_query *query)
{
    struct proto_writer *draft = &query->draft;
    server_relay_write(query->relay, draft->data, draft->size);
    draft->flushed += draft->size;
    draft->size = 0;
}

/* --- the form of the answer ------------------------------------------------------------------- */

/* in the order of enum server_arrays_form */
static const struct server_form array_forms[] = {{"f64", SERVER_ARRAYS_MEDIA, false},
                                                 {"f32", SERVER_ARRAYS_MEDIA, false},
                                                 {"npy", "application/x-npy", false},
                                                 {"npz", "application/x-npz", false}};
#define ARRAY_FORMS (sizeof array_forms / sizeof *array_forms)

/* Returns the end of the kind's own forms, where those of arrays begin. */
static unsigned own_forms_end(const struct server_query_kind *kind)
{
    const struct server_form *form = kind->forms;
    while (form && form->name) form++;
    return SERVER_FORM_FIRST + (form ? (unsigned)(form - kind->forms) : 0);
}

static unsigned form_count(const struct server_query_kind *kind)
{
    return own_forms_end(kind) + (kind->list_arrays ? ARRAY_FORMS : 0);
}

static bool has_files(const struct server_query_kind *kind)
{
    return kind->forms || kind->list_arrays;
}

static const struct server_form *form_at(const struct server_query_kind *kind, unsigned form)
{
    static const struct server_form json = {"json", JSON, false}, bytes = {"float64", BYTES, false};
    unsigned arrays = own_forms_end(kind);
    if (form == SERVER_FORM_JSON) return &json;
    if (form == SERVER_FORM_BYTES) return &bytes;
    return form < arrays ? &kind->forms[form - SERVER_FORM_FIRST] : &array_forms[form - arrays];
}

/* Chooses the form by ?format= if that is given, otherwise by Accept. In a tie, chooses the form
 * that comes first. JSON precedes all others. */
static bool form_choose(const struct server_query_kind *kind, struct server_exchange *exchange,
                        unsigned *out, struct proto_problem *problem)
{
    const char *accept = server_exchange_header(exchange, "Accept");
    const char *words[MOST_FORMS + 1] = {"json"};
    unsigned word = 0, best = 0, count = form_count(kind);
    if (has_files(kind) && proto_parameters_get(&exchange->parameters, "format")) {
        for (unsigned i = SERVER_FORM_FIRST; i < count && i <= MOST_FORMS; i++)
            words[i - SERVER_FORM_BYTES] = form_at(kind, i)->name;
        if (!proto_parameters_choice(&exchange->parameters, "format", words, &word, problem))
            return false;
        *out = word ? word + SERVER_FORM_BYTES : SERVER_FORM_JSON;
        return true;
    }
    for (unsigned i = 0; i < count; i++) {
        unsigned quality = proto_accept_quality(accept, form_at(kind, i)->media_type);
        if (quality <= best || (i == SERVER_FORM_BYTES && !kind->has_bytes)) continue;
        best = quality;
        *out = i;
    }
    return best > 0 ||
           proto_problem_set(problem, PROTO_PROBLEM_NOT_ACCEPTABLE,
                             "the answer is %s%s; the request's Accept header allows none of "
                             "these",
                             JSON, has_files(kind) ? ", or a file: see format" : "");
}

/* Reads ?mesh=, which is allowed only for forms with a mesh. */
static bool form_read_mesh(struct server_query *query, const struct proto_parameters *parameters)
{
    if (!proto_parameters_flag(parameters, "mesh", &query->with_mesh, query->problem)) return false;
    return !query->with_mesh || form_at(query->kind, query->form)->has_mesh ||
           proto_problem_refuse(query->problem, "mesh",
                                "this format can't include the mesh; glb and obj can");
}

enum server_arrays_form server_query_arrays_form(const struct server_query *query)
{
    unsigned arrays = own_forms_end(query->kind);
    if (query->form == SERVER_FORM_BYTES) return SERVER_ARRAYS_RAW;
    return query->form < arrays ? SERVER_ARRAYS_NONE : SERVER_ARRAYS_F64 + query->form - arrays;
}

void server_query_keep_arrays(struct server_query *query)
{
    query->form = own_forms_end(query->kind);
}

static const char *form_name(const struct server_query *query)
{
    return query->kind->reply ? query->kind->reply_form : form_at(query->kind, query->form)->name;
}

/* --- a request of its own --------------------------------------------------------------------- */

bool server_query_list_lines(struct server_query *query, const struct gd_path *paths, size_t stride,
                             uint32_t count)
{
    query->lines = (struct server_lines){
        .mesh = query->surface->mesh, .paths = paths, .stride = stride, .count = count};
    query->lines.first = server_query_allocate(query, count + (size_t)1, sizeof(uint32_t));
    if (!query->lines.first) return server_query_refuse(query, GD_BUDGET, "the answer");
    if (!server_lines_count(&query->lines))
        return proto_problem_exceed(
            query->problem, NULL, UINT32_MAX,
            "the lines have more points than an array of indices can count");
    server_arrays_add_lines(&query->arrays, &query->lines);
    return true;
}

bool server_query_list_line(struct server_query *query, const struct gd_point *points,
                            uint32_t count)
{
    query->line = (struct gd_path){.points = (struct gd_point *)points, .count = count};
    return server_query_list_lines(query, &query->line, 0, points != NULL);
}

static void query_encode_arrays(struct server_exchange *exchange, struct proto_writer *writer)
{
    const struct server_query *query = exchange->state;
    server_arrays_write(&query->arrays, server_query_arrays_form(query), writer);
}

/* Replies with the answer. After the call a stream may own the query. */
static void query_reply_arrays(struct server_query *query)
{
    const struct server_form *form = form_at(query->kind, query->form);
    const struct server_answer_encoder encoder = {
        .encode = query_encode_arrays, .held = &query->held, .media_type = form->media_type};
    struct server_exchange *exchange = query->exchange;
    struct proto_writer writer;
    if (!server_reply_check(exchange, query->kind->list_arrays(query), query->problem)) return;
    if (query->form != SERVER_FORM_BYTES)
        server_reply_header(exchange, "Content-Disposition", "attachment; filename=\"%s.%s\"",
                            query->kind->name, form->name);
    server_reply_writer(exchange, &writer);
    server_answer_reply(exchange, 200, &writer, &encoder);
    proto_writer_free(&writer);
}

static void query_reply_form(struct server_query *query)
{
    const struct server_form *form = form_at(query->kind, query->form);
    struct server_answer_file file;
    if (!server_reply_check(query->exchange, query->kind->write(query, &file), query->problem))
        return;
    server_reply_header(query->exchange, "Content-Disposition", "attachment; filename=\"%s.%s\"",
                        query->kind->name, form->name);
    server_reply_bytes(query->exchange, 200, form->media_type, file.bytes, file.size);
}

static void query_encode(struct server_exchange *exchange, struct proto_writer *writer)
{
    struct server_query *query = exchange->state;
    query->exchange = exchange; /* in a stream the query has another exchange */
    query->kind->encode(query, writer);
}

/* Replies with the answer. After the call a stream may own the query. */
static void query_reply_json(struct server_query *query, unsigned status)
{
    const struct server_answer_encoder encoder = {.encode = query_encode, .held = &query->held};
    if (!query->kind->encode) {
        server_reply_json(query->exchange, status, &query->draft);
        return;
    }
    struct proto_writer writer = query->draft; /* empty */
    server_answer_reply(query->exchange, status, &writer, &encoder);
    proto_writer_free(&writer);
}

static void query_add_headers(const struct server_query *query, struct server_exchange *exchange)
{
    const struct server_query_kind *kind = query->kind;
    server_reply_tag(exchange, query->surface->record->etag, form_name(query));
    if (!kind->reply && (has_files(kind) || kind->has_bytes))
        server_reply_header(exchange, "Vary", "Accept");
}

static void query_reply(struct server_query *query)
{
    const struct server_query_kind *kind = query->kind;
    unsigned status = kind->status ? kind->status(query) : 200;
    if (query->relay) {
        draft_send(query);
        query->is_whole = true;
        server_reply_empty(query->exchange, status);
        return;
    }
    query_add_headers(query, query->exchange);
    if (kind->reply)
        kind->reply(query);
    else if (query->form == SERVER_FORM_JSON)
        query_reply_json(query, status);
    else if (server_query_arrays_form(query))
        query_reply_arrays(query);
    else
        query_reply_form(query);
}

/* Processes the turn that a step has returned. Returns false if another thread has the exchange.
 * After AGAIN the worker calls the step again. */
static bool query_take_turn(struct server_query *query, enum server_query_turn turn)
{
    if (turn == SERVER_QUERY_DONE) query_reply(query);
    if (turn == SERVER_QUERY_FAILED) server_reply_problem(query->exchange, query->problem);
    return turn != SERVER_QUERY_PARKED;
}

static bool on_is_gone(struct server_exchange *exchange)
{
    return server_relay_is_over(((const struct server_query *)exchange->state)->relay);
}

static void query_free(void *query)
{
    server_query_destroy(query);
}

/* Answers the request with a stream, and moves the query to an exchange that outlives the request.
 * If memory is short, the draft is kept instead. The transport limits the time in which the client
 * reads. */
static void query_start_stream(struct server_query *query)
{
    static const struct server_transport transport = {.finish = server_exchange_destroy,
                                                      .is_gone = on_is_gone};
    struct server_exchange *exchange = query->exchange;
    struct server_exchange *rest = server_request_stream(exchange, &transport, JSON, &query->relay);
    if (!rest) return;
    query_add_headers(query, exchange);
    rest->job.deadline_ns = UINT64_MAX;
    server_exchange_keep(rest, query, query_free);
    server_exchange_keep(exchange, NULL, NULL);
    query->exchange = rest;
    draft_send(query);
    server_request_go_on(rest);
}

/* Sends the draft. Returns false if the query is parked until the client has read some of the
 * answer. */
static bool query_flush(struct server_query *query)
{
    struct server_exchange *exchange = query->exchange;
    if (query->relay) {
        draft_send(query);
        return !server_relay_wait(query->relay, &exchange->job);
    }
    query_start_stream(query);
    return true;
}

static bool query_work(struct server_exchange *exchange)
{
    struct proto_problem problem;
    struct server_query *query = exchange->state;
    query->problem = &problem;
    enum server_query_turn turn = server_query_solve(query);
    if (turn != SERVER_QUERY_FLUSH) return query_take_turn(query, turn);
    return query_flush(query);
}

static bool query_join(struct server_exchange *exchange)
{
    struct server_query *query = exchange->state;
    if (query->kind->join) return query->kind->join(query);
    return query->kind->answer && server_field_query_join(query);
}

static bool query_is_arrays(const struct server_query *query)
{
    const char *type = server_exchange_header(query->exchange, "Content-Type");
    return query->kind->read_arrays && type &&
           strncasecmp(type, SERVER_ARRAYS_MEDIA, strlen(SERVER_ARRAYS_MEDIA)) == 0;
}

static bool query_read_arrays(struct server_query *query)
{
    const struct server_body *body = &query->exchange->body;
    struct server_arrays arrays;
    return server_arrays_read(body->bytes, body->size, query->kind->array_names, &arrays,
                              query->problem) &&
           query->kind->read_arrays(query, &arrays);
}

static bool query_read_text(struct server_query *query)
{
    const struct server_body *body = &query->exchange->body;
    return query->kind->read_text && body->size >= LARGE_TEXT &&
           server_request_is_json(query->exchange) &&
           query->kind->read_text(query, body->bytes, body->size);
}

static bool query_read(struct server_query *query)
{
    struct proto_problem *problem = query->problem;
    const struct server_query_kind *kind = query->kind;
    bool has_body = query->exchange->match.route->has_body;
    const struct proto_route *route = query->exchange->match.route;
    if (!proto_options_parse(&query->exchange->parameters, route->fields, route->parameters,
                             &query->options, problem))
        return false;
    if (!route->has_lines && query->options.geometry != PROTO_GEOMETRY_FULL)
        return proto_options_refuse_geometry(problem, "geometry");
    if (kind->has_bare_points && !proto_parameters_get(&query->exchange->parameters, "geometry"))
        query->options.geometry = PROTO_GEOMETRY_XYZ;
    if (has_files(kind) && !form_read_mesh(query, &query->exchange->parameters)) return false;
    if (!has_body) return kind->parse(query, &query->exchange->parameters);
    if (query_is_arrays(query)) return query_read_arrays(query);
    if (query_read_text(query)) return true;
    json_t *document = server_request_document(query->exchange, problem);
    if (!document) return false;
    bool ok = kind->decode(query, document);
    json_decref(document);
    server_request_end_parsing(query->exchange);
    return ok;
}

/* If the client already has the answer, replies 304 without computing anything. */
static bool query_is_known(struct server_query *query)
{
    struct server_exchange *exchange = query->exchange;
    const char *etag = query->surface->record->etag;
    char tag[SERVER_ETAG_TEXT];
    if (exchange->match.route->has_body || !exchange->has_conditions) return false;
    const struct server_precondition precondition = server_precondition_read(exchange);
    server_etag_write(tag, etag, form_name(query));
    if (!server_precondition_known(&precondition, tag)) return false;
    query_add_headers(query, exchange);
    server_reply_header(exchange, "Vary", "Accept-Encoding");
    server_reply_empty(exchange, 304);
    return true;
}

static void query_start(struct server_exchange *exchange)
{
    struct server_query *query = exchange->state;
    struct proto_problem problem;
    enum server_query_turn turn = SERVER_QUERY_AGAIN;
    query->problem = &problem;
    if (!server_reply_check(exchange, query_read(query), &problem) || query_is_known(query)) return;
    server_exchange_shorten(exchange, query->options.timeout_ms);
    if (!query->with_mesh) turn = server_query_try_inline(query);
    query_take_turn(query, turn);
    if (turn == SERVER_QUERY_AGAIN) server_exchange_defer(exchange, query_work, query_join);
}

void server_query_handle(struct server_exchange *exchange, const struct server_query_kind *kind)
{
    struct proto_problem problem;
    unsigned form = SERVER_FORM_JSON;
    bool is_acceptable = kind->reply || form_choose(kind, exchange, &form, &problem);
    if (!server_reply_check(exchange, is_acceptable, &problem)) return;
    struct server_surface *surface = server_request_surface(exchange);
    if (!surface) return;
    struct server_query *query = server_query_create(kind, exchange, surface);
    if (!query) {
        server_request_fail(exchange, SERVER_STORE_NO_MEMORY);
        return;
    }
    query->form = form;
    server_exchange_keep(exchange, query, query_free);
    query_start(exchange);
}

void server_handle_query(struct server_exchange *exchange)
{
    server_query_handle(exchange, exchange->match.route->kind);
}
