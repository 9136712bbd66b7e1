/* See connection.h: the tables of a PostgreSQL store, in the schema `geodesicd`.
 *
 *     migrations  version                     of each step that was made
 *     clock       version, forgotten          one row: the version of the last change; removals up
 *                                             to `forgotten` are no longer listed
 *     objects     id, size, created           files and attachments (record.h), immutable
 *     chunks      object, number, digest,     the bytes of an object, a MiB each, with a SHA-256
 *                 bytes
 *     surfaces    key, version, file,         a surface; removed if it has no record
 *                 attachment, record
 *     batches, items                          see batch_queue.h
 *
 * A change first locks the clock's row, and holds this lock until it commits. So versions are
 * committed in order: a reader that has seen a version has seen all smaller versions. */
#include "server/store/postgres/connection.h"

/* number of the advisory lock of migrations, chosen at random */
#define MIGRATING "7307990571216692580"

/* Each step is one statement. New steps are added at the end; old steps never change. */
static const char *const steps[] = {
    "CREATE TABLE clock (one boolean PRIMARY KEY DEFAULT true CHECK (one), version bigint NOT NULL,"
    " forgotten bigint NOT NULL)",
    "INSERT INTO clock (version, forgotten) VALUES (0, 0)",
    "CREATE TABLE objects (id text COLLATE \"C\" PRIMARY KEY, size bigint NOT NULL,"
    " created timestamptz NOT NULL DEFAULT now())",
    "CREATE TABLE chunks (object text COLLATE \"C\" NOT NULL REFERENCES objects ON DELETE CASCADE,"
    " number bigint NOT NULL, digest text NOT NULL, bytes bytea NOT NULL,"
    " PRIMARY KEY (object, number))",
    /* without compression, because doubles hardly compress */
    "ALTER TABLE chunks ALTER COLUMN bytes SET STORAGE EXTERNAL",
    "CREATE TABLE surfaces (key text COLLATE \"C\" PRIMARY KEY, version bigint NOT NULL,"
    " file text COLLATE \"C\" REFERENCES objects, attachment text COLLATE \"C\" REFERENCES objects,"
    " record bytea)",
    "CREATE UNIQUE INDEX surfaces_by_version ON surfaces (version)",
    "CREATE INDEX surfaces_by_file ON surfaces (file) WHERE file IS NOT NULL",
    "CREATE INDEX surfaces_by_attachment ON surfaces (attachment) WHERE attachment IS NOT NULL",
    "CREATE INDEX surfaces_gone ON surfaces (version) WHERE record IS NULL",
    /* as in batch_queue.c for SQLite */
    "CREATE TABLE batches (id text COLLATE \"C\" PRIMARY KEY, tenant text NOT NULL,"
    " document bytea NOT NULL, etag text NOT NULL, items bigint NOT NULL, created bigint NOT NULL,"
    " cancelled bigint NOT NULL DEFAULT 0)",
    "CREATE TABLE items (batch text COLLATE \"C\" NOT NULL, item bigint NOT NULL,"
    " lease bigint NOT NULL DEFAULT 0, node text NOT NULL DEFAULT '',"
    " attempts bigint NOT NULL DEFAULT 0, status bigint NOT NULL DEFAULT 0, answer bytea,"
    " PRIMARY KEY (batch, item))",
    "CREATE INDEX items_waiting ON items (batch, item) WHERE status = 0",
    "ALTER TABLE items ADD COLUMN number bigint NOT NULL DEFAULT 0",
    "UPDATE items SET number = counted.number FROM (SELECT batch, item, row_number()"
    " OVER (PARTITION BY batch ORDER BY item) AS number FROM items WHERE status > 0) AS counted"
    " WHERE items.batch = counted.batch AND items.item = counted.item",
    "CREATE UNIQUE INDEX items_answered ON items (batch, number) WHERE number > 0",
    "CREATE INDEX items_failed ON items (batch, status) WHERE status >= 400",
};
#define STEPS ((int64_t)(sizeof steps / sizeof *steps))

/* Creates the schema if it does not exist. Tests this first, because CREATE … IF NOT EXISTS always
 * needs the right to create. */
static enum server_outcome schema_make(struct server_pg *pg)
{
    struct server_sql_integers is_there = {0};
    enum server_outcome outcome = server_pg_run(
        pg, SERVER_SQL("SELECT (to_regclass('geodesicd.migrations') IS NOT NULL)::int::bigint",
                       NULL, 0, server_sql_on_integers, &is_there));
    if (outcome || is_there.at[0]) return outcome;
    outcome = server_pg_run(pg, SERVER_SQL("CREATE SCHEMA IF NOT EXISTS geodesicd"));
    if (outcome) return outcome;
    return server_pg_run(pg,
                         SERVER_SQL("CREATE TABLE geodesicd.migrations (version bigint PRIMARY KEY,"
                                    " applied timestamptz NOT NULL DEFAULT now())"));
}

static enum server_outcome schema_migrate(struct server_pg *pg)
{
    struct server_sql_integers version = {0};
    enum server_outcome outcome =
        server_pg_run(pg, SERVER_SQL("SELECT pg_advisory_xact_lock(" MIGRATING ")"));
    if (!outcome) outcome = schema_make(pg);
    if (!outcome)
        outcome = server_pg_run(pg, SERVER_SQL("SELECT coalesce(max(version), 0) FROM migrations",
                                               NULL, 0, server_sql_on_integers, &version));
    if (!outcome && version.at[0] > STEPS) return SERVER_STORE_PRECONDITION;
    for (int64_t step = version.at[0]; !outcome && step < STEPS; step++) {
        outcome = server_pg_run(pg, SERVER_SQL(steps[step]));
        if (!outcome)
            outcome = server_pg_run(pg, SERVER_SQL("INSERT INTO migrations (version) VALUES ($1)",
                                                   SERVER_VALUES(server_sql_integer(step + 1))));
    }
    return outcome;
}

enum server_outcome server_pg_migrate(struct server_pg_pool *pool)
{
    struct server_pg_attempt attempt = server_pg_transaction(pool);
    while (server_pg_next(&attempt)) attempt.outcome = schema_migrate(attempt.pg);
    return attempt.outcome;
}
