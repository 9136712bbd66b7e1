/* SQL: statements and their values, for SQLite and PostgreSQL alike.
 *
 *     sql->run(sql, SERVER_SQL("UPDATE … WHERE key = $1 AND number = $2",
 *                              SERVER_VALUES(server_sql_text(key), server_sql_integer(n)))); */
#pragma once

#include <string.h>

#include "server/store/store.h"

enum server_sql_type { SERVER_SQL_NULL, SERVER_SQL_INTEGER, SERVER_SQL_TEXT, SERVER_SQL_BYTES };

#define SERVER_SQL_VALUES 12 /* largest number of values of a statement, and of columns of a row */

struct server_sql_value { /* Borrowed. Values of a row are valid until the visit returns. */
    enum server_sql_type type;
    int64_t integer;
    const char *bytes; /* TEXT ends with a NUL */
    size_t size;
};

/* Visits a row. Returns false to end the visit. */
typedef bool server_sql_visit(void *user, const struct server_sql_value *row);

struct server_statement {
    const char *text; /* SQL with the parameters $1, $2, … */
    const struct server_sql_value *values;
    int count;
    server_sql_visit *visit; /* NULL means that the rows are ignored */
    void *user;
};

/* Pointer to a statement; the last members may be left out. */
#define SERVER_SQL(...) (&(const struct server_statement){.text = __VA_ARGS__})

/* A statement's array of values, and their number. */
#define SERVER_VALUES(...)                                                                         \
    ((const struct server_sql_value[]){__VA_ARGS__}),                                              \
        (int)(sizeof((const struct server_sql_value[]){__VA_ARGS__}) /                             \
              sizeof(struct server_sql_value))

static inline struct server_sql_value server_sql_integer(int64_t integer)
{
    return (struct server_sql_value){.type = SERVER_SQL_INTEGER, .integer = integer};
}

/* Returns a text value; NULL means the SQL value NULL. */
static inline struct server_sql_value server_sql_text(const char *text)
{
    if (!text) return (struct server_sql_value){.type = SERVER_SQL_NULL};
    return (struct server_sql_value){.type = SERVER_SQL_TEXT, .bytes = text, .size = strlen(text)};
}

static inline struct server_sql_value server_sql_bytes(const void *bytes, size_t size)
{
    return (struct server_sql_value){.type = SERVER_SQL_BYTES, .bytes = bytes, .size = size};
}

/* The first two integers of the last row. */
struct server_sql_integers {
    unsigned rows;
    int64_t at[2];
};

/* A visitor for which `user` is a struct server_sql_integers. */
static inline bool server_sql_on_integers(void *user, const struct server_sql_value *row)
{
    struct server_sql_integers *integers = user;
    integers->rows++;
    integers->at[0] = row[0].integer;
    integers->at[1] = row[1].integer;
    return true;
}

/* Version and objects of a surface. */
struct server_sql_surface {
    unsigned rows;
    int64_t version;
    char objects[SERVER_PARTS][SERVER_OBJECT]; /* ids; empty means none */
};

/* A visitor of the columns version, file and attachment; `user` is a struct server_sql_surface. */
static inline bool server_sql_on_surface(void *user, const struct server_sql_value *row)
{
    struct server_sql_surface *surface = user;
    surface->rows++;
    surface->version = row[0].integer;
    for (int part = 0; part < SERVER_PARTS; part++)
        if (row[1 + part].type == SERVER_SQL_TEXT)
            snprintf(surface->objects[part], SERVER_OBJECT, "%s", row[1 + part].bytes);
    return true;
}

/* --- a database of the daemon's own, or a shared one ------------------------------------------ */

#define SERVER_SQL_BATCHES "batches.db" /* the file of batches in a data folder */

/* Thread-safe; calls may block for disk or network. Each statement is a transaction. After a lost
 * connection the statement is repeated, so repetition must be harmless. */
struct server_store_sql {
    /* Runs a statement. Returns DONE, UNAVAILABLE, FULL, NO_MEMORY, REFUSED or READ_ONLY. */
    enum server_outcome (*run)(struct server_store_sql *sql,
                               const struct server_statement *statement);
    bool is_shared; /* true if several daemons share the database */
    /* The end of a statement that locks rows and skips rows that others have locked. Empty for
       SQLite. */
    const char *skip_locked;
    void (*close)(struct server_store_sql *sql); /* frees it */
};

/* Opens a SQLite file, and creates it if it is missing. The path ":memory:" opens a database in
 * memory. `steps` are the statements that make the tables; static and NULL-terminated. The file's
 * version is the number of its steps. If the file turns out to be damaged, now or later, it is
 * renamed, and an empty file replaces it. On failure, returns NULL with a sentence in `error`.
 * Refuses a file that a later version of the daemon wrote, and leaves it unchanged. */
struct server_store_sql *server_store_sql_local_open(const char *path, const char *const *steps,
                                                     char error[SERVER_ERROR]);

/* Opens the database of a PostgreSQL store. The store has already made the tables. Returns NULL if
 * out of memory. */
struct server_store_sql *server_store_sql_postgres_open(const char *url);
