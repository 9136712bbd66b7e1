/* LRU: a list of results that can be computed again. The results stay in memory while the budget
 * has room. The least recently used results are evicted first.
 *
 * DESIGN. An item is the first member of a result's own struct. An item is reference-counted, and
 * the budget counts it in the list's class until the last release. A *place* is the owner's pointer
 * to an item in the list. When the item is evicted, its place is set to NULL. One mutex guards the
 * list and the places. The owner may guard other data with this mutex too. No item is freed under
 * the mutex. The budget's reclaimer locks the mutex, so a thread that holds it must not take memory
 * from the budget. */
#pragma once

#include <pthread.h>
#include <sys/queue.h>

#include "server/work/budget.h"

struct server_lru;

struct server_lru_item {
    atomic_uint references;
    struct server_lru *lru;
    size_t bytes;
    /* guarded by the lock, used while the item is in the list: */
    struct server_lru_item **place;
    TAILQ_ENTRY(server_lru_item) by_use;
};

struct server_lru { /* the owner sets the first members */
    struct server_budget *budget;
    enum server_budget_class class;
    enum server_reclaim_turn turn;
    void (*free)(struct server_lru_item *item);
    /* this function is called under the lock after an eviction; may be NULL */
    void (*evicted)(struct server_lru *lru, struct server_lru_item **place);
    pthread_mutex_t lock;
    TAILQ_HEAD(, server_lru_item) by_use; /* the items, beginning with the least recently used */
    atomic_uint pressures;                /* number of times that memory was short */
};

/* server_lru_begin registers the list as a reclaimer of the budget. server_lru_end unregisters the
 * list, whose places must then all be empty. */
void server_lru_begin(struct server_lru *lru);
void server_lru_end(struct server_lru *lru);

/* Begins an item with one reference. Moves its bytes from SERVER_BUDGET_FLIGHT to the list's
 * class. */
void server_lru_adopt(struct server_lru *lru, struct server_lru_item *item, size_t bytes);
void server_lru_release(struct server_lru_item *item); /* NULL is allowed */

/* Call these functions under the lock. server_lru_put moves the caller's reference to an empty
 * place. server_lru_get counts a use and returns a new reference of the item. server_lru_take
 * empties the place and returns its reference, which the caller releases without the lock. The last
 * two return NULL if the place is empty. */
void server_lru_put(struct server_lru_item **place, struct server_lru_item *item);
struct server_lru_item *server_lru_get(struct server_lru_item **place);
struct server_lru_item *server_lru_take(struct server_lru_item **place);
