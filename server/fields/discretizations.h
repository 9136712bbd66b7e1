/* Discretizations: cached grids and meshes of subdivision surfaces, for traces and paths. Each
 * level has at most one grid and one mesh.
 *
 *     status = server_discretizations_get(discretizations, &wanted, &fine);
 *     ... fine->mesh ...
 *     server_discretization_release(fine);
 *
 * DESIGN. A surface has a *slot*, with one grid and one mesh for each level. The first request that
 * finds a level missing builds it. Other requests wait in their workers and check their deadlines
 * every few milliseconds. If the builder fails, a waiting request becomes the builder. The built
 * grids and meshes are kept in a list (lru.h), and evicted before any mesh of a client, because a
 * rebuild takes less than a second. All functions are thread-safe. */
#pragma once

#include "gd/limit_grid.h"
#include "server/fields/lru.h"
#include "server/work/budgeted_call.h"

struct server_discretizations;

struct server_discretization {
    struct server_lru_item item; /* must be the first member */
    struct gd_limit_mesh *mesh;  /* NULL means that the discretization is a grid */
    struct gd_limit_grid *grid;
};

/* items of a slot: the meshes of all levels, then the grids */
#define SERVER_DISCRETIZATION_PLACES (2 * (GD_LIMIT_LEVEL_MOST + 1))

struct server_discretization_slot {                 /* slot of one surface; all zero means empty */
    _Atomic(struct server_discretizations *) owner; /* NULL until a request uses the slot */
    /* guarded by the owner's lock: */
    struct server_lru_item *levels[SERVER_DISCRETIZATION_PLACES]; /* NULL if not kept */
    bool is_building[SERVER_DISCRETIZATION_PLACES];
};

/* Creates a cache of meshes with at most `max_faces` faces. The cache registers as a reclaimer of
 * the budget. Returns NULL if out of memory. */
struct server_discretizations *server_discretizations_create(struct server_workspaces *workspaces,
                                                             uint32_t max_faces);

/* Call this function when all slots are closed. NULL is allowed. */
void server_discretizations_destroy(struct server_discretizations *discretizations);

struct server_discretization_request {       /* all borrowed for the call */
    struct server_discretization_slot *slot; /* slot of the surface */
    const struct gd_subdivision *surface;
    uint32_t level;            /* <= GD_LIMIT_LEVEL_MOST */
    bool wants_grid;           /* true for a grid, false for a mesh */
    struct gd_control control; /* its budget and its workspace must be unset */
    struct gd_detail *detail;
};

/* Finds or builds a discretization, which the caller releases. Call this function on a worker,
 * because it may take a second. Errors: those of gd_limit_mesh_build or gd_limit_grid_build;
 * GD_BUDGET (all available memory is too little). */
GD_MUST_USE enum gd_status
server_discretizations_get(struct server_discretizations *discretizations,
                           const struct server_discretization_request *request,
                           struct server_discretization **out);
/* NULL is allowed. */
void server_discretization_release(struct server_discretization *discretization);

/* Empties the slot of a surface that no request uses any more. */
void server_discretization_slot_close(struct server_discretization_slot *slot);
