/* Batches: creates, lists, describes and removes them, and reads their answers
 * (jobs/batch_runner.h). All steps run on workers or on the thread of batches, because they read
 * the queue's database. */
#include "server/query/handlers.h"

#include <stdlib.h>
#include <string.h>

#include "proto/queries/many.h"
#include "proto/http/page.h"
#include "server/exchange/reply.h"
#include "server/jobs/batch_runner.h"
#include "server/jobs/job_table.h"
#include "server/query/api.h"
#include "server/query/request.h"
#include "server/store/kind.h"

#define BATCHES_MOST 1000 /* limit on the batches of a tenant */
#define MEMBERS_MOST 1024 /* bytes of an item's members beside its answer, and of a page's end */

_Static_assert(PROTO_MANY_ID == SERVER_JOB_ID, "batches have ids of jobs");

/* --- steps; each replies when it fails -------------------------------------------------------- */

static struct server_store_sql *open_queue(struct server_exchange *exchange)
{
    char error[SERVER_ERROR];
    struct server_store_sql *sql = server_batch_runner_sql(exchange->host->api->batches, error);
    if (!sql) server_request_fail(exchange, SERVER_STORE_REFUSED);
    return sql;
}

static bool check_outcome(struct server_exchange *exchange, enum server_outcome outcome)
{
    if (!outcome) return true;
    if (outcome == SERVER_STORE_ABSENT)
        server_reply_refusal(
            exchange, PROTO_PROBLEM_NOT_FOUND,
            "there is no batch of this id; GET /v1/batches lists those that there are");
    else
        server_request_fail(exchange, outcome);
    return false;
}

static struct server_store_sql *find_batch(struct server_exchange *exchange,
                                           struct proto_many_state *out)
{
    const struct proto_capture *capture = &exchange->match.captures[0];
    char id[PROTO_MANY_ID] = "";
    struct server_store_sql *sql = open_queue(exchange);
    if (!sql) return NULL;
    if (capture->length == PROTO_MANY_ID - 1) memcpy(id, capture->text, PROTO_MANY_ID - 1);
    if (!check_outcome(exchange, server_batch_queue_find(sql, exchange->tenant, id, out)))
        return NULL;
    return sql;
}

static void reply_batch(struct server_exchange *exchange, unsigned status,
                        const struct proto_many_state *batch)
{
    struct proto_writer writer;
    server_reply_writer(exchange, &writer);
    proto_batch_encode(&writer, batch);
    server_reply_json(exchange, status, &writer);
}

/* --- create ----------------------------------------------------------------------------------- */

/* Writes the ETag of the current version of the mesh. All items of a batch of all-pairs use this
 * version; for other batches, writes "". */
static bool fix_version(struct server_exchange *exchange, const struct proto_many *many,
                        char etag[SERVER_ETAG])
{
    struct server_registry *registry = exchange->host->api->registry;
    const struct server_key key = {exchange->tenant, &server_kind_mesh, proto_many_mesh(many, 0)};
    struct server_listed listed;
    etag[0] = '\0';
    if (many->query != PROTO_MANY_ALL_PAIRS) return true;
    (void)server_registry_follow(registry, exchange->started_ns);
    if (server_registry_find(registry, &key, &listed)) {
        strcpy(etag, listed.record->etag);
        server_listed_release(&listed);
        return true;
    }
    server_request_fail(exchange, SERVER_STORE_ABSENT);
    return false;
}

/* Checks the number of batches. If there are too many, the problem is conflict, because a retry can
 * succeed only after a DELETE. */
static bool check_room(struct server_exchange *exchange, struct server_store_sql *sql)
{
    int64_t count;
    struct proto_problem problem;
    if (!check_outcome(exchange, server_batch_queue_count(sql, exchange->tenant, &count)))
        return false;
    if (count < BATCHES_MOST) return true;
    (void)proto_problem_set(
        &problem, PROTO_PROBLEM_CONFLICT,
        "there are %d batches already; delete those whose answers are no longer needed",
        BATCHES_MOST);
    return server_reply_check(exchange, proto_problem_limit(&problem, BATCHES_MOST), &problem);
}

/* Replies unless the batch was added. The reply has no Retry-After if the batch may exist: a
 * repeated request would add a second one. */
static bool check_added(struct server_exchange *exchange, enum server_outcome outcome)
{
    struct proto_problem problem;
    if (outcome != SERVER_STORE_UNAVAILABLE) return check_outcome(exchange, outcome);
    return server_reply_check(
        exchange,
        proto_problem_set(&problem, PROTO_PROBLEM_STORE_UNAVAILABLE,
                          "the database does not answer, and it is not known whether it has added "
                          "the batch; if it has, GET /v1/batches lists the batch"),
        &problem);
}

