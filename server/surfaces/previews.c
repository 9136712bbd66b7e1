#include "server/surfaces/previews.h"

#include <pthread.h>
#include <stdlib.h>

#include "gd/edit.h"
#include "server/base/thread.h"
#include "server/store/kind.h"
#include "server/surfaces/field_store.h"
#include "server/work/workers.h"

#define REST_NS UINT64_C(10000000) /* a step takes about a millisecond */

struct server_previews {
    struct server_previews_parts parts;
    struct server_budget *budget;
    struct server_thread *thread;
    pthread_mutex_t lock;
    TAILQ_HEAD(, server_preview_slot) by_use; /* the least recently used first */
    LIST_HEAD(, server_preview_slot) waiting; /* the latest first */
    struct server_preview_slot *building;     /* the slot whose preview is made or read; or NULL */
    atomic_uint pressures;                    /* how often memory was short */
};

/* Makes or reads the preview of a surface. */
struct preview_build {
    struct server_previews *owner;
    struct server_surface *surface; /* a reference, taken over from the slot */
    uint32_t wanted;
    unsigned pressures; /* `previews->pressures` at the start */
    enum gd_status status;
    struct server_preview *preview; /* the result */
};

/* --- previews --------------------------------------------------------------------------------- */

void server_preview_release(struct server_preview *preview)
{
    if (!preview || atomic_fetch_sub(&preview->references, 1) != 1) return;
    gd_polygons_free(&preview->polygons);
    server_budget_give(preview->budget, SERVER_BUDGET_PREVIEWS, preview->bytes);
    free(preview);
}

/* Empties a slot, under the lock. Returns its preview or NULL, which the caller releases without
 * the lock. */
static struct server_preview *slot_empty(struct server_previews *previews,
                                         struct server_preview_slot *slot)
{
    struct server_preview *preview = slot->preview;
    if (preview) TAILQ_REMOVE(&previews->by_use, slot, by_use);
    slot->preview = NULL;
    return preview;
}

static void previews_reclaim(void *user, size_t bytes)
{
    struct server_previews *previews = user;
    atomic_fetch_add(&previews->pressures, 1);
    for (size_t freed = 0; freed < bytes;) {
        pthread_mutex_lock(&previews->lock);
        struct server_preview_slot *slot = TAILQ_FIRST(&previews->by_use);
        struct server_preview *preview = slot ? slot_empty(previews, slot) : NULL;
        pthread_mutex_unlock(&previews->lock);
        if (!preview) return;
        freed += preview->bytes;
        server_preview_release(preview);
    }
}

/* --- the thread ------------------------------------------------------------------------------- */

/* Sleeps while all workers are busy. Returns false if the preview is not needed any more, or memory
 * is short. */
static bool build_progress(void *user, double fraction)
{
    const struct preview_build *build = user;
    struct server_previews *previews = build->owner;
    struct server_preview_slot *slot = &build->surface->preview;
    struct server_workers_load load = server_workers_load(previews->parts.workers);
    atomic_store(&slot->progress, (uint32_t)(fraction * SERVER_PREVIEW_DONE));
    return server_thread_sleep(previews->thread, load.running < load.threads ? 0 : REST_NS) &&
           server_workers_go_on(previews->parts.workers) && !atomic_load(&slot->is_closed) &&
           atomic_load(&previews->pressures) == build->pressures;
}

/* Makes a preview of the polygons and takes over their bytes of SERVER_BUDGET_FLIGHT. */
static enum gd_status build_wrap(struct preview_build *build, struct gd_polygons *polygons,
                                 double largest_distance, size_t bytes)
{
    struct server_budget *budget = build->owner->budget;
    struct server_preview *preview = malloc(sizeof *preview);
    if (!preview) {
        gd_polygons_free(polygons);
        server_budget_give(budget, SERVER_BUDGET_FLIGHT, bytes);
        return GD_NO_MEMORY;
    }
    server_budget_move(budget, SERVER_BUDGET_FLIGHT, SERVER_BUDGET_PREVIEWS, bytes);
    *preview = (struct server_preview){.references = 1,
                                       .wanted = build->wanted,
                                       .largest_distance = largest_distance,
                                       .polygons = *polygons,
                                       .budget = budget,
                                       .bytes = bytes};
    build->preview = preview;
    return GD_OK;
}

