/* See discretizations.h. */
#include "server/surfaces/discretizations.h"

#include <pthread.h>
#include <stdlib.h>
#include <time.h>

#include "server/server.h"
#include "server/work/budgeted_call.h"
#include "server/http/exchange.h"

#define LOOK_NS 5000000 /* between two looks at the deadline of who waits */

struct server_discretizations {
    struct server *server;
    pthread_mutex_t lock;
    pthread_cond_t built; /* or not: somebody has ended a build */
    struct server_discretization *coldest, *warmest;
};

/* --- one -------------------------------------------------------------------------------------- */

void server_discretization_release(struct server_discretization *discretization)
{
    if (!discretization || atomic_fetch_sub(&discretization->references, 1) != 1) return;
    gd_limit_mesh_free(discretization->mesh);
    server_budget_give(discretization->budget, SERVER_BUDGET_DISCRETIZATIONS,
                       discretization->bytes);
    free(discretization);
}

/* Takes over the mesh and its bytes, in flight so far. NULL without memory: both are gone. */
static struct server_discretization *create(struct server_budget *budget,
                                            struct gd_limit_mesh *mesh)
{
    struct server_discretization *made = malloc(sizeof *made);
    size_t bytes = gd_limit_mesh_memsize(mesh);
    if (!made) {
        gd_limit_mesh_free(mesh);
        server_budget_give(budget, SERVER_BUDGET_FLIGHT, bytes);
        return NULL;
    }
    server_budget_move(budget, SERVER_BUDGET_FLIGHT, SERVER_BUDGET_DISCRETIZATIONS, bytes);
    *made = (struct server_discretization){
        .references = 1, .mesh = mesh, .budget = budget, .bytes = bytes};
    return made;
}

static struct server_discretization *retain(struct server_discretization *discretization)
{
    atomic_fetch_add(&discretization->references, 1);
    return discretization;
}

/* --- the order of use, under the lock --------------------------------------------------------- */

static void link_warmest(struct server_discretizations *owner, struct server_discretization *kept)
{
    kept->warmer = NULL;
    kept->colder = owner->warmest;
    *(kept->colder ? &kept->colder->warmer : &owner->coldest) = kept;
    owner->warmest = kept;
}

static void unlink_kept(struct server_discretizations *owner, struct server_discretization *kept)
{
    *(kept->colder ? &kept->colder->warmer : &owner->coldest) = kept->warmer;
    *(kept->warmer ? &kept->warmer->colder : &owner->warmest) = kept->colder;
}

/* Takes it out of its slot; its reference is the caller's to release after the lock. */
static struct server_discretization *drop(struct server_discretizations *owner,
                                          struct server_discretization *kept)
{
    kept->slot->levels[gd_limit_mesh_level(kept->mesh)] = NULL;
    unlink_kept(owner, kept);
    return kept;
}

static void keep(struct server_discretizations *owner, struct server_discretization_slot *slot,
                 struct server_discretization *made)
{
    made->slot = slot;
    slot->levels[gd_limit_mesh_level(made->mesh)] = retain(made);
    link_warmest(owner, made);
}

/* --- under pressure --------------------------------------------------------------------------- */

static struct server_discretization *drop_coldest(struct server_discretizations *owner)
{
    pthread_mutex_lock(&owner->lock);
    struct server_discretization *kept = owner->coldest ? drop(owner, owner->coldest) : NULL;
    pthread_mutex_unlock(&owner->lock);
    return kept;
}

static void reclaim(void *user, size_t bytes)
{
    struct server_discretizations *owner = user;
    struct server_discretization *kept;
    for (size_t freed = 0; freed < bytes && (kept = drop_coldest(owner));
         server_discretization_release(kept))
        freed += kept->bytes;
}

/* --- building --------------------------------------------------------------------------------- */

struct building {
    const struct server_discretization_request *request;
    uint32_t max_faces;
    struct gd_limit_mesh *mesh;
};

static enum gd_status build_mesh(void *user, const struct gd_control *control, size_t *kept)
{
    struct building *building = user;
    const struct server_discretization_request *request = building->request;
    enum gd_status status =
        gd_limit_mesh_build(request->surface, request->level, building->max_faces, control,
                            &building->mesh, request->detail);
    if (!status) *kept = gd_limit_mesh_memsize(building->mesh);
    return status;
}

/* What is too large for a mesh is refused by the engine, before it takes any memory. */
static size_t grant_for(const struct server_discretization_request *request,
                        const struct server_budget *budget)
{
    size_t cost = gd_limit_mesh_cost(request->surface, request->level);
    return cost < budget->limit ? cost : budget->limit / 2;
}

