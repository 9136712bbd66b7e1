/* See workspaces.h. */
#include "server/work/workspaces.h"

#include <pthread.h>
#include <stdlib.h>

struct server_workspaces {
    struct server_budget *budget;
    pthread_mutex_t lock;
    uint32_t count, most;
    struct server_loan idle[]; /* [count - 1] was used last */
};

/* Destroys a workspace whose bytes are of that class. */
static void discard(struct server_workspaces *workspaces, enum server_budget_class class,
                    struct server_loan loan)
{
    gd_workspace_destroy(loan.workspace);
    server_budget_give(workspaces->budget, class, loan.bytes);
}

/* Takes the one that was idle for longest off the stack; false: there is none. */
static bool take_coldest(struct server_workspaces *workspaces, struct server_loan *out)
{
    pthread_mutex_lock(&workspaces->lock);
    bool found = workspaces->count > 0;
    if (found) {
        *out = workspaces->idle[0];
        workspaces->count--;
        for (uint32_t i = 0; i < workspaces->count; i++)
            workspaces->idle[i] = workspaces->idle[i + 1];
    }
    pthread_mutex_unlock(&workspaces->lock);
    return found;
}

static void reclaim(void *user, size_t bytes)
{
    struct server_workspaces *workspaces = user;
    struct server_loan coldest;
    for (size_t freed = 0; freed < bytes && take_coldest(workspaces, &coldest);
         freed += coldest.bytes)
        discard(workspaces, SERVER_BUDGET_WORKSPACES, coldest);
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
        (struct server_reclaimer){reclaim, NULL, workspaces};
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
    reclaim(workspaces, SIZE_MAX);
    pthread_mutex_destroy(&workspaces->lock);
    free(workspaces);
}

struct server_loan server_workspaces_borrow(struct server_workspaces *workspaces)
{
    struct server_loan loan = {0};
    pthread_mutex_lock(&workspaces->lock);
    if (workspaces->count) loan = workspaces->idle[--workspaces->count];
    pthread_mutex_unlock(&workspaces->lock);
    if (!loan.workspace) return (struct server_loan){.workspace = gd_workspace_create()};
    server_budget_move(workspaces->budget, SERVER_BUDGET_WORKSPACES, SERVER_BUDGET_FLIGHT,
                       loan.bytes);
    return loan;
}

void server_workspaces_trim(struct server_workspaces *workspaces, struct server_loan *loan)
{
    if (loan->workspace) gd_workspace_trim(loan->workspace);
    server_budget_give(workspaces->budget, SERVER_BUDGET_FLIGHT, loan->bytes);
    loan->bytes = 0;
}

void server_workspaces_return(struct server_workspaces *workspaces, struct server_loan *loan)
{
    /* Counted as idle before it is, so that who takes it at once finds it counted. */
    server_budget_move(workspaces->budget, SERVER_BUDGET_FLIGHT, SERVER_BUDGET_WORKSPACES,
                       loan->bytes);
    pthread_mutex_lock(&workspaces->lock);
    bool kept = loan->workspace && workspaces->count < workspaces->most;
    if (kept) workspaces->idle[workspaces->count++] = *loan;
    pthread_mutex_unlock(&workspaces->lock);
    if (!kept) discard(workspaces, SERVER_BUDGET_WORKSPACES, *loan);
    *loan = (struct server_loan){0};
}
