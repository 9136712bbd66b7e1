/* See store_sql.h. */
#include <stdlib.h>

#include "server/store/postgres/transactions.h"
#include "server/store/store_sql.h"

#define PATIENCE_NS UINT64_C(5000000000)

struct sql_postgres {
    struct server_store_sql sql; /* first */
    struct server_postgres *postgres;
};

struct statement {
    const char *text;
    const struct server_sql_value *values;
    int count;
    server_sql_visit *visit;
    void *user;
};

static enum server_store_outcome run_statement(struct server_postgres_connection *connection,
                                               void *user)
{
    const struct statement *statement = user;
    return server_postgres_run(connection, statement->text, statement->values, statement->count,
                               statement->visit, statement->user);
}

static enum server_store_outcome run(struct server_store_sql *sql, const char *text,
                                     const struct server_sql_value *values, int count,
                                     server_sql_visit *visit, void *user)
{
    struct statement statement = {text, values, count, visit, user};
    return server_postgres_read(((struct sql_postgres *)sql)->postgres, PATIENCE_NS, run_statement,
                                &statement);
}

static void close_sql(struct server_store_sql *sql)
{
    server_postgres_destroy(((struct sql_postgres *)sql)->postgres);
    free(sql);
}

struct server_store_sql *server_store_sql_postgres_open(const char *url)
{
    struct sql_postgres *own = calloc(1, sizeof *own);
    if (!own) return NULL;
    own->sql = (struct server_store_sql){.run = run,
                                         .is_shared = true,
                                         .skip_locked = " FOR UPDATE OF i SKIP LOCKED",
                                         .close = close_sql};
    own->postgres = server_postgres_create(url);
    if (own->postgres) return &own->sql;
    free(own);
    return NULL;
}
