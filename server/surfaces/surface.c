/* See surface.h. */
#include "server/surfaces/surface.h"

#include <stdlib.h>

#include "server/store/kind.h"

struct server_surface *server_surface_create(struct server_record *record, void *object,
                                             size_t bytes, struct server_budget *budget,
                                             struct server_cache *cache)
{
    struct server_surface *surface = malloc(sizeof *surface);
    struct server_mesh_cache *fields = server_mesh_cache_open(cache);
    if (!surface || !fields) {
        if (fields) server_mesh_cache_release(fields);
        free(surface);
        return NULL;
    }
    *surface = (struct server_surface){.references = 1,
                                       .record = server_record_retain(record),
                                       .object = object,
                                       .bytes = bytes,
                                       .budget = budget,
                                       .fields = fields};
    server_budget_move(budget, SERVER_BUDGET_FLIGHT, SERVER_BUDGET_MESHES, bytes);
    return surface;
}

void server_surface_attach(struct server_surface *surface, void *attachment)
{
    size_t bytes = (size_t)surface->record->attachment_size;
    surface->attachment = attachment;
    surface->bytes += bytes;
    server_budget_move(surface->budget, SERVER_BUDGET_FLIGHT, SERVER_BUDGET_MESHES, bytes);
}

struct server_surface *server_surface_retain(struct server_surface *surface)
{
    atomic_fetch_add(&surface->references, 1);
    return surface;
}

void server_surface_release(struct server_surface *surface)
{
    if (!surface || atomic_fetch_sub(&surface->references, 1) != 1) return;
    server_surface_retire(surface);
    server_mesh_cache_release(surface->fields);
    surface->record->kind->release(surface->object);
    free(surface->attachment);
    server_budget_give(surface->budget, SERVER_BUDGET_MESHES, surface->bytes);
    server_record_release(surface->record);
    free(surface);
}

void server_surface_retire(struct server_surface *surface)
{
    server_mesh_cache_close(surface->fields);
    server_landmark_slot_close(&surface->landmarks);
}
