/* See keeper.h. */
#include "server/keeper.h"

#include <pthread.h>
#include <stdlib.h>
#include <time.h>

#include "server/loader.h"
#include "server/server.h"

#define NOTE_SECONDS 60
#define LOAD_FACTOR  3 /* memory that a load takes at most while it is under way, in terms of what the mesh takes */

struct server_keeper {
    struct server *server;
    pthread_mutex_t lock;
    pthread_cond_t change;
    bool stopping;
    pthread_t thread;
};

static bool has_room(struct server *server, const struct server_record *record)
{
    size_t total = atomic_load(&server->budget.total), limit = server->budget.limit;
    return total < limit && record->memory * LOAD_FACTOR < limit - total;
}

static void load(struct server *server, struct server_record *record)
{
    struct server_surface *surface;
    struct server_load *load;
    struct proto_problem problem;
    if (server_loads_enter(server->loads, record, NULL, &load) != SERVER_LOADS_LOAD) return;
    if (server_loader_load(server, record, 0, &surface, &problem) == SERVER_LOADER_LOADED)
        server_surface_release(surface);
    server_loads_end(load);
}

/* Loads the most used first, until the next one would need room that others have. */
static void warm_up(struct server *server)
{
    struct server_record *record;
    while (!server_workers_cancelled(server->workers) && (record = server_registry_hottest(server->registry))) {
        bool fits = has_room(server, record);
        if (fits) load(server, record);
        server_record_release(record);
        if (!fits) return;
    }
}

static void *keep(void *user)
{
    struct server_keeper *keeper = user;
    struct timespec wake;
    warm_up(keeper->server);
    pthread_mutex_lock(&keeper->lock);
    while (!keeper->stopping) {
        clock_gettime(CLOCK_REALTIME, &wake);
        wake.tv_sec += NOTE_SECONDS;
        if (pthread_cond_timedwait(&keeper->change, &keeper->lock, &wake) == 0) continue;
        pthread_mutex_unlock(&keeper->lock);
        server_registry_note_uses(keeper->server->registry);
        pthread_mutex_lock(&keeper->lock);
    }
    pthread_mutex_unlock(&keeper->lock);
    return NULL;
}

struct server_keeper *server_keeper_create(struct server *server)
{
    struct server_keeper *keeper = calloc(1, sizeof *keeper);
    if (!keeper) return NULL;
    keeper->server = server;
    pthread_mutex_init(&keeper->lock, NULL);
    pthread_cond_init(&keeper->change, NULL);
    if (pthread_create(&keeper->thread, NULL, keep, keeper) == 0) return keeper;
    free(keeper);
    return NULL;
}

void server_keeper_destroy(struct server_keeper *keeper)
{
    if (!keeper) return;
    pthread_mutex_lock(&keeper->lock);
    keeper->stopping = true;
    pthread_cond_signal(&keeper->change);
    pthread_mutex_unlock(&keeper->lock);
    pthread_join(keeper->thread, NULL);
    pthread_cond_destroy(&keeper->change);
    pthread_mutex_destroy(&keeper->lock);
    free(keeper);
}