static void add_batch(struct server_exchange *exchange, const struct proto_many *many)
{
    struct proto_many_state batch = {.items = many->item_count};
    char etag[SERVER_ETAG];
    struct server_store_sql *sql = open_queue(exchange);
    if (!sql || !fix_version(exchange, many, etag) || !check_room(exchange, sql)) return;
    batch.created = server_job_id_create(batch.id);
    const struct server_batch_order order = {&batch, exchange->tenant, exchange->body.bytes,
                                             exchange->body.size, etag};
    if (!check_added(exchange, server_batch_queue_add(sql, &order))) return;
    server_batch_runner_wake(exchange->host->api->batches);
    server_reply_header(exchange, "Location", "/v1/batches/%s", batch.id);
    reply_batch(exchange, 201, &batch);
}

static bool create_batch(struct server_exchange *exchange)
{
    struct proto_problem problem;
    struct proto_many many;
    json_t *document = server_request_document(exchange, &problem);
    if (document && proto_many_decode(document, &many, &problem)) {
        add_batch(exchange, &many);
        proto_many_free(&many);
    } else {
        json_decref(document);
        server_reply_problem(exchange, &problem);
    }
    server_request_end_parsing(exchange);
    return true;
}

void server_handle_create_batch(struct server_exchange *exchange)
{
    if (server_reply_accepts_json(exchange) && server_request_is_plain(exchange))
        server_exchange_defer(exchange, create_batch, NULL);
}

/* --- wait ------------------------------------------------------------------------------------- */

/* Begins a wait of `wait_s` seconds. Call this function before the queue is read. */
static struct server_batch_wait wait_begin(const struct server_exchange *exchange, uint64_t wait_s)
{
    return (struct server_batch_wait){.news =
                                          server_batch_runner_news(exchange->host->api->batches),
                                      .until_ns = server_request_wait_end(exchange, wait_s)};
}

/* Submits the exchange to the thread that reads batches. */
static bool reader_submit(struct server_exchange *exchange)
{
    (void)server_workers_submit(exchange->host->batch_readers, &exchange->job); /* never full */
    return true;
}

/* Parks the exchange until the queue may have changed. Returns false if the exchange must be
 * answered now. */
static bool wait_for_news(struct server_exchange *exchange, struct server_batch_wait *wait,
                          const struct proto_many_state *batch)
{
    struct server_batch_runner *runner = exchange->host->api->batches;
    wait->id = batch->id;
    return !proto_many_has_ended(batch) && gd_now_ns() < wait->until_ns &&
           !atomic_load(&exchange->host->is_draining) &&
           server_batch_runner_wait(runner, &exchange->job, wait);
}

/* --- list, describe, remove ------------------------------------------------------------------- */

static bool list_batches(struct server_exchange *exchange)
{
    struct proto_page page;
    struct proto_writer writer;
    struct proto_many_state batches[PROTO_PAGE_MOST + 1];
    struct server_store_sql *sql = open_queue(exchange);
    if (!sql || !server_request_page(exchange, &page)) return true;
    struct server_batch_list list = {.batches = batches, .most = page.limit + 1};
    if (!check_outcome(exchange, server_batch_queue_list(sql, exchange->tenant,
                                                         page.after ? page.after : "", &list)))
        return true;
    uint32_t shown = list.count < page.limit ? list.count : page.limit;
    server_reply_writer(exchange, &writer);
    proto_page_begin(&writer, "batches");
    for (uint32_t i = 0; i < shown; i++) proto_batch_encode(&writer, &batches[i]);
    proto_page_end(&writer, list.count > page.limit ? batches[shown - 1].id : NULL);
    server_reply_json(exchange, 200, &writer);
    return true;
}

void server_handle_list_batches(struct server_exchange *exchange)
{
    if (server_reply_accepts_json(exchange)) server_exchange_defer(exchange, list_batches, NULL);
}

/* Describes the batch. Returns false if the exchange is parked until the batch or the wait ends. */
static bool describe_batch(struct server_exchange *exchange)
{
    struct proto_many_state batch;
    uint64_t wait_s;
    if (!server_request_wait(exchange, &wait_s)) return true;
    struct server_batch_wait wait = wait_begin(exchange, wait_s);
    if (!find_batch(exchange, &batch)) return true;
    if (wait_for_news(exchange, &wait, &batch)) return false;
    reply_batch(exchange, 200, &batch);
    return true;
}

void server_handle_get_batch(struct server_exchange *exchange)
{
    if (server_reply_accepts_json(exchange))
        server_exchange_defer(exchange, describe_batch, reader_submit);
}

/* Ends a batch, or removes an ended one. */
static bool end_batch(struct server_exchange *exchange, struct server_store_sql *sql,
                      const struct proto_many_state *batch)
{
    if (!check_outcome(exchange, proto_many_has_ended(batch)
                                     ? server_batch_queue_remove(sql, batch->id)
                                     : server_batch_queue_cancel(sql, batch->id)))
        return true;
    server_batch_runner_cancel(exchange->host->api->batches, batch->id);
    server_reply_empty(exchange, 204);
    return true;
}

