/* Discretizations: the meshes of levels of subdivision surfaces, kept so that traces and paths do
 * not build them each time.
 *
 *     struct server_discretization *fine;
 *     status = server_discretizations_get(discretizations, &wanted, &fine);
 *     ... fine->mesh ...
 *     server_discretization_release(fine);
 *
 * DESIGN. A surface has a *slot* with room for each level. Who finds a level missing builds it; who
 * asks for it meanwhile waits in his worker, and looks at his own deadline every few milliseconds;
 * when the builder fails, one of those who wait builds in his place.
 *
 * Memory: taken before it is built; what is kept is SERVER_BUDGET_DISCRETIZATIONS until the last
 * request that uses it has ended. Under pressure those go that were not used for longest, before
 * any mesh: they can be built again within a second.
 *
 * One mutex guards slots and their order; under it nothing calls out. All functions are
 * thread-safe. */
#ifndef SERVER_SURFACES_DISCRETIZATIONS_H
#define SERVER_SURFACES_DISCRETIZATIONS_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gd/limit_mesh.h"
#include "server/work/budget.h"

struct server;
struct server_monitor;
struct server_discretizations;

struct server_discretization {
    atomic_uint references;
    struct gd_limit_mesh *mesh;
    struct server_budget *budget;
    size_t bytes;
    /* under the owner's lock, while it is kept: */
    struct server_discretization_slot *slot;
    struct server_discretization *colder, *warmer; /* neighbours in the order of use */
};

/* Of one surface; all-zero: empty. */
struct server_discretization_slot {
    _Atomic(struct server_discretizations *) owner; /* NULL: never asked for */
    /* under the owner's lock: */
    struct server_discretization *levels[GD_LIMIT_LEVEL_MOST + 1]; /* NULL: not kept */
    bool is_building[GD_LIMIT_LEVEL_MOST + 1];
};

/* Becomes a part of the server's budget, to reclaim from. The server is borrowed. NULL without
 * memory. */
struct server_discretizations *server_discretizations_create(struct server *server);

/* All slots are closed. NULL is harmless. */
void server_discretizations_destroy(struct server_discretizations *discretizations);

/* One that is asked for; all borrowed for the call. */
struct server_discretization_request {
    struct server_discretization_slot *slot; /* of the surface, which outlives the call */
    const struct gd_subdivision *surface;
    uint32_t level; /* <= GD_LIMIT_LEVEL_MOST */
    struct server_monitor *monitor;
    struct gd_detail *detail;
};

/* To be released. By a worker: it may take a second. Errors: those of gd_limit_mesh_build, for at
 * most --max-faces; GD_BUDGET: not even all that could be had was enough. */
GD_MUST_USE enum gd_status
server_discretizations_get(struct server_discretizations *discretizations,
                           const struct server_discretization_request *request,
                           struct server_discretization **out);
/* NULL is harmless */
void server_discretization_release(struct server_discretization *discretization);

/* Empties the slot; nobody asks for it any more. */
void server_discretization_slot_close(struct server_discretization_slot *slot);

#endif
