#include "server/fields/discretizations.h"

#include <pthread.h>
#include <stdlib.h>

#include "server/base/thread.h"
#include "server/work/budgeted_call.h"

#define LOOK_NS 5000000 /* time between two checks of a waiting request's deadline */

struct server_discretizations {
    struct server_lru lru; /* must be the first member */
    struct server_workspaces *workspaces;
    uint32_t max_faces;
    pthread_cond_t build_ended;
};

static void discretization_free(struct server_lru_item *item)
{
    struct server_discretization *discretization = (struct server_discretization *)item;
    gd_limit_mesh_free(discretization->mesh);
    gd_limit_grid_free(discretization->grid);
    free(discretization);
}

/* Builds a level. The cost may exceed the whole budget. That is harmless, because the engine
 * refuses a mesh of too many faces before it allocates memory. */
static enum gd_status level_build(struct server_discretizations *owner,
                                  const struct server_discretization_request *request,
                                  struct server_lru_item **out)
{
    struct server_budget *budget = owner->lru.budget;
    const struct gd_limit_mesh_options options = {request->level, owner->max_faces};
    struct gd_limit_mesh *mesh = NULL;
    struct gd_limit_grid *grid = NULL;
    size_t cost = request->wants_grid ? gd_limit_grid_cost(request->surface, request->level)
                                      : gd_limit_mesh_cost(request->surface, request->level);
    struct server_budgeted_call call = {.workspaces = owner->workspaces,
                                        .control = request->control,
                                        .grant = cost < budget->limit ? cost : budget->limit / 2};
    while (server_budgeted_call_next(&call)) {
        call.status = request->wants_grid
                          ? gd_limit_grid_build(request->surface, &options, &call.control, &grid,
                                                request->detail)
                          : gd_limit_mesh_build(request->surface, &options, &call.control, &mesh,
                                                request->detail);
        if (!call.status)
            call.kept = grid ? gd_limit_grid_memsize(grid) : gd_limit_mesh_memsize(mesh);
    }
    if (call.status) return call.status;
    struct server_discretization *built = malloc(sizeof *built);
    if (!built) {
        gd_limit_mesh_free(mesh);
        gd_limit_grid_free(grid);
        server_budget_give(budget, SERVER_BUDGET_FLIGHT, call.kept);
        return GD_NO_MEMORY;
    }
    built->mesh = mesh;
    built->grid = grid;
    server_lru_adopt(&owner->lru, &built->item, call.kept);
    *out = &built->item;
    return GD_OK;
}

static uint32_t place_of(const struct server_discretization_request *request)
{
    return request->level + (request->wants_grid ? GD_LIMIT_LEVEL_MOST + 1 : 0);
}

/* Finds the level, or claims its build and sets *out to NULL. Returns false while another request
 * builds the level. */
static bool level_find_or_claim(struct server_discretizations *owner,
                                const struct server_discretization_request *request,
                                struct server_lru_item **out)
{
    bool *is_building = &request->slot->is_building[place_of(request)];
    SERVER_LOCK(&owner->lru.lock);
    if (*is_building)
        server_condition_wait(&owner->build_ended, &owner->lru.lock, gd_now_ns() + LOOK_NS);
    if (*is_building) return false;
    *out = server_lru_get(&request->slot->levels[place_of(request)]);
    *is_building = !*out;
    return true;
}

enum gd_status server_discretizations_get(struct server_discretizations *owner,
                                          const struct server_discretization_request *request,
                                          struct server_discretization **out)
{
    struct server_lru_item *found = NULL, **place = &request->slot->levels[place_of(request)];
    enum gd_status status = GD_OK;
    atomic_store(&request->slot->owner, owner);
    while (!level_find_or_claim(owner, request, &found)) {
        status = gd_control_check(&request->control, 0);
        if (status) return status;
    }
    if (!found) {
        status = level_build(owner, request, &found);
        pthread_mutex_lock(&owner->lru.lock);
        request->slot->is_building[place_of(request)] = false;
        if (!status) {
            server_lru_put(place, found);
            found = server_lru_get(place);
        }
        pthread_cond_broadcast(&owner->build_ended);
        pthread_mutex_unlock(&owner->lru.lock);
    }
    if (!status) *out = (struct server_discretization *)found;
    return status;
}

void server_discretization_release(struct server_discretization *discretization)
{
    if (discretization) server_lru_release(&discretization->item);
}

void server_discretization_slot_close(struct server_discretization_slot *slot)
{
    struct server_discretizations *owner = atomic_load(&slot->owner);
    for (uint32_t i = 0; owner && i < SERVER_DISCRETIZATION_PLACES; i++) {
        pthread_mutex_lock(&owner->lru.lock);
        struct server_lru_item *kept = server_lru_take(&slot->levels[i]);
        pthread_mutex_unlock(&owner->lru.lock);
        server_lru_release(kept);
    }
}

struct server_discretizations *server_discretizations_create(struct server_workspaces *workspaces,
                                                             uint32_t max_faces)
{
    struct server_discretizations *owner = calloc(1, sizeof *owner);
    if (!owner) return NULL;
    owner->lru = (struct server_lru){.budget = server_workspaces_budget(workspaces),
                                     .class = SERVER_BUDGET_DISCRETIZATIONS,
                                     .turn = SERVER_RECLAIM_DISCRETIZATIONS,
                                     .free = discretization_free};
    owner->workspaces = workspaces;
    owner->max_faces = max_faces;
    server_lru_begin(&owner->lru);
    pthread_cond_init(&owner->build_ended, NULL);
    return owner;
}

void server_discretizations_destroy(struct server_discretizations *owner)
{
    if (!owner) return;
    pthread_cond_destroy(&owner->build_ended);
    server_lru_end(&owner->lru);
    free(owner);
}
