#include "server/jobs/batch_queue.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

const char *const server_batch_queue_tables[] = {
    "CREATE TABLE IF NOT EXISTS batches (id TEXT PRIMARY KEY, tenant TEXT NOT NULL, document BLOB "
    "NOT NULL,"
    " etag TEXT NOT NULL, items INTEGER NOT NULL, created INTEGER NOT NULL, cancelled INTEGER NOT "
    "NULL DEFAULT 0)",
    "CREATE TABLE IF NOT EXISTS items (batch TEXT NOT NULL, item INTEGER NOT NULL, lease INTEGER "
    "NOT NULL DEFAULT 0,"
    " node TEXT NOT NULL DEFAULT '', attempts INTEGER NOT NULL DEFAULT 0, status INTEGER NOT NULL "
    "DEFAULT 0,"
    " answer BLOB, PRIMARY KEY (batch, item)) WITHOUT ROWID",
    "CREATE INDEX IF NOT EXISTS items_waiting ON items (batch, item) WHERE status = 0",
    "CREATE INDEX IF NOT EXISTS batches_of_tenants ON batches (tenant, id)",
    "ALTER TABLE items ADD COLUMN number INTEGER NOT NULL DEFAULT 0",
    "UPDATE items SET number = counted.number FROM (SELECT batch, item, row_number()"
    " OVER (PARTITION BY batch ORDER BY item) AS number FROM items WHERE status > 0) AS counted"
    " WHERE items.batch = counted.batch AND items.item = counted.item",
    "CREATE UNIQUE INDEX items_answered ON items (batch, number) WHERE number > 0",
    "CREATE INDEX items_failed ON items (batch, status) WHERE status >= 400",
    NULL};

static int64_t now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

static void column_copy(char *to, size_t size, const struct server_sql_value *value)
{
    snprintf(to, size, "%s", value->type == SERVER_SQL_TEXT ? value->bytes : "");
}

/* --- batches ---------------------------------------------------------------------------------- */

/* Adds the items before the batch's row: without that row no daemon claims them. */
enum server_outcome server_batch_queue_add(struct server_store_sql *sql,
                                           const struct server_batch_order *order)
{
    const struct server_sql_value id = server_sql_text(order->batch->id),
                                  items = server_sql_integer(order->batch->items);
    enum server_outcome outcome = sql->run(
        sql,
        SERVER_SQL(
            "WITH RECURSIVE numbers (number) AS"
            " (SELECT CAST(0 AS bigint) UNION ALL SELECT number + 1 FROM numbers WHERE number + 1"
            " < $2) INSERT INTO items (batch, item) SELECT $1, number FROM numbers WHERE true"
            " ON CONFLICT (batch, item) DO NOTHING",
            SERVER_VALUES(id, items)));
    if (outcome) return outcome;
    return sql->run(sql,
                    SERVER_SQL("INSERT INTO batches (id, tenant, document, etag, items, created)"
                               " VALUES ($1, $2, $3, $4, $5, $6) ON CONFLICT (id) DO NOTHING",
                               SERVER_VALUES(id, server_sql_text(order->tenant),
                                             server_sql_bytes(order->document, order->size),
                                             server_sql_text(order->etag), items,
                                             server_sql_integer(order->batch->created))));
}

enum server_outcome server_batch_queue_count(struct server_store_sql *sql, const char *tenant,
                                             int64_t *count)
{
    struct server_sql_integers found = {0};
    enum server_outcome outcome = sql->run(
        sql, SERVER_SQL("SELECT count(*) FROM batches WHERE tenant = $1",
                        SERVER_VALUES(server_sql_text(tenant)), server_sql_on_integers, &found));
    *count = found.at[0];
    return outcome;
}

static bool on_batch(void *user, const struct server_sql_value *row)
{
    struct server_batch_list *list = user;
    struct proto_many_state *batch = &list->batches[list->count++];
    *batch = (struct proto_many_state){.items = row[1].integer,
                                       .created = row[2].integer,
                                       .is_cancelled = row[3].integer != 0,
                                       .done = row[4].integer,
                                       .failed = row[5].integer};
    column_copy(batch->id, sizeof batch->id, &row[0]);
    return list->count < list->most;
}

/* Answers are numbered from 1, so the largest number is their count. */
#define SELECT_BATCH                                                                               \
    "SELECT id, items, created, cancelled,"                                                        \
    " (SELECT coalesce(max(number), 0) FROM items WHERE batch = id AND number > 0),"               \
    " (SELECT count(*) FROM items WHERE batch = id AND status >= 400) FROM batches "