static enum gd_status build_make(struct preview_build *build)
{
    const struct server_previews_parts *parts = &build->owner->parts;
    const struct gd_mesh *mesh = build->surface->mesh;
    const struct gd_simplify_options options = {.faces = build->wanted};
    struct gd_edited edited;
    struct server_budgeted_call call = {.workspaces = parts->workspaces,
                                        .control = {.progress = build_progress, .user = build},
                                        .grant = gd_edit_cost(gd_mesh_summary(mesh)->faces),
                                        .is_modest = true,
                                        .status = GD_BUDGET};
    while (server_budgeted_call_next(&call)) {
        call.status = gd_simplify(mesh, &options, &call.control, &edited, NULL);
        if (!call.status) call.kept = edited.bytes;
    }
    if (call.status) return call.status;
    struct gd_polygons polygons = edited.polygons;
    size_t origins = polygons.position_count * sizeof *edited.origins;
    edited.polygons = (struct gd_polygons){0};
    server_budget_give(build->owner->budget, SERVER_BUDGET_FLIGHT, origins);
    size_t bytes = edited.bytes - origins;
    double largest_distance = edited.largest_distance;
    gd_edited_free(&edited);
    return build_wrap(build, &polygons, largest_distance, bytes);
}

static void build_run(struct preview_build *build)
{
    const struct server_previews_parts *parts = &build->owner->parts;
    struct server_stored_preview stored = {.wanted = build->wanted};
    if (parts->field_store &&
        server_field_store_read_preview(parts->field_store, build->surface, &stored)) {
        build->status = build_wrap(build, &stored.polygons, stored.largest_distance, stored.bytes);
        return;
    }
    build->status = build_make(build);
    if (build->status || !parts->field_store) return;
    stored.polygons = build->preview->polygons;
    stored.largest_distance = build->preview->largest_distance;
    server_field_store_write_preview(parts->field_store, parts->registry, build->surface, &stored);
}

/* Stores the preview (NULL: none) in the slot. */
static void build_end(struct preview_build *build)
{
    struct server_previews *previews = build->owner;
    struct server_preview_slot *slot = &build->surface->preview;
    struct server_preview *dropped = build->preview;
    bool was_short =
        build->status == GD_CANCELLED && atomic_load(&previews->pressures) != build->pressures;
    pthread_mutex_lock(&previews->lock);
    previews->building = NULL;
    slot->coming = NULL;
    slot->failure = was_short ? GD_BUDGET : build->status;
    if (build->preview && !atomic_load(&slot->is_closed)) {
        dropped = slot_empty(previews, slot);
        slot->preview = build->preview;
        TAILQ_INSERT_TAIL(&previews->by_use, slot, by_use);
    }
    pthread_mutex_unlock(&previews->lock);
    server_preview_release(dropped);
    server_surface_release(build->surface);
}

/* Takes the most recently queued slot. Returns false if there is none. */
static bool build_begin(struct server_previews *previews, struct preview_build *build)
{
    SERVER_LOCK(&previews->lock);
    struct server_preview_slot *slot = previews->building = LIST_FIRST(&previews->waiting);
    if (!slot) return false;
    LIST_REMOVE(slot, waiting);
    *build = (struct preview_build){.owner = previews,
                                    .surface = slot->coming,
                                    .wanted = slot->wanted,
                                    .pressures = atomic_load(&previews->pressures)};
    return true;
}

static void previews_run(void *user, struct server_thread *thread)
{
    struct server_previews *previews = user;
    struct preview_build build;
    while (server_thread_pause(thread, SERVER_THREAD_FOREVER)) {
        server_workers_begin_guest(previews->parts.workers);
        while (server_thread_sleep(thread, 0) && build_begin(previews, &build)) {
            build_run(&build);
            build_end(&build);
        }
        server_workers_end_guest(previews->parts.workers);
    }
}

/* Under the lock: removes `slot`, or with NULL the most recently queued slot, from the queue.
 * Returns its surface or NULL, which the caller releases without the lock. */
