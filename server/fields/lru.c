#include "server/fields/lru.h"

/* Evicts the least recently used item. Returns its bytes, or 0 if the list is empty. */
static size_t lru_evict(struct server_lru *lru)
{
    pthread_mutex_lock(&lru->lock);
    struct server_lru_item *item = TAILQ_FIRST(&lru->by_use);
    struct server_lru_item **place = item ? item->place : NULL;
    size_t bytes = item ? item->bytes : 0;
    if (item) (void)server_lru_take(place);
    if (item && lru->evicted) lru->evicted(lru, place);
    pthread_mutex_unlock(&lru->lock);
    server_lru_release(item);
    return bytes;
}

static void lru_reclaim(void *user, size_t bytes)
{
    struct server_lru *lru = user;
    size_t freed = 0, more = 1;
    atomic_fetch_add(&lru->pressures, 1);
    for (; freed < bytes && more; freed += more) more = lru_evict(lru);
}

void server_lru_begin(struct server_lru *lru)
{
    TAILQ_INIT(&lru->by_use);
    pthread_mutex_init(&lru->lock, NULL);
    lru->budget->reclaimers[lru->turn] = (struct server_reclaimer){lru_reclaim, NULL, lru};
}

void server_lru_end(struct server_lru *lru)
{
    lru->budget->reclaimers[lru->turn] = (struct server_reclaimer){0};
    pthread_mutex_destroy(&lru->lock);
}

void server_lru_adopt(struct server_lru *lru, struct server_lru_item *item, size_t bytes)
{
    server_budget_move(lru->budget, SERVER_BUDGET_FLIGHT, lru->class, bytes);
    *item = (struct server_lru_item){.references = 1, .lru = lru, .bytes = bytes};
}

void server_lru_release(struct server_lru_item *item)
{
    if (!item || atomic_fetch_sub(&item->references, 1) != 1) return;
    server_budget_give(item->lru->budget, item->lru->class, item->bytes);
    item->lru->free(item);
}

void server_lru_put(struct server_lru_item **place, struct server_lru_item *item)
{
    *place = item;
    item->place = place;
    TAILQ_INSERT_TAIL(&item->lru->by_use, item, by_use);
}

struct server_lru_item *server_lru_get(struct server_lru_item **place)
{
    struct server_lru_item *item = server_lru_take(place);
    if (!item) return NULL;
    server_lru_put(place, item);
    atomic_fetch_add(&item->references, 1);
    return item;
}

struct server_lru_item *server_lru_take(struct server_lru_item **place)
{
    struct server_lru_item *item = *place;
    if (!item) return NULL;
    TAILQ_REMOVE(&item->lru->by_use, item, by_use);
    *place = NULL;
    return item;
}
