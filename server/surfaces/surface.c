#include "server/surfaces/surface.h"

#include <stdio.h>
#include <stdlib.h>

#include "server/store/kind.h"
#include "server/work/executor.h"

#define SHARED_BYTES ((uint64_t)1 << 20) /* two workers build the surface of a larger file */

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
                                       .fields = fields,
                                       .landmarks.base.surface = surface,
                                       .preview.base.surface = surface};
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

void server_listed_release(struct server_listed *listed)
{
    server_surface_release(listed->surface);
    server_record_release(listed->record);
}

bool server_surface_retain_alive(struct server_surface *surface)
{
    unsigned references = atomic_load(&surface->references);
    while (references)
        if (atomic_compare_exchange_weak(&surface->references, &references, references + 1))
            return true;
    return false;
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
    server_background_slot_close(&surface->landmarks.base);
    server_background_slot_close(&surface->preview.base);
}

/* Sets the problem that the budget lacks memory for the surface. Returns GD_BUDGET. */
static enum gd_status build_refuse_budget(const struct server_builder *builder, size_t bytes)
{
    char noun[64];
    snprintf(noun, sizeof noun, "the %s", builder->record->kind->noun);
    server_budget_refuse(builder->budget, noun, bytes, builder->problem);
    return GD_BUDGET;
}

enum gd_status server_build_take(const struct server_builder *builder, size_t bytes)
{
    bool is_taken = server_budget_take(builder->budget, SERVER_BUDGET_FLIGHT, bytes);
    return is_taken ? GD_OK : build_refuse_budget(builder, bytes);
}

enum gd_status server_build_refuse(const struct server_builder *builder, enum gd_status status,
                                   const struct gd_detail *detail)
{
    if (status == GD_BUDGET) return build_refuse_budget(builder, 0);
    proto_problem_from_status(builder->problem, status, detail);
    if (status == GD_TOO_LARGE) proto_problem_limit(builder->problem, builder->max_faces);
    return status;
}

enum gd_status server_build_surface(const struct server_builder *builder,
                                    struct server_surface **out)
{
    struct server_record *record = builder->record;
    struct server_builder own = *builder;
    struct server_built built = {0};
    uint64_t deadline_ns = builder->control.deadline_ns;
    if (builder->workers && record->size >= SHARED_BYTES)
        own.control.executor =
            server_executor_start(builder->workers, 2, deadline_ns ? deadline_ns : UINT64_MAX);
    enum gd_status status = record->kind->build(&own, &built);
    server_executor_stop(own.control.executor);
    if (status) return status;
    *out = server_surface_create(record, built.object, built.size, builder->budget, builder->cache);
    if (*out) return GD_OK;
    record->kind->release(built.object);
    server_budget_give(builder->budget, SERVER_BUDGET_FLIGHT, built.size);
    return server_build_refuse(builder, GD_NO_MEMORY, NULL);
}
