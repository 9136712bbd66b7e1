/* Batches: many-source work that is spread over the daemons of a store (batches.h), and what
 * clients ask about it. What is asked of the queue's database is done by workers. */
#include "server/query/handlers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <time.h>

#include "proto/many.h"
#include "proto/page.h"
#include "server/jobs/batches.h"
#include "server/query/request.h"
#include "server/store/kind.h"
#include "server/base/log.h"
#include "server/http/reply.h"
#include "server/query/api.h"

#define BATCHES_MOST 1000 /* of a tenant */
#define READ_AT_ONCE 16

/* --- steps, each replies when it fails -------------------------------------------------------- */

static struct server_store_sql *open_queue(struct server_exchange *exchange)
{
    char error[256];
    struct server_store_sql *sql =
        server_batches_sql(exchange->host->api->batches, error, sizeof error);
    if (sql) return sql;
    server_request_fail(exchange, SERVER_STORE_REFUSED);
    return NULL;
}

static bool check(struct server_exchange *exchange, enum server_store_outcome outcome)
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

/* The batch that the path names. */
static bool find_batch(struct server_exchange *exchange, struct server_store_sql *sql,
                       struct server_batch *out)
{
    const struct proto_capture *capture = &exchange->match.captures[0];
    char id[SERVER_BATCH_ID] = "";
    if (capture->length == SERVER_BATCH_ID - 1) memcpy(id, capture->text, SERVER_BATCH_ID - 1);
    id[SERVER_BATCH_ID - 1] = '\0';
    return check(exchange, id[0] ? server_batch_queue_find(sql, exchange->tenant, id, out)
                                 : SERVER_STORE_ABSENT);
}

static struct proto_many_state state_of(const struct server_batch *batch)
{
    return (struct proto_many_state){.id = batch->id,
                                     .items = batch->items,
                                     .done = batch->done,
                                     .failed = batch->failed,
                                     .created = batch->created,
                                     .is_cancelled = batch->is_cancelled};
}

static void reply_batch(struct server_exchange *exchange, unsigned status,
                        const struct server_batch *batch)
{
    struct proto_writer writer;
    const struct proto_many_state state = state_of(batch);
    server_reply_writer(exchange, &writer);
    proto_many_encode(&writer, &state);
    server_reply_json(exchange, status, &writer);
}

/* --- begun ------------------------------------------------------------------------------------ */

/* Ids grow with time, as far as the clock goes forward, and can't be guessed. */
static void name_batch(struct server_batch *batch)
{
    struct timespec now;
    uint64_t digits = 0;
    clock_gettime(CLOCK_REALTIME, &now);
    if (getrandom(&digits, sizeof digits, 0) < 0) digits = (uint64_t)now.tv_nsec;
    snprintf(batch->id, sizeof batch->id, "%012llx%012llx",
             (unsigned long long)now.tv_sec * 1000 + (unsigned long long)now.tv_nsec / 1000000,
             (unsigned long long)(digits & 0xffffffffffff));
    batch->created = now.tv_sec;
}

/* All items of all pairs are about one version of the mesh: that which there is now. */
static bool fix_version(struct server_exchange *exchange, const struct proto_many *many,
                        char etag[SERVER_ETAG])
{
    const struct server_key key = {exchange->tenant, &server_kind_mesh, proto_many_mesh(many, 0)};
    struct server_listed listed;
    etag[0] = '\0';
    if (many->query != PROTO_MANY_ALL_PAIRS) return true;
    (void)server_registry_follow(exchange->host->api->registry, exchange->started_ns);
    if (server_registry_find(exchange->host->api->registry, &key, &listed)) {
        strcpy(etag, listed.record->etag);
        server_listed_release(&listed);
        return true;
    }
    server_request_fail(exchange, SERVER_STORE_ABSENT);
    return false;
}

/* No matter of time, which would make clients ask again: only a DELETE makes room. */
static bool has_room(struct server_exchange *exchange, struct server_store_sql *sql)
{
    int64_t count;
    struct proto_problem problem;
    if (!check(exchange, server_batch_queue_count(sql, exchange->tenant, &count))) return false;
    if (count < BATCHES_MOST) return true;
    (void)proto_problem_set(
        &problem, PROTO_PROBLEM_CONFLICT,
        "there are %d batches already; delete those whose answers are no longer needed",
        BATCHES_MOST);
    (void)proto_problem_limit(&problem, BATCHES_MOST);
    server_reply_problem(exchange, &problem);
    return false;
}

static void add_batch(struct server_exchange *exchange, const struct proto_many *many)
{
    struct server_batch batch = {.items = many->item_count};
    char etag[SERVER_ETAG];
    struct server_store_sql *sql = open_queue(exchange);
    if (!sql || !fix_version(exchange, many, etag) || !has_room(exchange, sql)) return;
    name_batch(&batch);
    const struct server_batch_order order = {&batch, exchange->tenant, exchange->body.bytes,
                                             exchange->body.size, etag};
    if (!check(exchange, server_batch_queue_add(sql, &order))) return;
    server_batches_wake(exchange->host->api->batches);
    server_reply_header(exchange, "Location", "/v1/batches/%s", batch.id);
    reply_batch(exchange, 201, &batch);
}

static bool create(struct server_exchange *exchange)
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
        server_exchange_defer(exchange, create, NULL);
}

/* --- told ------------------------------------------------------------------------------------- */