static struct server_surface *slot_end_wait(struct server_previews *previews,
                                            struct server_preview_slot *slot)
{
    if (!slot) slot = LIST_FIRST(&previews->waiting);
    if (!slot || slot == previews->building) return NULL;
    struct server_surface *surface = slot->coming;
    if (surface) LIST_REMOVE(slot, waiting);
    slot->coming = NULL;
    return surface;
}

/* --- finding ---------------------------------------------------------------------------------- */

enum gd_status server_previews_find(struct server_previews *previews,
                                    struct server_surface *surface, uint32_t faces,
                                    struct server_preview **out, double *progress)
{
    struct server_preview_slot *slot = &surface->preview;
    struct server_preview *found = NULL;
    bool is_first = false;
    atomic_store(&slot->owner, previews);
    pthread_mutex_lock(&previews->lock);
    enum gd_status status = slot->failure;
    slot->failure = GD_OK;
    if (slot->preview && slot->preview->wanted == faces) {
        found = slot->preview;
        status = GD_OK;
        TAILQ_REMOVE(&previews->by_use, slot, by_use);
        TAILQ_INSERT_TAIL(&previews->by_use, slot, by_use);
        atomic_fetch_add(&found->references, 1);
    } else if (!status && !slot->coming && !atomic_load(&slot->is_closed)) {
        is_first = true;
        slot->coming = server_surface_retain(surface);
        slot->wanted = faces;
        atomic_store(&slot->progress, 0);
        LIST_INSERT_HEAD(&previews->waiting, slot, waiting);
    }
    pthread_mutex_unlock(&previews->lock);
    if (is_first) server_thread_wake(previews->thread);
    if (status) return status;
    *out = found;
    *progress = atomic_load(&slot->progress) / (double)SERVER_PREVIEW_DONE;
    return GD_OK;
}

void server_previews_expect(struct server_previews *previews, struct server_surface *surface)
{
    struct server_preview *preview = NULL;
    double progress;
    if (surface->record->kind != &server_kind_mesh ||
        gd_mesh_summary(surface->mesh)->faces <= SERVER_PREVIEW_FROM)
        return;
    if (!server_previews_find(previews, surface, SERVER_PREVIEW_FACES, &preview, &progress))
        server_preview_release(preview);
}

void server_preview_slot_close(struct server_preview_slot *slot)
{
    atomic_store(&slot->is_closed, true);
    struct server_previews *previews = atomic_load(&slot->owner);
    if (!previews) return;
    pthread_mutex_lock(&previews->lock);
    struct server_preview *preview = slot_empty(previews, slot);
    /* released without the lock, since it may be large */
    struct server_surface *surface = slot_end_wait(previews, slot);
    pthread_mutex_unlock(&previews->lock);
    server_preview_release(preview);
    server_surface_release(surface);
}

struct server_previews *server_previews_create(const struct server_previews_parts *parts)
{
    struct server_previews *previews = calloc(1, sizeof *previews);
    if (!previews) return NULL;
    previews->parts = *parts;
    previews->budget = server_workspaces_budget(parts->workspaces);
    pthread_mutex_init(&previews->lock, NULL);
    TAILQ_INIT(&previews->by_use);
    previews->budget->reclaimers[SERVER_RECLAIM_PREVIEWS] =
        (struct server_reclaimer){previews_reclaim, NULL, previews};
    previews->thread = server_thread_start(previews_run, previews);
    if (previews->thread) return previews;
    server_previews_destroy(previews);
    return NULL;
}

void server_previews_stop(struct server_previews *previews)
{
    struct server_surface *surface;
    if (!previews) return;
    server_thread_stop(previews->thread);
    previews->thread = NULL;
    do {
        pthread_mutex_lock(&previews->lock);
        surface = slot_end_wait(previews, NULL);
        pthread_mutex_unlock(&previews->lock);
        server_surface_release(surface);
    } while (surface);
}

void server_previews_destroy(struct server_previews *previews)
{
    if (!previews) return;
    server_previews_stop(previews);
    previews->budget->reclaimers[SERVER_RECLAIM_PREVIEWS] = (struct server_reclaimer){0};
    pthread_mutex_destroy(&previews->lock);
    free(previews);
}

bool server_previews_are_building(struct server_previews *previews)
{
    if (!previews) return false;
    SERVER_LOCK(&previews->lock);
    return previews->building != NULL;
}
