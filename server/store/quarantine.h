/* Quarantine: the objects of a store that were read and found damaged. Nobody reads them again, so
 * that a surface whose file is damaged is refused at once, until the file is written anew or gone.
 *
 * Who reads an object asks for the turn before, and condemns by it: a file that was written
 * meanwhile is not condemned for what it was. Thread-safe. */
#ifndef SERVER_STORE_QUARANTINE_H
#define SERVER_STORE_QUARANTINE_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#include "server/store/record.h"

struct server_condemned;

struct server_quarantine {
    pthread_mutex_t lock;
    struct server_condemned *first;
    uint32_t count;
    uint64_t turn; /* how often one was lifted */
};

void server_quarantine_init(struct server_quarantine *quarantine);
void server_quarantine_clear(struct server_quarantine *quarantine); /* the end of it */

uint64_t server_quarantine_turn(struct server_quarantine *quarantine);

/* False: something was written since the turn, or there is no memory; the object will be read
 * again, and found damaged. */
bool server_quarantine_condemn(struct server_quarantine *quarantine, const char *object,
                               uint64_t turn);

/* The object is written anew, or gone. */
void server_quarantine_lift(struct server_quarantine *quarantine, const char *object);

/* O(damaged objects), which are few. */
bool server_quarantine_holds(struct server_quarantine *quarantine, const char *object);
uint32_t server_quarantine_count(struct server_quarantine *quarantine);

#endif
