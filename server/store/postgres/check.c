/* See store.h: --check-store of a PostgreSQL store. */
#include <stdlib.h>

#include "server/store/postgres/objects.h"

#define PAGE        100
#define PAGE_TEXT   "100"
#define PATIENCE_NS UINT64_C(60000000000) /* of a statement */

struct check {
    FILE *out;
    struct server_record *page[PAGE];
    char last[SERVER_KEY_TEXT]; /* key */
    uint32_t count, rows;       /* on the page: of records, of rows */
    uint32_t faults, surfaces, objects;
    int64_t unused;
    unsigned long long bytes;
};

static void record_fault(struct check *check, const char *what, const char *key)
{
    fprintf(check->out, "fault: %s: %s\n", what, key);
    check->faults++;
}

static bool page_row(void *user, const struct server_sql_value *row)
{
    struct check *check = user;
    snprintf(check->last, sizeof check->last, "%s", row[0].bytes);
    check->rows++;
    check->surfaces++;
    if (server_record_read(row[0].bytes, row[1].bytes, row[1].size, &check->page[check->count]) ==
        SERVER_RECORD_READ)
        check->count++;
    else
        record_fault(check, "its row is damaged, or of a later version", row[0].bytes);
    return true;
}

static enum server_store_outcome page_object(struct server_pg *pg, struct check *check,
                                             const char *key, const struct server_object *object)
{
    void *bytes = malloc(object->size ? object->size : 1);
    if (!bytes) return SERVER_STORE_NO_MEMORY;
    enum server_store_outcome outcome = server_pg_read_object(pg, object, bytes);
    free(bytes);
    check->objects++;
    check->bytes += object->size;
    if (outcome != SERVER_STORE_ABSENT && outcome != SERVER_STORE_DAMAGED) return outcome;
    record_fault(check,
                 outcome == SERVER_STORE_ABSENT
                     ? "its bytes are missing"
                     : "its bytes are damaged: their SHA-256 is another one",
                 key);
    return SERVER_STORE_DONE;
}

static enum server_store_outcome check_page(struct server_pg *pg, struct check *check)
{
    const struct server_sql_value last = server_sql_text(check->last);
    struct server_object object;
    check->rows = check->count = 0;
    enum server_store_outcome outcome =
        server_pg_run(pg, SERVER_SQL("SELECT key, record FROM surfaces WHERE key > $1"
                                     " AND record IS NOT NULL ORDER BY key LIMIT " PAGE_TEXT,
                                     &last, 1, page_row, check));
    for (uint32_t i = 0; i < check->count; i++) {
        for (int part = 0; !outcome && part < SERVER_PARTS; part++)
            if (server_record_object(check->page[i], part, &object))
                outcome = page_object(pg, check, check->page[i]->key, &object);
        server_record_release(check->page[i]);
    }
    return outcome;
}

static enum server_store_outcome check_all(struct server_pg *pg, struct check *check)
{
    struct server_sql_integers unused = {0};
    enum server_store_outcome outcome;
    do outcome = check_page(pg, check);
    while (!outcome && check->rows == PAGE);
    if (!outcome)
        outcome = server_pg_run(
            pg, SERVER_SQL("SELECT count(*) FROM objects"
                           " WHERE NOT EXISTS (SELECT FROM surfaces WHERE file = id)"
                           " AND NOT EXISTS (SELECT FROM surfaces WHERE attachment = id)",
                           NULL, 0, server_sql_on_integers, &unused));
    check->unused = unused.at[0];
    return outcome;
}

bool server_store_check_postgres(const char *url, FILE *out)
{
    struct check check = {.out = out};
    struct server_pg_pool *pool = server_pg_pool_create(url);
    enum server_store_outcome outcome = SERVER_STORE_NO_MEMORY;
    if (pool) {
        struct server_pg_attempt attempt = server_pg_reading(pool, PATIENCE_NS);
        while (server_pg_next(&attempt)) attempt.outcome = check_all(attempt.pg, &check);
        outcome = attempt.outcome;
    }
    server_pg_pool_destroy(pool);
    if (outcome)
        fprintf(
            out,
            "the check ended early: the database does not answer, refuses, or memory is short\n");
    if (check.unused)
        fprintf(out,
                "note: %lld objects that no surface has: of uploads under way, or cut short; those "
                "go after a day\n",
                (long long)check.unused);
    fprintf(out, "%u surfaces, %u objects (%llu bytes) verified: %u faults\n", check.surfaces,
            check.objects, check.bytes, check.faults);
    return !outcome && !check.faults;
}
