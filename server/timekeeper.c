/* See timekeeper.h. */
#include "server/timekeeper.h"

#include <pthread.h>
#include <stdlib.h>
#include <time.h>

#include "server/server.h"

#define TICK_NS 10000000L /* a deadline is answered so late at most */

struct server_timekeeper {
    struct server *server;
    pthread_mutex_t lock;
    pthread_cond_t change;
    bool stopping;
    pthread_t thread;
};

static void tick(struct server *server)
{
    struct timespec pause = {.tv_nsec = TICK_NS};
    nanosleep(&pause, NULL);
    uint64_t now = gd_now_ns();
    server_workers_expire(server->workers, now);
    server_cache_expire(server->cache, now);
    server_loads_expire(server->loads, now);
}

static void *keep_time(void *user)
{
    struct server_timekeeper *timekeeper = user;
    pthread_mutex_lock(&timekeeper->lock);
    while (!timekeeper->stopping) {
        if (atomic_load(&timekeeper->server->deferred) == 0) {
            pthread_cond_wait(&timekeeper->change, &timekeeper->lock);
            continue;
        }
        pthread_mutex_unlock(&timekeeper->lock);
        tick(timekeeper->server);
        pthread_mutex_lock(&timekeeper->lock);
    }
    pthread_mutex_unlock(&timekeeper->lock);
    return NULL;
}

struct server_timekeeper *server_timekeeper_create(struct server *server)
{
    struct server_timekeeper *timekeeper = calloc(1, sizeof *timekeeper);
    if (!timekeeper) return NULL;
    timekeeper->server = server;
    pthread_mutex_init(&timekeeper->lock, NULL);
    pthread_cond_init(&timekeeper->change, NULL);
    if (pthread_create(&timekeeper->thread, NULL, keep_time, timekeeper) == 0) return timekeeper;
    free(timekeeper);
    return NULL;
}

void server_timekeeper_wake(struct server_timekeeper *timekeeper)
{
    pthread_mutex_lock(&timekeeper->lock);
    pthread_cond_signal(&timekeeper->change);
    pthread_mutex_unlock(&timekeeper->lock);
}

void server_timekeeper_destroy(struct server_timekeeper *timekeeper)
{
    if (!timekeeper) return;
    pthread_mutex_lock(&timekeeper->lock);
    timekeeper->stopping = true;
    pthread_cond_signal(&timekeeper->change);
    pthread_mutex_unlock(&timekeeper->lock);
    pthread_join(timekeeper->thread, NULL);
    pthread_cond_destroy(&timekeeper->change);
    pthread_mutex_destroy(&timekeeper->lock);
    free(timekeeper);
}
