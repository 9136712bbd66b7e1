/* See preloader.h. */
#include "server/surfaces/preloader.h"

#include <stdlib.h>

#include "server/base/thread.h"
#include "server/surfaces/loader.h"
#include "server/surfaces/pending_loads.h"

#define NOTE_NS     UINT64_C(60000000000)
#define LOAD_FACTOR 3 /* a load takes at most so many times the memory of the mesh */

struct server_preloader {
    const struct server_loader *loader;
    struct server_pending_loads *pending_loads;
    struct server_thread *thread;
};

static void preload_record(const struct server_preloader *preloader, struct server_record *record)
{
    struct server_surface *surface;
    struct server_pending_load *load;
    struct proto_problem problem;
    if (server_pending_loads_enter(preloader->pending_loads, record, NULL, &load) !=
        SERVER_PENDING_LOADS_LOAD)
        return;
    if (server_loader_load(preloader->loader, record, 0, &surface, &problem) ==
        SERVER_LOADER_LOADED)
        server_surface_release(surface);
    server_pending_loads_end(load);
}

/* Loads the most used first, until the next one would need memory that is in use. */
static void preload(const struct server_preloader *preloader)
{
    const struct server_loader *loader = preloader->loader;
    size_t limit = loader->budget->limit;
    bool fits = true;
    while (fits && !server_workers_cancelled(loader->workers)) {
        struct server_record *record = server_registry_hottest(loader->registry);
        if (!record) return;
        size_t total = atomic_load(&loader->budget->total);
        fits = total < limit && record->memory * LOAD_FACTOR < limit - total;
        if (fits) preload_record(preloader, record);
        server_record_release(record);
    }
}

/* Of many daemons on one store, each loads only the meshes that it is asked for. */
static void run(void *user, struct server_thread *thread)
{
    const struct server_preloader *preloader = user;
    struct server_registry *registry = preloader->loader->registry;
    if (!server_registry_is_shared(registry)) preload(preloader);
    while (server_thread_pause(thread, NOTE_NS)) server_registry_note_uses(registry);
}

struct server_preloader *server_preloader_create(const struct server_loader *loader,
                                                 struct server_pending_loads *pending_loads)
{
    struct server_preloader *preloader = calloc(1, sizeof *preloader);
    if (!preloader) return NULL;
    preloader->loader = loader;
    preloader->pending_loads = pending_loads;
    preloader->thread = server_thread_start(run, preloader);
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
