#include "server/work/budgeted_call.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/thread.h"

#define GRANT_FACTOR 4                  /* growth of the grant from one attempt to the next */
#define PATIENCE_NS  UINT64_C(10000000) /* time between two checks of a waiting call's deadline */

struct server_workspaces {
    struct server_budget *budget;
    pthread_mutex_t lock;
    pthread_cond_t none_runs; /* signalled when no call runs because all of them wait */
    uint32_t running;         /* number of calls that may take memory, without those that wait */
    uint32_t count, most;
    struct server_space idle[]; /* entry count - 1 was used last */
};

static void space_destroy(struct server_workspaces *workspaces, struct server_space space)
{
    gd_workspace_destroy(space.workspace);
    server_budget_give(workspaces->budget, SERVER_BUDGET_WORKSPACES, space.bytes);
}

/* Frees idle workspaces, the longest idle first. */
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
    pthread_cond_init(&workspaces->none_runs, NULL);
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
    pthread_cond_destroy(&workspaces->none_runs);
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

/* Counts the bytes as idle before other threads can borrow the workspace. */
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

static void call_trim(struct server_budgeted_call *call)
{
    if (call->space.workspace) gd_workspace_trim(call->space.workspace);
    server_budget_give(call->workspaces->budget, SERVER_BUDGET_FLIGHT, call->space.bytes);
    call->space.bytes = 0;
}

/* Returns true if the bytes can be taken. Frees the workspace's memory only if that is
 * necessary. */
static bool call_can_take(struct server_budgeted_call *call, size_t bytes)
{
    struct server_budget *budget = call->workspaces->budget;
    if (server_budget_could_take(budget, bytes)) return true;
    call_trim(call);
    return server_budget_could_take(budget, bytes);
}

static void running_change(struct server_workspaces *workspaces, int change)
{
    SERVER_LOCK(&workspaces->lock);
    workspaces->running += (uint32_t)change;
    if (!workspaces->running) pthread_cond_broadcast(&workspaces->none_runs);
}

static bool other_calls_run(struct server_workspaces *workspaces)
{
    SERVER_LOCK(&workspaces->lock);
    return workspaces->running > 1;
}

/* Blocks until no other call runs. If several calls wait, one of them continues. Errors:
 * GD_DEADLINE, GD_CANCELLED. */
static enum gd_status other_calls_wait(struct server_workspaces *workspaces,
                                       const struct gd_control *control)
{
    enum gd_status status;
    SERVER_LOCK(&workspaces->lock);
    if (!--workspaces->running) pthread_cond_broadcast(&workspaces->none_runs);
    while (!(status = gd_control_check(control, 0)) && workspaces->running)
        (void)server_condition_wait(&workspaces->none_runs, &workspaces->lock,
                                    gd_now_ns() + PATIENCE_NS);
    workspaces->running++;
    return status;
}

/* Takes the memory of an attempt: the grant, or all available memory if that is less. Fails if no
 * memory is left, because the engine regards a budget of 0 as no limit. */
static bool call_attempt_begin(struct server_budgeted_call *call)
{
    struct server_budget *budget = call->workspaces->budget;
    size_t bytes = call->grant + call->aside;
    bool others = other_calls_run(call->workspaces);
    bool has_grant = call_can_take(call, bytes);
    if (!has_grant) bytes = server_budget_available(budget);
    call->is_crowded = !has_grant && (others || other_calls_run(call->workspaces));
    call->is_last = !has_grant && !call->is_crowded;
    if (bytes <= call->aside || !(call->is_modest ? server_budget_take_spare : server_budget_take)(
                                    budget, SERVER_BUDGET_FLIGHT, bytes))
        return false;
    call->taken = bytes;
    call->control.budget_bytes = bytes - call->aside;
    call->control.workspace = call->space.workspace;
    call->status = GD_OK;
    call->kept = 0;
    return true;
}

/* Ends an attempt, and returns to the budget the bytes that are not used any more. Until this call,
 * the budget counts the workspace twice: by itself and as a part of the grant. */
static void call_attempt_end(struct server_budgeted_call *call)
{
    struct server_space *space = &call->space;
    size_t left = space->workspace ? gd_workspace_bytes(space->workspace) : 0;
    if (call->status) call->kept = 0;
    server_budget_adjust(call->workspaces->budget, SERVER_BUDGET_FLIGHT, call->taken + space->bytes,
                         call->kept + left);
    space->bytes = left;
    call->taken = 0;
}

/* Prepares the next attempt after an attempt that had too little memory. Returns false if there is
 * no further attempt. */
static bool call_attempt_prepare(struct server_budgeted_call *call)
{
    call->status = GD_BUDGET;
    if (call->is_modest || call->is_last) return false;
    if (!call->is_crowded) {
        call->grant *= GRANT_FACTOR;
        return true;
    }
    call_trim(call);
    call->status = other_calls_wait(call->workspaces, &call->control);
    return !call->status;
}

bool server_budgeted_call_next(struct server_budgeted_call *call)
{
    bool goes_on = true;
    if (call->taken) {
        call_attempt_end(call);
        goes_on = call->status == GD_BUDGET && call_attempt_prepare(call);
    } else {
        running_change(call->workspaces, 1);
        call->space = workspaces_borrow(call->workspaces);
    }
    for (; goes_on; goes_on = call_attempt_prepare(call))
        if (call_attempt_begin(call)) return true;
    workspaces_return(call->workspaces, call->space);
    running_change(call->workspaces, -1);
    if (call->held) *call->held += call->kept;
    return false;
}
