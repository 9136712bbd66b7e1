/* Quarantine: ids of damaged objects. fetch refuses them without reading until the file is written
 * again or removed.
 *
 * A reader takes the turn first and passes it to condemn, so that a file that was rewritten
 * meanwhile is not condemned for its old bytes. Thread-safe. O(damaged objects), which are few. */
#ifndef SERVER_STORE_LOCAL_QUARANTINE_H
#define SERVER_STORE_LOCAL_QUARANTINE_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#include "server/store/record.h"

struct server_quarantine {
    pthread_mutex_t lock;
    struct server_condemned *first;
    uint32_t count;
    uint64_t turn; /* number of lifts */
};

void server_quarantine_init(struct server_quarantine *quarantine);
void server_quarantine_clear(struct server_quarantine *quarantine); /* frees what it holds */

uint64_t server_quarantine_turn(struct server_quarantine *quarantine);

/* False: something was lifted since the turn, or there is no memory. The next reader condemns. */
bool server_quarantine_condemn(struct server_quarantine *quarantine, const char *object,
                               uint64_t turn);

/* The object was written again, or removed. */
void server_quarantine_lift(struct server_quarantine *quarantine, const char *object);

bool server_quarantine_holds(struct server_quarantine *quarantine, const char *object);
uint32_t server_quarantine_count(struct server_quarantine *quarantine);

#endif