static bool list(struct server_exchange *exchange)
{
    struct proto_page page;
    struct proto_writer writer;
    uint32_t count = 0;
    struct server_store_sql *sql = open_queue(exchange);
    if (!sql || !server_request_page(exchange, &page)) return true;
    struct server_batch *batches = calloc(page.limit + 1, sizeof *batches);
    enum server_store_outcome outcome =
        batches ? server_batch_queue_list(sql, exchange->tenant, page.after ? page.after : "",
                                          page.limit + 1, batches, &count)
                : SERVER_STORE_NO_MEMORY;
    if (check(exchange, outcome)) {
        uint32_t shown = count < page.limit ? count : page.limit;
        server_reply_writer(exchange, &writer);
        proto_page_begin(&writer, "batches");
        for (uint32_t i = 0; i < shown; i++) {
            const struct proto_many_state state = state_of(&batches[i]);
            proto_many_encode(&writer, &state);
        }
        proto_page_end(&writer, count > page.limit ? batches[shown - 1].id : NULL);
        server_reply_json(exchange, 200, &writer);
    }
    free(batches);
    return true;
}

void server_handle_list_batches(struct server_exchange *exchange)
{
    if (server_reply_accepts_json(exchange)) server_exchange_defer(exchange, list, NULL);
}

static bool get(struct server_exchange *exchange)
{
    struct server_batch batch;
    struct server_store_sql *sql = open_queue(exchange);
    if (sql && find_batch(exchange, sql, &batch)) reply_batch(exchange, 200, &batch);
    return true;
}

void server_handle_get_batch(struct server_exchange *exchange)
{
    if (server_reply_accepts_json(exchange) && server_request_is_plain(exchange))
        server_exchange_defer(exchange, get, NULL);
}

/* --- its answers ------------------------------------------------------------------------------ */

struct answers {
    struct proto_many many;
    struct proto_writer writer;
    int64_t last; /* item shown */
    uint32_t count, most;
    bool is_cut;   /* there are more than fit on the page */
    uint32_t seen; /* rows of one reading */
};

static bool on_answer(void *user, const struct server_sql_value *row)
{
    struct answers *answers = user;
    answers->seen++;
    answers->is_cut = answers->count == answers->most || answers->writer.size > PROTO_PAGE_BYTES;
    if (answers->is_cut) return false;
    answers->count++;
    answers->last = row[0].integer;
    proto_many_encode_answer(&answers->writer, &answers->many, (uint32_t)row[0].integer,
                             (unsigned)row[1].integer, row[2].bytes, row[2].size);
    return true;
}

/* A few at a time, since an answer may be large. */
static enum server_store_outcome show_answers(struct server_store_sql *sql, const char *id,
                                              struct answers *answers)
{
    enum server_store_outcome outcome;
    do {
        answers->seen = 0;
        outcome =
            server_batch_queue_answers(sql, id, answers->last, READ_AT_ONCE, on_answer, answers);
    } while (!outcome && answers->seen == READ_AT_ONCE && !answers->is_cut);
    return outcome;
}

/* What the batch asks. */
static bool read_many(struct server_exchange *exchange, struct server_store_sql *sql,
                      const char *id, struct proto_many *out)
{
    struct proto_problem problem;
    void *text;
    size_t size;
    if (!check(exchange, server_batch_queue_document(sql, id, &text, &size))) return false;
    bool is_read = proto_many_read(text, size, out, &problem);
    free(text);
    if (!is_read) server_reply_problem(exchange, &problem);
    return is_read;
}

/* The cursor of a page of answers: a number of an item. */
static bool read_cursor(struct server_exchange *exchange, const struct proto_page *page,
                        int64_t *out)
{
    struct proto_problem problem;
    if (proto_page_number(page, out, &problem)) return true;
    server_reply_problem(exchange, &problem);
    return false;
}

static void reply_answers(struct server_exchange *exchange, struct server_store_sql *sql,
                          const char *id, struct answers *answers)
{
    char next[PROTO_PAGE_NUMBER];
    server_reply_writer(exchange, &answers->writer);
    proto_page_begin(&answers->writer, "results");
    if (!check(exchange, show_answers(sql, id, answers))) {
        proto_writer_free(&answers->writer);
        return;
    }
    proto_page_end(&answers->writer,
                   answers->is_cut ? proto_page_write_number(answers->last, next) : NULL);
    server_reply_json(exchange, 200, &answers->writer);
}

static bool get_results(struct server_exchange *exchange)
{
    struct answers answers = {.last = -1};
    struct server_batch batch;
    struct proto_page page;
    struct server_store_sql *sql = open_queue(exchange);
    if (!sql || !server_request_page(exchange, &page) ||
        !read_cursor(exchange, &page, &answers.last))
        return true;
    if (!find_batch(exchange, sql, &batch) || !read_many(exchange, sql, batch.id, &answers.many))
        return true;
    answers.most = page.limit;
    reply_answers(exchange, sql, batch.id, &answers);
    proto_many_free(&answers.many);
    return true;
}

void server_handle_get_batch_results(struct server_exchange *exchange)
{
    if (server_reply_accepts_json(exchange)) server_exchange_defer(exchange, get_results, NULL);
}

/* --- ended ------------------------------------------------------------------------------------ */

static bool end(struct server_exchange *exchange)
{
    struct server_batch batch;
    struct server_store_sql *sql = open_queue(exchange);
    if (!sql || !find_batch(exchange, sql, &batch)) return true;
    bool has_ended = batch.is_cancelled || batch.done == batch.items;
    if (!check(exchange, has_ended ? server_batch_queue_remove(sql, batch.id)
                                   : server_batch_queue_cancel(sql, batch.id)))
        return true;
    server_batches_end(exchange->host->api->batches, batch.id);
    server_reply_empty(exchange, 204);
    return true;
}

void server_handle_delete_batch(struct server_exchange *exchange)
{
    if (server_request_is_plain(exchange)) server_exchange_defer(exchange, end, NULL);
}