static enum gd_status build(struct server *server,
                            const struct server_discretization_request *request,
                            struct server_discretization **out)
{
    struct building building = {.request = request,
                                .max_faces = (uint32_t)server->config.max_faces};
    const struct server_budgeted_call call = {.make = build_mesh,
                                              .user = &building,
                                              .control = server_exchange_control(request->monitor),
                                              .grant = grant_for(request, &server->budget)};
    enum gd_status status = server_budgeted_call_run(server->workspaces, &call);
    if (status) return status;
    *out = create(&server->budget, building.mesh);
    return *out ? GD_OK : GD_NO_MEMORY;
}

/* --- asking ----------------------------------------------------------------------------------- */

/* For a few milliseconds at most, under the lock. */
static void wait_a_little(struct server_discretizations *owner)
{
    struct timespec until;
    clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_nsec += LOOK_NS;
    if (until.tv_nsec >= 1000000000) {
        until.tv_nsec -= 1000000000;
        until.tv_sec++;
    }
    pthread_cond_timedwait(&owner->built, &owner->lock, &until);
}

/* One look: the kept one, or NULL with the level claimed to be built. False: somebody else builds
 * it still, after a little wait. */
static bool look(struct server_discretizations *owner,
                 const struct server_discretization_request *request,
                 struct server_discretization **out)
{
    struct server_discretization_slot *slot = request->slot;
    pthread_mutex_lock(&owner->lock);
    if (slot->is_building[request->level]) wait_a_little(owner);
    bool is_settled = !slot->is_building[request->level];
    struct server_discretization *kept = is_settled ? slot->levels[request->level] : NULL;
    if (kept) {
        unlink_kept(owner, kept);
        link_warmest(owner, kept);
        retain(kept);
    } else if (is_settled) {
        slot->is_building[request->level] = true;
    }
    pthread_mutex_unlock(&owner->lock);
    *out = kept;
    return is_settled;
}

/* Looks until it is settled, or a status: who waits is late. */
static enum gd_status find_or_claim(struct server_discretizations *owner,
                                    const struct server_discretization_request *request,
                                    struct server_discretization **out)
{
    const struct gd_control control = server_exchange_control(request->monitor);
    enum gd_status status = GD_OK;
    while (!status && !look(owner, request, out)) status = gd_control_check(&control, 0);
    return status;
}

enum gd_status server_discretizations_get(struct server_discretizations *owner,
                                          const struct server_discretization_request *request,
                                          struct server_discretization **out)
{
    struct server_discretization *found;
    atomic_store(&request->slot->owner, owner);
    enum gd_status status = find_or_claim(owner, request, &found);
    if (status) return status;
    if (!found) {
        status = build(owner->server, request, &found);
        pthread_mutex_lock(&owner->lock);
        request->slot->is_building[request->level] = false;
        if (!status) keep(owner, request->slot, found);
        pthread_cond_broadcast(&owner->built);
        pthread_mutex_unlock(&owner->lock);
    }
    if (!status) *out = found;
    return status;
}

void server_discretization_slot_close(struct server_discretization_slot *slot)
{
    struct server_discretizations *owner = atomic_load(&slot->owner);
    struct server_discretization *kept[GD_LIMIT_LEVEL_MOST + 1] = {NULL};
    if (!owner) return;
    pthread_mutex_lock(&owner->lock);
    for (uint32_t level = 0; level <= GD_LIMIT_LEVEL_MOST; level++)
        if (slot->levels[level]) kept[level] = drop(owner, slot->levels[level]);
    pthread_mutex_unlock(&owner->lock);
    for (uint32_t level = 0; level <= GD_LIMIT_LEVEL_MOST; level++)
        server_discretization_release(kept[level]);
}

/* --- the whole -------------------------------------------------------------------------------- */

struct server_discretizations *server_discretizations_create(struct server *server)
{
    struct server_discretizations *owner = calloc(1, sizeof *owner);
    pthread_condattr_t attributes;
    if (!owner) return NULL;
    owner->server = server;
    pthread_mutex_init(&owner->lock, NULL);
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_cond_init(&owner->built, &attributes);
    pthread_condattr_destroy(&attributes);
    server->budget.reclaimers[SERVER_RECLAIM_DISCRETIZATIONS] =
        (struct server_reclaimer){.reclaim = reclaim, .user = owner};
    return owner;
}

void server_discretizations_destroy(struct server_discretizations *owner)
{
    if (!owner) return;
    owner->server->budget.reclaimers[SERVER_RECLAIM_DISCRETIZATIONS] = (struct server_reclaimer){0};
    pthread_cond_destroy(&owner->built);
    pthread_mutex_destroy(&owner->lock);
    free(owner);
}