static bool remove_batch(struct server_exchange *exchange)
{
    struct proto_many_state batch;
    struct server_store_sql *sql = find_batch(exchange, &batch);
    return !sql || end_batch(exchange, sql, &batch);
}

/* Cancels a running batch. Removes an ended one on a worker, because that can take long. */
static bool cancel_batch(struct server_exchange *exchange)
{
    struct proto_many_state batch;
    struct server_store_sql *sql = find_batch(exchange, &batch);
    if (!sql) return true;
    if (!proto_many_has_ended(&batch)) return end_batch(exchange, sql, &batch);
    exchange->work = remove_batch;
    return !server_exchange_queue(exchange);
}

void server_handle_delete_batch(struct server_exchange *exchange)
{
    if (server_request_is_plain(exchange))
        server_exchange_defer(exchange, cancel_batch, reader_submit);
}

/* --- answers ---------------------------------------------------------------------------------- */

struct answers {
    struct proto_many many;
    struct proto_many_page page;
    struct proto_many_state batch; /* the batch's state when the reading of answers began */
    struct proto_writer writer;
    struct server_batch_place place; /* position of the last answer on the page */
    uint32_t count;
    bool is_cut;   /* true if more answers exist than fit on the page */
    uint32_t seen; /* rows of one read */
};

static bool on_answer(void *user, const struct server_sql_value *row)
{
    struct answers *answers = user;
    answers->seen++;
    const struct proto_writer *writer = &answers->writer;
    bool fits = writer->size + row[2].size + MEMBERS_MOST <= writer->maximum;
    answers->is_cut = answers->count == answers->page.limit || writer->size > PROTO_PAGE_BYTES ||
                      (answers->count && !fits);
    if (answers->is_cut) return false;
    answers->count++;
    answers->place.after = row[3].integer;
    proto_many_encode_answer(&answers->writer, &answers->many, (uint32_t)row[0].integer,
                             (unsigned)row[1].integer, row[2].bytes, row[2].size);
    return true;
}

/* Replies with a page. If items are listed in the order of their answers, there is a next page as
 * long as more answers may follow. */
static void reply_answers(struct server_exchange *exchange, struct server_store_sql *sql,
                          struct answers *answers)
{
    enum server_outcome outcome;
    const struct proto_many_state *batch = &answers->batch;
    server_reply_writer(exchange, &answers->writer);
    proto_page_begin(&answers->writer, "results");
    do {
        answers->seen = 0;
        outcome = server_batch_queue_answers(sql, &answers->place, on_answer, answers);
    } while (!outcome && answers->seen == SERVER_BATCH_ANSWERS && !answers->is_cut);
    if (!check_outcome(exchange, outcome)) {
        proto_writer_free(&answers->writer);
        return;
    }
    bool has_next = answers->is_cut || (answers->page.is_by_number && !proto_many_has_ended(batch));
    proto_many_end_page(&answers->writer, batch, has_next ? answers->place.after : -1);
    server_reply_json(exchange, 200, &answers->writer);
}

static bool read_batch(struct server_exchange *exchange, struct server_store_sql *sql,
                       const char *id, struct proto_many *out)
{
    struct proto_problem problem;
    void *text;
    size_t size;
    if (!check_outcome(exchange, server_batch_queue_document(sql, id, &text, &size))) return false;
    bool is_read = proto_many_read(text, size, out, &problem);
    free(text);
    return server_reply_check(exchange, is_read, &problem);
}

/* Lists answers. Returns false if the exchange is parked until there are answers, or until the
 * batch or the wait ends. */
static bool list_answers(struct server_exchange *exchange)
{
    struct answers answers = {.count = 0};
    struct proto_many_state *batch = &answers.batch;
    struct proto_problem problem;
    if (!server_reply_check(exchange,
                            proto_many_parse_page(&exchange->parameters, &answers.page, &problem),
                            &problem))
        return true;
    struct server_batch_wait wait = wait_begin(exchange, answers.page.wait_s);
    struct server_store_sql *sql = find_batch(exchange, batch);
    if (!sql) return true;
    if (answers.page.is_by_number && batch->done <= answers.page.after &&
        wait_for_news(exchange, &wait, batch))
        return false;
    if (!read_batch(exchange, sql, batch->id, &answers.many)) return true;
    answers.place =
        (struct server_batch_place){batch->id, answers.page.after, answers.page.is_by_number};
    reply_answers(exchange, sql, &answers);
    proto_many_free(&answers.many);
    return true;
}

void server_handle_get_batch_results(struct server_exchange *exchange)
{
    if (server_reply_accepts_json(exchange))
        server_exchange_defer(exchange, list_answers, reader_submit);
}
