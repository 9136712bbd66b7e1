/* SQL: values that go into a statement, and come out of its rows, whatever database runs it.
 *
 *     const struct server_sql_value values[] = {server_sql_text(key), server_sql_integer(version)};
 *     server_postgres_run(connection, "UPDATE … WHERE key = $1 AND version = $2", values, 2, NULL,
 * NULL);
 */
#ifndef SERVER_STORE_SQL_H
#define SERVER_STORE_SQL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum server_sql_type { SERVER_SQL_NULL, SERVER_SQL_INTEGER, SERVER_SQL_TEXT, SERVER_SQL_BYTES };

#define SERVER_SQL_VALUES 12 /* most of a statement, and of a row */

struct server_sql_value { /* borrowed; a row's, for the time of a visit */
    enum server_sql_type type;
    int64_t integer;
    const char *bytes; /* of TEXT with a NUL behind them */
    size_t size;
};

/* Is told of a row; false ends the visit. */
typedef bool server_sql_visit(void *user, const struct server_sql_value *row);

static inline struct server_sql_value server_sql_integer(int64_t integer)
{
    return (struct server_sql_value){.type = SERVER_SQL_INTEGER, .integer = integer};
}

/* NULL: no value. */
static inline struct server_sql_value server_sql_text(const char *text)
{
    if (!text) return (struct server_sql_value){.type = SERVER_SQL_NULL};
    return (struct server_sql_value){.type = SERVER_SQL_TEXT, .bytes = text, .size = strlen(text)};
}

static inline struct server_sql_value server_sql_bytes(const void *bytes, size_t size)
{
    return (struct server_sql_value){.type = SERVER_SQL_BYTES, .bytes = bytes, .size = size};
}

#endif
