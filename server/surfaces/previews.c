#include "server/surfaces/previews.h"

#include <stdlib.h>

#include "gd/edit.h"
#include "server/base/thread.h"
#include "server/surfaces/field_store.h"

struct server_previews {
    struct server_background background; /* must be the first member */
    enum gd_status status;               /* status of the current build; used by the thread */
};

static void preview_free(struct server_lru_item *item)
{
    struct server_preview *preview = (struct server_preview *)item;
    gd_polygons_free(&preview->polygons);
    free(preview);
}

void server_preview_release(struct server_preview *preview)
{
    if (preview) server_lru_release(&preview->item);
}

/* --- the thread ------------------------------------------------------------------------------- */

/* Makes a preview of the polygons. Takes over the polygons and their bytes. */
static enum gd_status preview_wrap(struct server_build *build, struct server_stored_preview *made,
                                   struct server_preview **out)
{
    struct server_lru *lru = &build->background->lru;
    struct server_preview *preview = malloc(sizeof *preview);
    if (!preview) {
        gd_polygons_free(&made->polygons);
        server_budget_give(lru->budget, SERVER_BUDGET_FLIGHT, made->bytes);
        return GD_NO_MEMORY;
    }
    preview->wanted = build->surface->preview.wanted;
    preview->largest_distance = made->largest_distance;
    preview->polygons = made->polygons;
    server_lru_adopt(lru, &preview->item, made->bytes);
    *out = preview;
    return GD_OK;
}

static enum gd_status preview_make(struct server_build *build, struct server_preview **out)
{
    const struct gd_mesh *mesh = build->surface->mesh;
    const struct gd_simplify_options options = {.faces = build->surface->preview.wanted};
    struct gd_edited edited;
    struct server_budgeted_call call =
        server_build_begin_call(build, gd_edit_cost(gd_mesh_summary(mesh)->faces));
    while (server_budgeted_call_next(&call)) {
        call.status = gd_simplify(mesh, &options, &call.control, &edited, NULL);
        if (!call.status) call.kept = edited.bytes;
    }
    if (call.status) return call.status;
    size_t origins = edited.polygons.position_count * sizeof *edited.origins;
    struct server_stored_preview made = {.largest_distance = edited.largest_distance,
                                         .polygons = edited.polygons,
                                         .bytes = edited.bytes - origins};
    edited.polygons = (struct gd_polygons){0};
    gd_edited_free(&edited);
    server_budget_give(build->background->lru.budget, SERVER_BUDGET_FLIGHT, origins);
    return preview_wrap(build, &made, out);
}

static struct server_lru_item *preview_read_or_make(struct server_build *build)
{
    const struct server_background_parts *parts = &build->background->parts;
    struct server_preview *preview = NULL;
    struct server_stored_preview stored = {.wanted = build->surface->preview.wanted};
    bool is_stored = parts->field_store &&
                     server_field_store_read_preview(parts->field_store, build->surface, &stored);
    enum gd_status status =
        is_stored ? preview_wrap(build, &stored, &preview) : preview_make(build, &preview);
    ((struct server_previews *)build->background)->status = status;
    if (status) return NULL;
    stored.polygons = preview->polygons;
    stored.largest_distance = preview->largest_distance;
    if (parts->field_store && !is_stored)
        server_field_store_write_preview(parts->field_store, parts->registry, build->surface,
                                         &stored);
    return &preview->item;
}

static void preview_on_end(const struct server_build *build, bool is_kept)
{
    enum gd_status status = ((struct server_previews *)build->background)->status;
    (void)is_kept;
    /* a build that is cancelled because its surface retires or the daemon stops has not failed */
    if (status == GD_CANCELLED) status = server_build_is_pressed(build) ? GD_BUDGET : GD_OK;
    build->surface->preview.failure = status;
}

/* --- finding ---------------------------------------------------------------------------------- */

enum gd_status server_previews_find(struct server_background *previews,
                                    struct server_surface *surface, uint32_t faces,
                                    struct server_preview **out, double *progress)
{
    struct server_preview_slot *slot = &surface->preview;
    atomic_store(&slot->base.owner, previews);
    pthread_mutex_lock(&previews->lru.lock);
    enum gd_status status = slot->failure;
    struct server_preview *found = (struct server_preview *)slot->base.item;
    bool is_found = found && found->wanted == faces,
         is_queued = !is_found && !status && server_background_queue(previews, &slot->base);
    slot->failure = GD_OK;
    if (is_found) (void)server_lru_get(&slot->base.item);
    if (is_queued) {
        slot->wanted = faces;
        atomic_store(&slot->base.progress, 0);
    }
    pthread_mutex_unlock(&previews->lru.lock);
    if (is_queued) server_thread_wake(previews->thread);
    if (status && !is_found) return status;
    *out = is_found ? found : NULL;
    *progress = atomic_load(&slot->base.progress) / (double)SERVER_BACKGROUND_DONE;
    return GD_OK;
}

void server_previews_expect(struct server_background *previews, struct server_surface *surface)
{
    struct server_preview *preview = NULL;
    double progress;
    if (surface->record->kind != &server_kind_mesh ||
        gd_mesh_summary(surface->mesh)->faces <= SERVER_PREVIEW_FROM)
        return;
    if (!server_previews_find(previews, surface, SERVER_PREVIEW_FACES, &preview, &progress))
        server_preview_release(preview);
}

struct server_background *server_previews_create(const struct server_background_parts *parts)
{
    struct server_previews *previews = calloc(1, sizeof *previews);
    if (!previews) return NULL;
    previews->background = (struct server_background){.lru = {.class = SERVER_BUDGET_PREVIEWS,
                                                              .turn = SERVER_RECLAIM_PREVIEWS,
                                                              .free = preview_free},
                                                      .parts = *parts,
                                                      .make = preview_read_or_make,
                                                      .ended = preview_on_end};
    return server_background_start(&previews->background);
}
