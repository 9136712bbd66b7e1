/* See quarantine.h. */
#include "server/store/quarantine.h"

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

/* Under the lock: where the object is pointed to, or the place for another one. */
static struct server_condemned **find(struct server_quarantine *quarantine, const char *object)
{
    struct server_condemned **place = &quarantine->first;
    while (*place && strcmp((*place)->object, object) != 0) place = &(*place)->next;
    return place;
}

/* Under the lock. */
static void take_out(struct server_quarantine *quarantine, struct server_condemned **place)
{
    struct server_condemned *gone = *place;
    *place = gone->next;
    quarantine->count--;
    free(gone);
}

void server_quarantine_clear(struct server_quarantine *quarantine)
{
    while (quarantine->first) take_out(quarantine, &quarantine->first);
    pthread_mutex_destroy(&quarantine->lock);
}

uint64_t server_quarantine_turn(struct server_quarantine *quarantine)
{
    pthread_mutex_lock(&quarantine->lock);
    uint64_t turn = quarantine->turn;
    pthread_mutex_unlock(&quarantine->lock);
    return turn;
}

/* Under the lock. */
static bool put_in(struct server_quarantine *quarantine, const char *object)
{
    struct server_condemned **place = find(quarantine, object);
    if (*place) return true;
    *place = calloc(1, sizeof **place);
    if (!*place) return false;
    strcpy((*place)->object, object);
    quarantine->count++;
    return true;
}

bool server_quarantine_condemn(struct server_quarantine *quarantine, const char *object,
                               uint64_t turn)
{
    pthread_mutex_lock(&quarantine->lock);
    bool is_in = quarantine->turn == turn && put_in(quarantine, object);
    pthread_mutex_unlock(&quarantine->lock);
    return is_in;
}

void server_quarantine_lift(struct server_quarantine *quarantine, const char *object)
{
    pthread_mutex_lock(&quarantine->lock);
    struct server_condemned **place = find(quarantine, object);
    quarantine->turn++;
    if (*place) take_out(quarantine, place);
    pthread_mutex_unlock(&quarantine->lock);
}

bool server_quarantine_holds(struct server_quarantine *quarantine, const char *object)
{
    pthread_mutex_lock(&quarantine->lock);
    bool is_in = *find(quarantine, object) != NULL;
    pthread_mutex_unlock(&quarantine->lock);
    return is_in;
}

uint32_t server_quarantine_count(struct server_quarantine *quarantine)
{
    pthread_mutex_lock(&quarantine->lock);
    uint32_t count = quarantine->count;
    pthread_mutex_unlock(&quarantine->lock);
    return count;
}
