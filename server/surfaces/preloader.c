/* See keeper.h. */
#include "server/surfaces/preloader.h"

#include <stdlib.h>

#include "server/surfaces/loader.h"
#include "server/server.h"
#include "server/base/thread.h"

#define NOTE_NS UINT64_C(60000000000)
/* memory that a load takes at most while it is under way, in terms of what the mesh takes */
#define LOAD_FACTOR 3

struct server_keeper {
    struct server *server;
    struct server_thread *thread;
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
    while (!server_workers_cancelled(server->workers) &&
           (record = server_registry_hottest(server->registry))) {
        bool fits = has_room(server, record);
        if (fits) load(server, record);
        server_record_release(record);
        if (!fits) return;
    }
}

static void keep(void *user, struct server_thread *thread)
{
    const struct server_keeper *keeper = user;
    if (!server_registry_is_shared(keeper->server->registry))
        warm_up(
            /* of many daemons each has meshes of its own to answer for: it will be asked for them
             */
            keeper->server);
    while (server_thread_pause(thread, NOTE_NS))
        server_registry_note_uses(keeper->server->registry);
}

struct server_keeper *server_keeper_create(struct server *server)
{
    struct server_keeper *keeper = calloc(1, sizeof *keeper);
    if (!keeper) return NULL;
    keeper->server = server;
    keeper->thread = server_thread_start(keep, keeper);
    if (keeper->thread) return keeper;
    free(keeper);
    return NULL;
}

void server_keeper_destroy(struct server_keeper *keeper)
{
    if (!keeper) return;
    server_thread_stop(keeper->thread);
    free(keeper);
}
