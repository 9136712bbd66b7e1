/* Connections to a PostgreSQL database, statements and transactions.
 *
 *     struct server_pg_attempt attempt = server_pg_transaction(pool);
 *     while (server_pg_next(&attempt))
 *         attempt.outcome = server_pg_run(attempt.pg, SERVER_SQL("UPDATE …", values, 2));
 *     return attempt.outcome;
 *
 * DESIGN. A pool has few connections. They are opened on demand, and each is used by one thread at
 * a time. Every wait is limited: statements and connects have deadlines, and a connection that
 * misses a deadline is closed.
 *
 * A transaction whose connection is lost, or that conflicts with another, is retried with growing
 * pauses for a few seconds. If the connection is lost during COMMIT, the outcome is unknown. Then
 * another connection queries the status of the transaction by its number. So no transaction is
 * lost, and none is applied twice.
 *
 * After a failed connect the database is *away*: transactions fail at once. Only
 * server_pg_pool_take, which the store's follower calls, still connects. So it detects when the
 * database is reachable again.
 *
 * Thread-safe, but calls block, so HTTP threads must not make them. Messages of libpq omit the
 * password. */
#pragma once

#include "server/store/sql.h"

#define SERVER_PG_ERROR 400 /* bytes of a message */

struct server_pg_pool;
struct server_pg;

/* Creates a pool. Copies the address ("postgresql://user@host/database?…"); does not connect yet.
 * Returns NULL if out of memory. */
struct server_pg_pool *server_pg_pool_create(const char *url);
/* Call this function after all connections were given back. NULL is allowed. */
void server_pg_pool_destroy(struct server_pg_pool *pool);

/* Takes an idle connection or opens a new one, even if the database is away. Errors have a
 * message. */
enum server_outcome server_pg_pool_take(struct server_pg_pool *pool, struct server_pg **out,
                                        char error[SERVER_PG_ERROR]);
/* Returns a connection to the pool. Closes the connection if it is lost. */
void server_pg_pool_give(struct server_pg_pool *pool, struct server_pg *pg);

/* server_pg_pool_is_away returns true if the last connect failed and server_pg_pool_has_answered
 * was not called since. */
bool server_pg_pool_is_away(struct server_pg_pool *pool);
void server_pg_pool_has_answered(struct server_pg_pool *pool);

/* Runs one statement. Errors: UNAVAILABLE (the connection is lost or missed the deadline), STALE (a
 * conflict; retry the transaction), FULL, NO_MEMORY, REFUSED (any other error). */
enum server_outcome server_pg_run(struct server_pg *pg, const struct server_statement *statement);

/* The attempts at a transaction, or at reads without a transaction. The body of the loop may run
 * several times. */
struct server_pg_attempt {
    struct server_pg *pg; /* the connection of this attempt */
    /* the loop's body sets the outcome of an attempt; after the loop this is the outcome of all
       attempts */
    enum server_outcome outcome;
    struct server_pg_pool *pool; /* this and the rest are private */
    bool is_transaction;
    uint64_t patience_ns, longest_ns; /* limits of all attempts, and of one statement */
    uint64_t until_ns, pause_ns;
    int64_t number; /* number of the transaction whose COMMIT was not answered; 0 means none */
    char error[SERVER_PG_ERROR];
};

/* The body of the loop sets the outcome: DONE commits the transaction, STALE retries it, and
 * PRECONDITION ends it because another daemon made a change. UNAVAILABLE after the loop means that
 * nothing changed, or that it is unknown whether the change was made. */
struct server_pg_attempt server_pg_transaction(struct server_pg_pool *pool);

/* Begins attempts without a transaction. They are repeated if the connection is lost, for at most
 * `patience_ns`, which is also the deadline of each statement. */
struct server_pg_attempt server_pg_reading(struct server_pg_pool *pool, uint64_t patience_ns);

/* Ends an attempt and begins the next one. Returns false at the end of the loop; the loop must not
 * end earlier. */
bool server_pg_next(struct server_pg_attempt *attempt);

/* Blocks for `ns` nanoseconds, or until a notification arrives. Returns false if the connection is
 * lost. */
bool server_pg_await(struct server_pg *pg, uint64_t ns);

/* --- objects: files and attachments (record.h) as rows of a MiB each -------------------------- */
/* Call these functions in the loop of a transaction or a reading. They return the outcomes of
 * server_pg_run. */

/* Writes the chunks that are missing or damaged; the database verifies the others. */
enum server_outcome server_pg_write_object(struct server_pg *pg, const struct server_object *object,
                                           const void *bytes);

/* Reads and verifies the object. `bytes` has the object's size. Also returns ABSENT and DAMAGED. */
enum server_outcome server_pg_read_object(struct server_pg *pg, const struct server_object *object,
                                          void *bytes);

/* Makes the database verify one chunk, and sets *size to the chunk's size. Also returns ABSENT and
 * DAMAGED. */
enum server_outcome server_pg_check_chunk(struct server_pg *pg, const struct server_object *object,
                                          uint64_t number, size_t *size);

/* The SQL condition that no surface has the object `id`. */
#define SERVER_PG_UNUSED                                                                           \
    "NOT EXISTS (SELECT FROM surfaces WHERE file = id)"                                            \
    " AND NOT EXISTS (SELECT FROM surfaces WHERE attachment = id)"

/* Returns the number of chunks of the object. */
uint64_t server_pg_chunks(const struct server_object *object);

/* Makes or migrates the tables, one process at a time. Returns PRECONDITION if a later version of
 * the daemon made them. */
enum server_outcome server_pg_migrate(struct server_pg_pool *pool);
