/* PostgreSQL store: its inside, which changing, reading (store_postgres.c) and following
 * (store_postgres_following.c) share. See store.h. */
#ifndef SERVER_STORE_POSTGRES_POSTGRES_STORE_H
#define SERVER_STORE_POSTGRES_POSTGRES_STORE_H

#include "server/store/postgres/transactions.h"
#include "server/store/store.h"

#define SERVER_STORE_POSTGRES_CHANNEL "geodesicd" /* is notified of each change */
/* to read what a surface, or a start, needs */
#define SERVER_STORE_POSTGRES_LOAD_NS UINT64_C(8000000000)

struct server_store_postgres {
    struct server_store store; /* first */
    struct server_postgres *postgres;
    struct server_postgres_connection *listener; /* of await's thread; NULL: none as yet */
    uint64_t seen;     /* up to this version all changes were shown; under the follower's lock */
    bool was_away;     /* of await's thread, as the next */
    uint64_t swept_ns; /* when objects that nobody has were last dropped */
};

static inline struct server_store_postgres *server_store_postgres_of(struct server_store *store)
{
    return (struct server_store_postgres *)store;
}

/* The store's `each`, `follow` and `await` (store.h). */
enum server_store_outcome
server_store_postgres_each(struct server_store *store,
                           bool (*visit)(void *user, const struct server_stored *stored),
                           void *user);
enum server_store_outcome
server_store_postgres_follow(struct server_store *store,
                             bool (*visit)(void *user, const struct server_store_change *change),
                             void *user);
void server_store_postgres_await(struct server_store *store, uint64_t ns);

/* Does nothing for a while, that the database may come back. */
void server_store_postgres_rest(uint64_t ns);

#endif