enum server_outcome server_batch_queue_find(struct server_store_sql *sql, const char *tenant,
                                            const char *id, struct proto_many_state *out)
{
    struct server_batch_list list = {.batches = out, .most = 1};
    enum server_outcome outcome =
        sql->run(sql, SERVER_SQL(SELECT_BATCH "WHERE tenant = $1 AND id = $2",
                                 SERVER_VALUES(server_sql_text(tenant), server_sql_text(id)),
                                 on_batch, &list));
    return !outcome && !list.count ? SERVER_STORE_ABSENT : outcome;
}

enum server_outcome server_batch_queue_list(struct server_store_sql *sql, const char *tenant,
                                            const char *after, struct server_batch_list *list)
{
    list->count = 0;
    return sql->run(sql,
                    SERVER_SQL(SELECT_BATCH "WHERE tenant = $1 AND id > $2 ORDER BY id LIMIT $3",
                               SERVER_VALUES(server_sql_text(tenant), server_sql_text(after),
                                             server_sql_integer(list->most)),
                               on_batch, list));
}

struct document {
    void *bytes;
    size_t size;
    bool is_there;
};

static bool on_document(void *user, const struct server_sql_value *row)
{
    struct document *document = user;
    document->is_there = true;
    document->size = row[0].size;
    document->bytes = malloc(document->size + 1);
    if (document->bytes) memcpy(document->bytes, row[0].bytes, document->size);
    return false;
}

enum server_outcome server_batch_queue_document(struct server_store_sql *sql, const char *id,
                                                void **document, size_t *size)
{
    struct document found = {0};
    enum server_outcome outcome =
        sql->run(sql, SERVER_SQL("SELECT document FROM batches WHERE id = $1",
                                 SERVER_VALUES(server_sql_text(id)), on_document, &found));
    if (outcome) return outcome;
    if (!found.is_there) return SERVER_STORE_ABSENT;
    if (!found.bytes) return SERVER_STORE_NO_MEMORY;
    *document = found.bytes;
    *size = found.size;
    return SERVER_STORE_DONE;
}

enum server_outcome server_batch_queue_answers(struct server_store_sql *sql,
                                               const struct server_batch_place *place,
                                               server_sql_visit *visit, void *user)
{
    const char *text = place->is_by_number
                           ? "SELECT item, status, answer, number FROM items WHERE batch = $1"
                             " AND number > $2 AND number > 0 ORDER BY number LIMIT $3"
                           : "SELECT item, status, answer, item FROM items WHERE batch = $1"
                             " AND item > $2 AND status > 0 ORDER BY item LIMIT $3";
    return sql->run(
        sql, SERVER_SQL(text,
                        SERVER_VALUES(server_sql_text(place->id), server_sql_integer(place->after),
                                      server_sql_integer(SERVER_BATCH_ANSWERS)),
                        visit, user));
}

enum server_outcome server_batch_queue_cancel(struct server_store_sql *sql, const char *id)
{
    return sql->run(sql, SERVER_SQL("UPDATE batches SET cancelled = 1 WHERE id = $1",
                                    SERVER_VALUES(server_sql_text(id))));
}

/* Removes the batch's row last, so that after a failure the client can find the batch and remove it
 * again. Cancels the batch first, so that the batch counts as ended even without its items. */
enum server_outcome server_batch_queue_remove(struct server_store_sql *sql, const char *id)
{
    static const char *const steps[] = {
        "UPDATE batches SET cancelled = 1 WHERE id = $1 AND cancelled = 0",
        "DELETE FROM items WHERE batch = $1", "DELETE FROM batches WHERE id = $1"};
    enum server_outcome outcome = SERVER_STORE_DONE;
    for (size_t i = 0; !outcome && i < sizeof steps / sizeof *steps; i++)
        outcome = sql->run(sql, SERVER_SQL(steps[i], SERVER_VALUES(server_sql_text(id))));
    return outcome;
}

/* --- items ------------------------------------------------------------------------------------ */

static bool on_claim(void *user, const struct server_sql_value *row)
{
    struct server_batch_claim *claim = user;
    column_copy(claim->id, sizeof claim->id, &row[0]);
    claim->item = row[1].integer;
    claim->attempts = row[2].integer;
    return false;
}

static bool on_owner(void *user, const struct server_sql_value *row)
{
    struct server_batch_claim *claim = user;
    column_copy(claim->tenant, sizeof claim->tenant, &row[0]);
    column_copy(claim->etag, sizeof claim->etag, &row[1]);
    return false;
}

/* Claims an item of the oldest batch of the first tenant that the condition admits. Leaves `*out`
 * unchanged if there is none. */
