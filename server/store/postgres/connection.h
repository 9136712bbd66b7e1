/* Connections to a PostgreSQL database, statements and transactions.
 *
 *     struct server_pg_attempt attempt = server_pg_transaction(pool);
 *     while (server_pg_next(&attempt))
 *         attempt.outcome = server_pg_run(attempt.pg, SERVER_SQL("UPDATE …", values, 2));
 *     return attempt.outcome;
 *
 * DESIGN. A pool has few connections, opened on demand, each used by one thread at a time. Every
 * wait is bounded: statements and connects have deadlines, and a connection that misses one is
 * closed.
 *
 * A transaction whose connection is lost, or that conflicts with another, is retried with growing
 * pauses for a few seconds. If the connection is lost during COMMIT, the outcome is unknown. Then
 * another connection queries the status of the transaction by its number. So no transaction is
 * lost, and none is applied twice.
 *
 * After a failed connect the database is *away*: transactions fail at once. Only
 * server_pg_pool_take, which the store's follower calls, still connects, and so detects that the
 * database is back.
 *
 * Thread-safe, but calls block, so never in HTTP threads. Messages of libpq omit the password. */
#ifndef SERVER_STORE_POSTGRES_CONNECTION_H
#define SERVER_STORE_POSTGRES_CONNECTION_H

#include "server/store/sql.h"

#define SERVER_PG_ERROR 400 /* bytes of a message */

struct server_pg_pool;
struct server_pg;

/* Copies the address ("postgresql://user@host/database?…"). Connects later. Returns NULL if out of
 * memory. */
struct server_pg_pool *server_pg_pool_create(const char *url);
/* Call this function after all connections were given back. NULL is allowed. */
void server_pg_pool_destroy(struct server_pg_pool *pool);

/* Takes an idle connection or opens one, even if the database is away. Errors have a message. */
enum server_outcome server_pg_pool_take(struct server_pg_pool *pool, struct server_pg **out,
                                        char error[SERVER_PG_ERROR]);
/* Gives a connection back. Closes it if it is lost. */
void server_pg_pool_give(struct server_pg_pool *pool, struct server_pg *pg);

/* is_away returns whether the last connect failed and has_answered has not been called since. */
bool server_pg_pool_is_away(struct server_pg_pool *pool);
void server_pg_pool_has_answered(struct server_pg_pool *pool);

/* Runs one statement. UNAVAILABLE: the connection is lost or missed the deadline; STALE: a
 * conflict, retry the transaction; FULL; NO_MEMORY; REFUSED: any other error. */
enum server_outcome server_pg_run(struct server_pg *pg, const struct server_statement *statement);

/* The attempts at a transaction or a reading. The body of the loop may run several times. */
struct server_pg_attempt {
    struct server_pg *pg;        /* the connection of this attempt */
    enum server_outcome outcome; /* set by the loop after an attempt; at the end, of all attempts */
    struct server_pg_pool *pool; /* this and the rest are private */
    bool is_transaction;
    uint64_t patience_ns, longest_ns; /* limits of all attempts, and of one statement */
    uint64_t until_ns, pause_ns;
    int64_t number; /* number of a transaction whose COMMIT has no answer; 0: none */
    char error[SERVER_PG_ERROR];
};

/* The loop sets the outcome: DONE commits the transaction, STALE retries it, and PRECONDITION ends
 * it because another daemon made a change. UNAVAILABLE at the end: nothing changed, or it is
 * unknown whether the change was made. */
struct server_pg_attempt server_pg_transaction(struct server_pg_pool *pool);

/* Attempts without a transaction, repeated if the connection is lost, for `patience_ns` at most,
 * which is also the deadline of each statement. */
struct server_pg_attempt server_pg_reading(struct server_pg_pool *pool, uint64_t patience_ns);

/* Ends an attempt and begins the next. False: the end of the loop, which must not end earlier. */
bool server_pg_next(struct server_pg_attempt *attempt);

/* Blocks for `ns`, or until a notification that the connection listens to. False: it is lost. */
bool server_pg_await(struct server_pg *pg, uint64_t ns);

/* --- objects: files and attachments (record.h) as rows of a MiB each -------------------------- */
/* Each function is part of a transaction or a reading, and returns the outcomes of
 * server_pg_run. */

/* Writes the chunks that are missing or damaged; the database verifies the others. */
enum server_outcome server_pg_write_object(struct server_pg *pg, const struct server_object *object,
                                           const void *bytes);

/* Reads and verifies the object. `bytes` has its size. ABSENT; DAMAGED. */
enum server_outcome server_pg_read_object(struct server_pg *pg, const struct server_object *object,
                                          void *bytes);

/* Makes the database verify one chunk, and returns the chunk's size. ABSENT; DAMAGED. */
enum server_outcome server_pg_check_chunk(struct server_pg *pg, const struct server_object *object,
                                          uint64_t number, size_t *size);

/* Returns the number of chunks of the object. */
uint64_t server_pg_chunks(const struct server_object *object);

/* Makes or migrates the tables, one process at a time. PRECONDITION: a later version made them. */
enum server_outcome server_pg_migrate(struct server_pg_pool *pool);

#endif
