/* Connection: one to PostgreSQL, that never waits without a bound; the inside of postgres.h. Used
 * by one thread at a time. */
#ifndef SERVER_STORE_POSTGRES_CONNECTION_H
#define SERVER_STORE_POSTGRES_CONNECTION_H

#include <postgresql/libpq-fe.h>

#include "server/store/postgres/transactions.h"

struct server_postgres_connection {
    PGconn *link;
    bool is_lost;        /* nothing more comes of it */
    uint64_t longest_ns; /* that a statement may take */
    struct server_postgres_connection *next;
    char error[SERVER_POSTGRES_ERROR];
};

/* Connects within a time, and says what every session is to have. UNAVAILABLE or NO_MEMORY with a
 * line in `error`. */
enum server_store_outcome server_postgres_connect(const char *url,
                                                  struct server_postgres_connection **out,
                                                  char error[SERVER_POSTGRES_ERROR]);
void server_postgres_disconnect(struct server_postgres_connection *connection);

#endif
