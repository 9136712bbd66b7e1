/* See store.h: --check-store of a PostgreSQL store. */
#include <stdlib.h>

#include "server/store/postgres/connection.h"

#define PATIENCE_NS UINT64_C(60000000000) /* deadline of a statement */

struct check {
    FILE *out;
    struct server_record *record; /* record of the current row; NULL means damaged */
    char last[SERVER_KEY_TEXT];   /* its key */
    uint32_t faults, surfaces, objects;
    unsigned long long bytes;
};

static void pg_check_fault(struct check *check, const char *what)
{
    fprintf(check->out, "fault: %s: %s\n", what, check->last);
    check->faults++;
}

static bool pg_check_row(void *user, const struct server_sql_value *row)
{
    struct check *check = user;
    snprintf(check->last, sizeof check->last, "%s", row[0].bytes);
    check->surfaces++;
    if (server_record_read(check->last, row[1].bytes, row[1].size, &check->record))
        pg_check_fault(check, "its row is damaged, or of a later version");
    return true;
}

static enum server_outcome pg_check_object(struct server_pg *pg, struct check *check,
                                           const struct server_object *object)
{
    void *bytes = malloc(object->size ? object->size : 1);
    if (!bytes) return SERVER_STORE_NO_MEMORY;
    enum server_outcome outcome = server_pg_read_object(pg, object, bytes);
    free(bytes);
    check->objects++;
    check->bytes += object->size;
    if (outcome == SERVER_STORE_ABSENT) pg_check_fault(check, "its bytes are missing");
    if (outcome == SERVER_STORE_DAMAGED)
        pg_check_fault(check, "its bytes are damaged: their SHA-256 differs");
    return outcome == SERVER_STORE_ABSENT || outcome == SERVER_STORE_DAMAGED ? SERVER_STORE_DONE
                                                                             : outcome;
}

/* Checks the surface after the last checked one. Returns ABSENT if there is none. */
static enum server_outcome pg_check_next(struct server_pg *pg, struct check *check)
{
    uint32_t before = check->surfaces;
    check->record = NULL;
    enum server_outcome outcome = server_pg_run(
        pg, SERVER_SQL("SELECT key, record FROM surfaces WHERE key > $1"
                       " AND record IS NOT NULL ORDER BY key LIMIT 1",
                       SERVER_VALUES(server_sql_text(check->last)), pg_check_row, check));
    for (int part = 0; check->record && !outcome && part < SERVER_PARTS; part++)
        if (check->record->objects[part].id[0])
            outcome = pg_check_object(pg, check, &check->record->objects[part]);
    server_record_release(check->record);
    return outcome || check->surfaces != before ? outcome : SERVER_STORE_ABSENT;
}

static enum server_outcome pg_check_all(struct server_pg *pg, struct check *check,
                                        struct server_sql_integers *unused)
{
    enum server_outcome outcome;
    do outcome = pg_check_next(pg, check);
    while (!outcome);
    if (outcome != SERVER_STORE_ABSENT) return outcome;
    return server_pg_run(pg, SERVER_SQL("SELECT count(*) FROM objects WHERE " SERVER_PG_UNUSED,
                                        NULL, 0, server_sql_on_integers, unused));
}

bool server_store_check_postgres(const char *url, FILE *out)
{
    struct check check = {.out = out};
    struct server_sql_integers unused = {0};
    struct server_pg_pool *pool = server_pg_pool_create(url);
    enum server_outcome outcome = SERVER_STORE_NO_MEMORY;
    if (pool) {
        struct server_pg_attempt attempt = server_pg_reading(pool, PATIENCE_NS);
        while (server_pg_next(&attempt))
            attempt.outcome = pg_check_all(attempt.pg, &check, &unused);
        outcome = attempt.outcome;
    }
    server_pg_pool_destroy(pool);
    if (outcome)
        fprintf(
            out,
            "the check ended early: the database does not answer, refuses, or memory is short\n");
    if (unused.at[0])
        fprintf(out,
                "note: %lld objects belong to no surface: their uploads are under way or were "
                "interrupted; the daemon deletes them after a day\n",
                (long long)unused.at[0]);
    fprintf(out, "%u surfaces, %u objects (%llu bytes) verified: %u faults\n", check.surfaces,
            check.objects, check.bytes, check.faults);
    return !outcome && !check.faults;
}
