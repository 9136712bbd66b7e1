#include "server/surfaces/background.h"

#include <stdlib.h>

#include "server/base/thread.h"

#define REST_NS UINT64_C(10000000) /* pause after a step; a step takes about a millisecond */

bool server_build_is_pressed(const struct server_build *build)
{
    return atomic_load(&build->background->lru.pressures) != build->pressures;
}

static bool build_on_progress(void *user, double fraction)
{
    const struct server_build *build = user;
    struct server_background *background = build->background;
    struct server_workers_load load = server_workers_load(background->parts.workers);
    atomic_store(&build->slot->progress, (uint32_t)(fraction * SERVER_BACKGROUND_DONE));
    return server_thread_sleep(background->thread, load.running < load.threads ? 0 : REST_NS) &&
           server_workers_go_on(background->parts.workers) &&
           !atomic_load(&build->slot->is_closed) && !server_build_is_pressed(build);
}

struct server_budgeted_call server_build_begin_call(struct server_build *build, size_t grant)
{
    return (struct server_budgeted_call){.workspaces = build->background->parts.workspaces,
                                         .control = {.progress = build_on_progress, .user = build},
                                         .grant = grant,
                                         .is_modest = true,
                                         .status = GD_BUDGET};
}

/* Takes the latest slot whose surface is not being freed. Returns false if there is none. */
static bool build_begin(struct server_background *background, struct server_build *build)
{
    SERVER_LOCK(&background->lru.lock);
    for (struct server_background_slot *slot; (slot = LIST_FIRST(&background->waiting));) {
        LIST_REMOVE(slot, waiting);
        *build = (struct server_build){.background = background,
                                       .slot = slot,
                                       .surface = slot->surface,
                                       .pressures = atomic_load(&background->lru.pressures)};
        slot->is_coming = server_surface_retain_alive(slot->surface);
        background->building = slot->is_coming ? slot : NULL;
        if (slot->is_coming) return true;
    }
    return false;
}

/* Stores the result, which may be NULL, in the slot. */
static void build_end(struct server_build *build, struct server_lru_item *item)
{
    struct server_background *background = build->background;
    struct server_background_slot *slot = build->slot;
    pthread_mutex_lock(&background->lru.lock);
    bool is_kept = item && !atomic_load(&slot->is_closed);
    struct server_lru_item *dropped = is_kept ? server_lru_take(&slot->item) : item;
    if (is_kept) server_lru_put(&slot->item, item);
    background->building = NULL;
    slot->is_coming = false;
    background->ended(build, is_kept);
    pthread_mutex_unlock(&background->lru.lock);
    server_lru_release(dropped);
    server_surface_release(build->surface);
}

static void background_run(void *user, struct server_thread *thread)
{
    struct server_background *background = user;
    struct server_build build;
    while (server_thread_pause(thread, SERVER_THREAD_FOREVER)) {
        server_workers_begin_guest(background->parts.workers);
        while (server_thread_sleep(thread, 0) && build_begin(background, &build))
            build_end(&build, background->make(&build));
        server_workers_end_guest(background->parts.workers);
    }
}

bool server_background_queue(struct server_background *background,
                             struct server_background_slot *slot)
{
    if (slot->is_coming || atomic_load(&slot->is_closed)) return false;
    slot->is_coming = true;
    LIST_INSERT_HEAD(&background->waiting, slot, waiting);
    return true;
}

bool server_background_is_busy(struct server_background *background)
{
    if (!background) return false;
    SERVER_LOCK(&background->lru.lock);
    return background->building || !LIST_EMPTY(&background->waiting);
}

void server_background_slot_close(struct server_background_slot *slot)
{
    atomic_store(&slot->is_closed, true);
    struct server_background *background = atomic_load(&slot->owner);
    if (!background) return;
    pthread_mutex_lock(&background->lru.lock);
    struct server_lru_item *item = server_lru_take(&slot->item);
    if (slot->is_coming && slot != background->building) {
        LIST_REMOVE(slot, waiting);
        slot->is_coming = false;
    }
    pthread_mutex_unlock(&background->lru.lock);
    server_lru_release(item);
}

struct server_background *server_background_start(struct server_background *background)
{
    background->lru.budget = server_workspaces_budget(background->parts.workspaces);
    server_lru_begin(&background->lru);
    background->thread = server_thread_start(background_run, background);
    if (background->thread) return background;
    server_background_destroy(background);
    return NULL;
}

void server_background_stop(struct server_background *background)
{
    if (!background) return;
    server_thread_stop(background->thread);
    background->thread = NULL;
}

void server_background_destroy(struct server_background *background)
{
    if (!background) return;
    server_background_stop(background);
    server_lru_end(&background->lru);
    free(background);
}
