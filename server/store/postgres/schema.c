/* See store_postgres_schema.h. */
#include "server/store/postgres/schema.h"

/* the advisory lock of who migrates: "geodesicd" in a way */
#define MIGRATING "7307990571216692580"

/* Never changed, only added to. A statement each. */
static const char *const steps[] = {
    "CREATE TABLE clock (one boolean PRIMARY KEY DEFAULT true CHECK (one), version bigint NOT NULL,"
    " forgotten bigint NOT NULL)",
    "INSERT INTO clock (version, forgotten) VALUES (0, 0)",
    "CREATE TABLE objects (id text COLLATE \"C\" PRIMARY KEY, size bigint NOT NULL,"
    " created timestamptz NOT NULL DEFAULT now())",
    "CREATE TABLE chunks (object text COLLATE \"C\" NOT NULL REFERENCES objects ON DELETE CASCADE, "
    "number bigint NOT "
    "NULL,"
    " digest text NOT NULL, bytes bytea NOT NULL, PRIMARY KEY (object, number))",
    /* doubles don't compress: don't try */
    "ALTER TABLE chunks ALTER COLUMN bytes SET STORAGE EXTERNAL",
    "CREATE TABLE surfaces (key text COLLATE \"C\" PRIMARY KEY, version bigint NOT NULL,"
    " file text COLLATE \"C\" REFERENCES objects, attachment text COLLATE \"C\" REFERENCES "
    "objects, record bytea)",
    "CREATE UNIQUE INDEX surfaces_by_version ON surfaces (version)",
    "CREATE INDEX surfaces_by_file ON surfaces (file) WHERE file IS NOT NULL",
    "CREATE INDEX surfaces_by_attachment ON surfaces (attachment) WHERE attachment IS NOT NULL",
    "CREATE INDEX surfaces_gone ON surfaces (version) WHERE record IS NULL",
    /* as batch_queue.c has them for SQLite */
    "CREATE TABLE batches (id text COLLATE \"C\" PRIMARY KEY, tenant text NOT NULL, document bytea "
    "NOT NULL,"
    " etag text NOT NULL, items bigint NOT NULL, created bigint NOT NULL, cancelled bigint NOT "
    "NULL DEFAULT 0)",
    "CREATE TABLE items (batch text COLLATE \"C\" NOT NULL, item bigint NOT NULL, lease bigint NOT "
    "NULL DEFAULT 0,"
    " node text NOT NULL DEFAULT '', attempts bigint NOT NULL DEFAULT 0, status bigint NOT NULL "
    "DEFAULT 0,"
    " answer bytea, PRIMARY KEY (batch, item))",
    "CREATE INDEX items_waiting ON items (batch, item) WHERE status = 0",
};
#define STEPS ((int64_t)(sizeof steps / sizeof *steps))

static bool on_number(void *user, const struct server_sql_value *row)
{
    int64_t *number = user;
    *number = row[0].integer;
    return true;
}

static enum server_store_outcome run(struct server_postgres_connection *connection,
                                     const char *text)
{
    return server_postgres_run(connection, text, NULL, 0, NULL, NULL);
}

/* Only who may make schemas can ask for one that is there already: so it is looked for first. */
static enum server_store_outcome make_schema(struct server_postgres_connection *connection)
{
    int64_t is_there = 0;
    enum server_store_outcome outcome = server_postgres_run(
        connection, "SELECT (to_regclass('geodesicd.migrations') IS NOT NULL)::int::bigint", NULL,
        0, on_number, &is_there);
    if (outcome || is_there) return outcome;
    outcome = run(connection, "CREATE SCHEMA IF NOT EXISTS geodesicd");
    if (outcome) return outcome;
    return run(connection, "CREATE TABLE geodesicd.migrations (version bigint PRIMARY KEY,"
                           " applied timestamptz NOT NULL DEFAULT now())");
}

static enum server_store_outcome make_step(struct server_postgres_connection *connection,
                                           int64_t step)
{
    const struct server_sql_value number = server_sql_integer(step + 1);
    enum server_store_outcome outcome = run(connection, steps[step]);
    if (outcome) return outcome;
    return server_postgres_run(connection, "INSERT INTO migrations (version) VALUES ($1)", &number,
                               1, NULL, NULL);
}

static enum server_store_outcome migrate(struct server_postgres_connection *connection, void *user)
{
    (void)user;
    int64_t version = 0;
    enum server_store_outcome outcome =
        run(connection, "SELECT pg_advisory_xact_lock(" MIGRATING ")");
    if (!outcome) outcome = make_schema(connection);
    if (!outcome)
        outcome =
            server_postgres_run(connection, "SELECT coalesce(max(version), 0) FROM migrations",
                                NULL, 0, on_number, &version);
    if (!outcome && version > STEPS) return SERVER_STORE_PRECONDITION;
    for (int64_t step = version; !outcome && step < STEPS; step++)
        outcome = make_step(connection, step);
    return outcome;
}

enum server_store_outcome server_postgres_migrate(struct server_postgres *postgres)
{
    return server_postgres_transact(postgres, migrate, NULL);
}
