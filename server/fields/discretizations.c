#include "server/fields/discretizations.h"

#include <pthread.h>
#include <stdlib.h>

#include "server/base/thread.h"
#include "server/work/budgeted_call.h"

#define LOOK_NS 5000000 /* between two checks of a waiting request's deadline */

struct server_discretizations {
    struct server_workspaces *workspaces;
    struct server_budget *budget;
    uint32_t max_faces;
    pthread_mutex_t lock;
    pthread_cond_t build_ended;
    TAILQ_HEAD(, server_discretization) by_use; /* the least recently used first */
};

void server_discretization_release(struct server_discretization *discretization)
{
    if (!discretization || atomic_fetch_sub(&discretization->references, 1) != 1) return;
    gd_limit_mesh_free(discretization->mesh);
    server_budget_give(discretization->budget, SERVER_BUDGET_DISCRETIZATIONS,
                       discretization->bytes);
    free(discretization);
}

/* Under the lock: removes a cached discretization, for the caller to release without the lock. */
static void discretization_drop(struct server_discretizations *owner,
                                struct server_discretization *kept)
{
    kept->slot->levels[gd_limit_mesh_level(kept->mesh)] = NULL;
    TAILQ_REMOVE(&owner->by_use, kept, by_use);
}

static void discretizations_reclaim(void *user, size_t bytes)
{
    struct server_discretizations *owner = user;
    for (size_t freed = 0; freed < bytes;) {
        pthread_mutex_lock(&owner->lock);
        struct server_discretization *coldest = TAILQ_FIRST(&owner->by_use);
        if (coldest) discretization_drop(owner, coldest);
        pthread_mutex_unlock(&owner->lock);
        if (!coldest) return;
        freed += coldest->bytes;
        server_discretization_release(coldest);
    }
}

/* Builds a level. Its cost may exceed the budget, since the engine refuses a mesh of too many faces
 * before it takes any memory. */
static enum gd_status level_build(struct server_discretizations *owner,
                                  const struct server_discretization_request *request,
                                  struct server_discretization **out)
{
    struct server_budget *budget = owner->budget;
    struct gd_limit_mesh *mesh;
    size_t cost = gd_limit_mesh_cost(request->surface, request->level);
    struct server_budgeted_call call = {.workspaces = owner->workspaces,
                                        .control = request->control,
                                        .grant = cost < budget->limit ? cost : budget->limit / 2};
    while (server_budgeted_call_next(&call)) {
        call.status = gd_limit_mesh_build(
            request->surface, &(struct gd_limit_mesh_options){request->level, owner->max_faces},
            &call.control, &mesh, request->detail);
        if (!call.status) call.kept = gd_limit_mesh_memsize(mesh);
    }
    if (call.status) return call.status;
    struct server_discretization *built = malloc(sizeof *built);
    if (!built) {
        gd_limit_mesh_free(mesh);
        server_budget_give(budget, SERVER_BUDGET_FLIGHT, call.kept);
        return GD_NO_MEMORY;
    }
    server_budget_move(budget, SERVER_BUDGET_FLIGHT, SERVER_BUDGET_DISCRETIZATIONS, call.kept);
    *built = (struct server_discretization){
        .references = 1, .mesh = mesh, .budget = budget, .bytes = call.kept};
    *out = built;
    return GD_OK;
}

/* Finds the level, or claims its build (NULL). False: another request still builds it. */
static bool level_find_or_claim(struct server_discretizations *owner,
                                const struct server_discretization_request *request,
                                struct server_discretization **out)
{
    bool *is_building = &request->slot->is_building[request->level];
    struct server_discretization *kept = NULL;
    pthread_mutex_lock(&owner->lock);
    if (*is_building)
        server_condition_wait(&owner->build_ended, &owner->lock, gd_now_ns() + LOOK_NS);
    bool is_settled = !*is_building;
    if (is_settled) kept = request->slot->levels[request->level];
    if (kept) {
        TAILQ_REMOVE(&owner->by_use, kept, by_use);
        TAILQ_INSERT_TAIL(&owner->by_use, kept, by_use);
        atomic_fetch_add(&kept->references, 1);
    } else {
        *is_building = true;
    }
    pthread_mutex_unlock(&owner->lock);
    *out = kept;
    return is_settled;
}

enum gd_status server_discretizations_get(struct server_discretizations *owner,
                                          const struct server_discretization_request *request,
                                          struct server_discretization **out)
{
    struct server_discretization *found = NULL;
    enum gd_status status = GD_OK;
    atomic_store(&request->slot->owner, owner);
    while (!level_find_or_claim(owner, request, &found)) {
        status = gd_control_check(&request->control, 0);
        if (status) return status;
    }
    if (!found) {
        status = level_build(owner, request, &found);
        pthread_mutex_lock(&owner->lock);
        request->slot->is_building[request->level] = false;
        if (!status) {
            found->slot = request->slot;
            request->slot->levels[request->level] = found;
            atomic_fetch_add(&found->references, 1);
            TAILQ_INSERT_TAIL(&owner->by_use, found, by_use);
        }
        pthread_cond_broadcast(&owner->build_ended);
        pthread_mutex_unlock(&owner->lock);
    }
    if (!status) *out = found;
    return status;
}

void server_discretization_slot_close(struct server_discretization_slot *slot)
{
    struct server_discretizations *owner = atomic_load(&slot->owner);
    struct server_discretization *kept[GD_LIMIT_LEVEL_MOST + 1];
    if (!owner) return;
    pthread_mutex_lock(&owner->lock);
    for (uint32_t level = 0; level <= GD_LIMIT_LEVEL_MOST; level++) {
        kept[level] = slot->levels[level];
        if (kept[level]) discretization_drop(owner, kept[level]);
    }
    pthread_mutex_unlock(&owner->lock);
    for (uint32_t level = 0; level <= GD_LIMIT_LEVEL_MOST; level++)
        server_discretization_release(kept[level]);
}

struct server_discretizations *server_discretizations_create(struct server_workspaces *workspaces,
                                                             uint32_t max_faces)
{
    struct server_discretizations *owner = calloc(1, sizeof *owner);
    if (!owner) return NULL;
    owner->workspaces = workspaces;
    owner->budget = server_workspaces_budget(workspaces);
    owner->max_faces = max_faces;
    TAILQ_INIT(&owner->by_use);
    pthread_mutex_init(&owner->lock, NULL);
    pthread_cond_init(&owner->build_ended, NULL);
    owner->budget->reclaimers[SERVER_RECLAIM_DISCRETIZATIONS] =
        (struct server_reclaimer){.reclaim = discretizations_reclaim, .user = owner};
    return owner;
}

void server_discretizations_destroy(struct server_discretizations *owner)
{
    if (!owner) return;
    owner->budget->reclaimers[SERVER_RECLAIM_DISCRETIZATIONS] = (struct server_reclaimer){0};
    pthread_cond_destroy(&owner->build_ended);
    pthread_mutex_destroy(&owner->lock);
    free(owner);
}
