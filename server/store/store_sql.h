/* Statements for a database that the daemon has to itself (SQLite), or shares with others
 * (PostgreSQL): the same text for both, which each statement is to be true for by itself, and
 * harmless to repeat: it may be run again when a connection was lost.
 *
 * Parameters are $1, $2, …; each stands at least once. Thread-safe. By threads that may wait for a
 * disk or a network. */
#ifndef SERVER_STORE_STORE_SQL_H
#define SERVER_STORE_STORE_SQL_H

#include "server/store/sql.h"
#include "server/store/store.h"

struct server_store_sql {
    /* Runs a statement, and shows its rows once it is done. Outcomes as a store's: DONE,
     * UNAVAILABLE, FULL, NO_MEMORY, REFUSED, READ_ONLY. */
    enum server_store_outcome (*run)(struct server_store_sql *sql, const char *text,
                                     const struct server_sql_value *values, int count,
                                     server_sql_visit *visit, void *user);
    bool is_shared; /* with other daemons */
    /* What a statement ends with that takes rows which others may be taking at the same time: "" or
     * " FOR UPDATE … SKIP LOCKED". */
    const char *skip_locked;
    void (*close)(struct server_store_sql *sql); /* frees it */
};

/* In that file, which is made if need be; ":memory:": in none. `steps`: NULL-terminated statements
 * that make the tables, harmless to repeat; static. A damaged file is set aside, now or whenever a
 * statement meets damage, and an empty one takes its place. NULL with a sentence. */
struct server_store_sql *server_store_sql_local_open(const char *path, const char *const *steps,
                                                     char *error, size_t error_size);

/* In the database of a PostgreSQL store, which has made the tables. NULL without memory. */
struct server_store_sql *server_store_sql_postgres_open(const char *url);

#endif
