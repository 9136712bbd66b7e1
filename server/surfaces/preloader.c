/* See preloader.h. */
#include "server/surfaces/preloader.h"

#include <stdlib.h>

#include "server/surfaces/loader.h"
#include "server/server.h"
#include "server/base/thread.h"

#define NOTE_NS UINT64_C(60000000000)
/* memory that a load takes at most while it is under way, in terms of what the mesh takes */
#define LOAD_FACTOR 3

struct server_preloader {
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
    struct server_pending_load *load;
    struct proto_problem problem;
    if (server_pending_loads_enter(server->pending_loads, record, NULL, &load) !=
        SERVER_PENDING_LOADS_LOAD)
        return;
    if (server_loader_load(server, record, 0, &surface, &problem) == SERVER_LOADER_LOADED)
        server_surface_release(surface);
    server_pending_loads_end(load);
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
    const struct server_preloader *preloader = user;
    if (!server_registry_is_shared(preloader->server->registry))
        warm_up(
            /* of many daemons each has meshes of its own to answer for: it will be asked for them
             */
            preloader->server);
    while (server_thread_pause(thread, NOTE_NS))
        server_registry_note_uses(preloader->server->registry);
}

struct server_preloader *server_preloader_create(struct server *server)
{
    struct server_preloader *preloader = calloc(1, sizeof *preloader);
    if (!preloader) return NULL;
    preloader->server = server;
    preloader->thread = server_thread_start(keep, preloader);
    if (preloader->thread) return preloader;
    free(preloader);
    return NULL;
}

void server_preloader_destroy(struct server_preloader *preloader)
{
    if (!preloader) return;
    server_thread_stop(preloader->thread);
    free(preloader);
}
