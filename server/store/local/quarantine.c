/* See quarantine.h. */
#include "server/store/local/quarantine.h"

#include <stdlib.h>
#include <string.h>

struct server_condemned {
    struct server_condemned *next;
    char object[SERVER_OBJECT];
};

void server_quarantine_init(struct server_quarantine *quarantine)
{
    *quarantine = (struct server_quarantine){0};
    pthread_mutex_init(&quarantine->lock, NULL);
}

void server_quarantine_clear(struct server_quarantine *quarantine)
{
    while (quarantine->first) server_quarantine_lift(quarantine, quarantine->first->object);
    pthread_mutex_destroy(&quarantine->lock);
}

/* Under the lock. The pointer to the object's entry, or to the end of the list. */
static struct server_condemned **quarantine_find(struct server_quarantine *quarantine,
                                                 const char *object)
{
    struct server_condemned **place = &quarantine->first;
    while (*place && strcmp((*place)->object, object) != 0) place = &(*place)->next;
    return place;
}

uint64_t server_quarantine_turn(struct server_quarantine *quarantine)
{
    pthread_mutex_lock(&quarantine->lock);
    uint64_t turn = quarantine->turn;
    pthread_mutex_unlock(&quarantine->lock);
    return turn;
}

bool server_quarantine_condemn(struct server_quarantine *quarantine, const char *object,
                               uint64_t turn)
{
    pthread_mutex_lock(&quarantine->lock);
    struct server_condemned **place = quarantine_find(quarantine, object);
    if (quarantine->turn == turn && !*place && (*place = calloc(1, sizeof **place))) {
        strcpy((*place)->object, object);
        quarantine->count++;
    }
    bool is_held = quarantine->turn == turn && *place;
    pthread_mutex_unlock(&quarantine->lock);
    return is_held;
}

void server_quarantine_lift(struct server_quarantine *quarantine, const char *object)
{
    pthread_mutex_lock(&quarantine->lock);
    struct server_condemned **place = quarantine_find(quarantine, object), *lifted = *place;
    quarantine->turn++;
    if (lifted) {
        *place = lifted->next;
        quarantine->count--;
    }
    pthread_mutex_unlock(&quarantine->lock);
    free(lifted);
}

bool server_quarantine_holds(struct server_quarantine *quarantine, const char *object)
{
    pthread_mutex_lock(&quarantine->lock);
    bool is_held = *quarantine_find(quarantine, object) != NULL;
    pthread_mutex_unlock(&quarantine->lock);
    return is_held;
}

uint32_t server_quarantine_count(struct server_quarantine *quarantine)
{
    pthread_mutex_lock(&quarantine->lock);
    uint32_t count = quarantine->count;
    pthread_mutex_unlock(&quarantine->lock);
    return count;
}
