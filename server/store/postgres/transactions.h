/* Postgres: connections to a PostgreSQL database, and what is run on them. Who stores what there:
 * store_postgres.c.
 *
 *     static enum server_store_outcome body(struct server_postgres_connection *connection, void
 * *user)
 *     {
 *         return server_postgres_run(connection, "UPDATE …", values, 2, NULL, NULL);
 *     }
 *     outcome = server_postgres_transact(postgres, body, user);
 *
 * DESIGN. A few connections, each used by one thread at a time, are opened when they are needed and
 * kept. Nothing waits without a bound: each statement, and each connecting, has a deadline; a
 * connection that missed one is closed.
 *
 * A transaction whose connection is lost, or that others got in the way of, is begun anew, with
 * pauses that grow, for PATIENCE in all. If the connection is lost while it commits, it is not
 * known whether it has: then the server is asked on another connection what became of the
 * transaction, by its number, which was asked for before; so that no transaction is lost, and none
 * is done twice.
 *
 * When no connection can be made the database is away: from then on whoever wants one is refused at
 * once, except a prober (the store's follower), whose connecting tells that the database is back.
 *
 * By worker threads and threads of their own, never by those that speak HTTP. Thread-safe. The
 * password is never printed: what libpq says does not have it. */
#ifndef SERVER_STORE_POSTGRES_TRANSACTIONS_H
#define SERVER_STORE_POSTGRES_TRANSACTIONS_H

#include "server/store/sql.h"
#include "server/store/store.h"

#define SERVER_POSTGRES_ERROR 400

struct server_postgres;
struct server_postgres_connection;

/* Copies the address ("postgresql://user@host/database?…", as libpq reads it). Connects to nothing
 * as yet. NULL without memory. */
struct server_postgres *server_postgres_create(const char *url);
/* all connections are given back; NULL is harmless */
void server_postgres_destroy(struct server_postgres *postgres);

/* A connection: an idle one, or a new one. UNAVAILABLE: there is none, or none within a time;
 * NO_MEMORY. `is_prober`: it is tried even if the database is away. What went wrong is in `error`
 * (SERVER_POSTGRES_ERROR bytes; may be NULL). */
enum server_store_outcome server_postgres_take(struct server_postgres *postgres, bool is_prober,
                                               struct server_postgres_connection **out,
                                               char *error);

/* Gives it back; one that is of no use any more is closed. */
void server_postgres_give(struct server_postgres *postgres,
                          struct server_postgres_connection *connection);

/* True from the failure of a connecting to the next success, or until somebody has seen that the
 * database answers. */
bool server_postgres_is_away(struct server_postgres *postgres);
void server_postgres_has_answered(struct server_postgres *postgres);

/* Runs one statement and shows its rows. UNAVAILABLE: the connection is lost, or late; STALE:
 * others got in the way, and the transaction is to be begun anew; FULL; NO_MEMORY; REFUSED:
 * anything else, which the connection's error tells. */
enum server_store_outcome server_postgres_run(struct server_postgres_connection *connection,
                                              const char *text,
                                              const struct server_sql_value *values, int count,
                                              server_sql_visit *visit, void *user);

/* Why the last statement that failed did, a line; lives as long as the connection. */
const char *server_postgres_error(const struct server_postgres_connection *connection);

typedef enum server_store_outcome
server_postgres_body(struct server_postgres_connection *connection, void *user);

/* Has the body run within a transaction, which is committed if it answers DONE, and rolled back
 * else. It may be called several times: what it leaves in `user` is to be of its last call. STALE
 * means that it is to begin anew; to end with another's change, it says PRECONDITION. UNAVAILABLE:
 * nothing was changed, or it can't be known for now whether it was. */
enum server_store_outcome server_postgres_transact(struct server_postgres *postgres,
                                                   server_postgres_body *body, void *user);

/* Has the body run, statement by statement, without a transaction; again when the connection is
 * lost, as long as there is patience, which each statement has, too. */
enum server_store_outcome server_postgres_read(struct server_postgres *postgres,
                                               uint64_t patience_ns, server_postgres_body *body,
                                               void *user);

/* Waits so long, or until somebody has notified the channel that the connection listens to. False:
 * the connection is lost. */
bool server_postgres_await(struct server_postgres_connection *connection, uint64_t ns);

#endif
