/* See budgeted_call.h. */
#include "server/work/budgeted_call.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#define GRANT_FACTOR 4 /* from one attempt to the next */

struct server_workspaces {
    struct server_budget *budget;
    pthread_mutex_t lock;
    uint32_t count, most;
    struct server_space idle[]; /* [count - 1] was used last */
};

static void space_destroy(struct server_workspaces *workspaces, struct server_space space)
{
    gd_workspace_destroy(space.workspace);
    server_budget_give(workspaces->budget, SERVER_BUDGET_WORKSPACES, space.bytes);
}

/* The workspace that was idle for longest goes first. */
static void workspaces_reclaim(void *user, size_t bytes)
{
    struct server_workspaces *workspaces = user;
    struct server_space oldest = {0};
    for (size_t freed = 0; freed < bytes; freed += oldest.bytes) {
        pthread_mutex_lock(&workspaces->lock);
        bool is_found = workspaces->count > 0;
        if (is_found) {
            oldest = workspaces->idle[0];
            workspaces->count--;
            memmove(workspaces->idle, workspaces->idle + 1, workspaces->count * sizeof oldest);
        }
        pthread_mutex_unlock(&workspaces->lock);
        if (!is_found) return;
        space_destroy(workspaces, oldest);
    }
}

struct server_workspaces *server_workspaces_create(struct server_budget *budget, uint32_t most)
{
    struct server_workspaces *workspaces =
        calloc(1, sizeof *workspaces + most * sizeof workspaces->idle[0]);
    if (!workspaces) return NULL;
    pthread_mutex_init(&workspaces->lock, NULL);
    workspaces->budget = budget;
    workspaces->most = most;
    budget->reclaimers[SERVER_RECLAIM_WORKSPACES] =
        (struct server_reclaimer){workspaces_reclaim, NULL, workspaces};
    return workspaces;
}

struct server_budget *server_workspaces_budget(const struct server_workspaces *workspaces)
{
    return workspaces->budget;
}

void server_workspaces_destroy(struct server_workspaces *workspaces)
{
    if (!workspaces) return;
    workspaces->budget->reclaimers[SERVER_RECLAIM_WORKSPACES] = (struct server_reclaimer){0};
    workspaces_reclaim(workspaces, SIZE_MAX);
    pthread_mutex_destroy(&workspaces->lock);
    free(workspaces);
}

static struct server_space workspaces_borrow(struct server_workspaces *workspaces)
{
    struct server_space space = {0};
    pthread_mutex_lock(&workspaces->lock);
    if (workspaces->count) space = workspaces->idle[--workspaces->count];
    pthread_mutex_unlock(&workspaces->lock);
    if (!space.workspace) return (struct server_space){.workspace = gd_workspace_create()};
    server_budget_move(workspaces->budget, SERVER_BUDGET_WORKSPACES, SERVER_BUDGET_FLIGHT,
                       space.bytes);
    return space;
}

/* Its bytes count as idle before other threads can see it. */
static void workspaces_return(struct server_workspaces *workspaces, struct server_space space)
{
    server_budget_move(workspaces->budget, SERVER_BUDGET_FLIGHT, SERVER_BUDGET_WORKSPACES,
                       space.bytes);
    pthread_mutex_lock(&workspaces->lock);
    bool is_kept = space.workspace && workspaces->count < workspaces->most;
    if (is_kept) workspaces->idle[workspaces->count++] = space;
    pthread_mutex_unlock(&workspaces->lock);
    if (!is_kept) space_destroy(workspaces, space);
}

/* Frees the memory of the workspace only when the budget is too small for the grant otherwise. */
static bool call_can_take(struct server_budget *budget, struct server_space *space, size_t grant)
{
    if (server_budget_could_take(budget, grant)) return true;
    if (space->workspace) gd_workspace_trim(space->workspace);
    server_budget_give(budget, SERVER_BUDGET_FLIGHT, space->bytes);
    space->bytes = 0;
    return server_budget_could_take(budget, grant);
}

/* Takes the memory of an attempt; the last one has all that can be had. To the engine, a grant of 0
 * is no limit. */
static bool attempt_begin(struct server_budgeted_call *call)
{
    struct server_budget *budget = call->workspaces->budget;
    call->is_last = !call_can_take(budget, &call->space, call->grant);
    if (call->is_last) call->grant = server_budget_available(budget);
    size_t bytes = call->grant + call->aside;
    if (!call->grant || !(call->is_modest ? server_budget_take_spare : server_budget_take)(
                            budget, SERVER_BUDGET_FLIGHT, bytes))
        return false;
    call->taken = bytes;
    call->control.budget_bytes = call->grant;
    call->control.workspace = call->space.workspace;
    call->status = GD_OK;
    call->kept = 0;
    return true;
}

/* The workspace counts beside the grant: its old memory and what the call allocates overlap, but
 * only the engine knows by how much. */
static void attempt_end(struct server_budgeted_call *call)
{
    struct server_space *space = &call->space;
    size_t left = space->workspace ? gd_workspace_bytes(space->workspace) : 0;
    if (call->status) call->kept = 0;
    server_budget_adjust(call->workspaces->budget, SERVER_BUDGET_FLIGHT, call->taken + space->bytes,
                         call->kept + left);
    space->bytes = left;
    call->taken = 0;
}

bool server_budgeted_call_next(struct server_budgeted_call *call)
{
    bool goes_on = !call->taken;
    if (goes_on) {
        call->space = workspaces_borrow(call->workspaces);
    } else {
        attempt_end(call);
        goes_on = call->status == GD_BUDGET && !call->is_modest && !call->is_last;
        call->grant *= GRANT_FACTOR;
    }
    for (; goes_on; call->grant *= GRANT_FACTOR) {
        if (attempt_begin(call)) return true;
        call->status = GD_BUDGET;
        goes_on = !call->is_last && !call->is_modest;
    }
    workspaces_return(call->workspaces, call->space);
    if (call->held) *call->held += call->kept;
    return false;
}