static enum server_outcome claim_where(struct server_store_sql *sql, const char *node,
                                       const char *condition, const char *after,
                                       struct server_batch_claim *out)
{
    int64_t now = now_ms();
    char text[1024];
    snprintf(text, sizeof text,
             "WITH oldest AS (SELECT b.id FROM batches b WHERE b.cancelled = 0 AND %s AND EXISTS"
             " (SELECT 1 FROM items w WHERE w.batch = b.id AND w.status = 0 AND w.lease < $1)"
             " ORDER BY b.tenant, b.id LIMIT 1),"
             " next AS (SELECT i.batch, i.item FROM items i WHERE i.batch = (SELECT id FROM oldest)"
             " AND i.status = 0 AND i.lease < $1 ORDER BY i.item LIMIT 1%s)"
             " UPDATE items SET lease = $2, node = $3, attempts = attempts + 1 WHERE status = 0"
             " AND (batch, item) IN (SELECT batch, item FROM next) RETURNING batch, item, attempts",
             condition, sql->skip_locked);
    return sql->run(sql, SERVER_SQL(text,
                                    SERVER_VALUES(server_sql_integer(now),
                                                  server_sql_integer(now + SERVER_BATCH_LEASE),
                                                  server_sql_text(node), server_sql_text(after)),
                                    on_claim, out));
}

enum server_outcome server_batch_queue_claim(struct server_store_sql *sql, const char *node,
                                             const char *after, struct server_batch_claim *out)
{
    struct server_batch_claim claim = {.id = ""};
    enum server_outcome outcome = claim_where(sql, node, "b.tenant > $4", after, &claim);
    if (!outcome && !claim.id[0]) outcome = claim_where(sql, node, "b.tenant <= $4", after, &claim);
    if (outcome) return outcome;
    if (!claim.id[0]) return SERVER_STORE_ABSENT;
    outcome = sql->run(sql, SERVER_SQL("SELECT tenant, etag FROM batches WHERE id = $1",
                                       SERVER_VALUES(server_sql_text(claim.id)), on_owner, &claim));
    if (!outcome) *out = claim;
    return outcome;
}

enum server_outcome server_batch_queue_renew(struct server_store_sql *sql,
                                             const struct server_batch_claim *claim,
                                             const char *node)
{
    struct server_sql_integers renewed = {0};
    enum server_outcome outcome = sql->run(
        sql,
        SERVER_SQL(
            "UPDATE items SET lease = $4 WHERE batch = $1 AND item = $2 AND node = $3"
            " AND status = 0 AND EXISTS (SELECT 1 FROM batches WHERE id = $1 AND cancelled = 0)"
            " RETURNING item",
            SERVER_VALUES(server_sql_text(claim->id), server_sql_integer(claim->item),
                          server_sql_text(node), server_sql_integer(now_ms() + SERVER_BATCH_LEASE)),
            server_sql_on_integers, &renewed));
    return !outcome && !renewed.rows ? SERVER_STORE_ABSENT : outcome;
}

enum server_outcome server_batch_queue_return(struct server_store_sql *sql,
                                              const struct server_batch_claim *claim,
                                              const char *node, bool was_tried, int64_t pause_ms)
{
    int64_t lease = pause_ms ? now_ms() + pause_ms : 0;
    int64_t attempts = was_tried ? claim->attempts : claim->attempts - 1;
    return sql->run(
        sql, SERVER_SQL("UPDATE items SET lease = $4, node = '', attempts = $5"
                        " WHERE batch = $1 AND item = $2 AND node = $3 AND status = 0",
                        SERVER_VALUES(server_sql_text(claim->id), server_sql_integer(claim->item),
                                      server_sql_text(node), server_sql_integer(lease),
                                      server_sql_integer(attempts))));
}

enum server_outcome server_batch_queue_return_all(struct server_store_sql *sql)
{
    return sql->run(sql, SERVER_SQL("UPDATE items SET lease = 0 WHERE status = 0 AND lease > 0"));
}

/* Writes the answer. If another daemon has just written the same number, the unique index rejects
 * the statement, which then runs again. So a number is visible only after all smaller numbers. */
enum server_outcome server_batch_queue_answer(struct server_store_sql *sql,
                                              const struct server_batch_claim *claim,
                                              unsigned status, const void *answer, size_t size)
{
    return sql->run(
        sql, SERVER_SQL("UPDATE items SET status = $3, answer = $4, lease = 0, number = 1 +"
                        " coalesce((SELECT last.number FROM items last WHERE last.batch = $1"
                        " AND last.number > 0 ORDER BY last.number DESC LIMIT 1), 0)"
                        " WHERE batch = $1 AND item = $2 AND status = 0"
                        " AND EXISTS (SELECT 1 FROM batches WHERE id = $1 AND cancelled = 0)",
                        SERVER_VALUES(server_sql_text(claim->id), server_sql_integer(claim->item),
                                      server_sql_integer(status), server_sql_bytes(answer, size))));
}
