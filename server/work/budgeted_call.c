/* See budgeted_call.h.
 *
 * How much memory a call takes is not known before it is made. So it is granted what most need,
 * taken from the budget in full before it begins, and made again with several times as much when
 * that was too little: the work done in vain is a fraction of the last attempt's. */
#include "server/work/budgeted_call.h"

#define GRANT_FACTOR 4

static bool take(struct server_workspaces *workspaces, const struct server_budgeted_call *call,
                 size_t bytes)
{
    return call->is_modest ? server_budget_take_spare(server_workspaces_budget(workspaces),
                                                      SERVER_BUDGET_FLIGHT, bytes)
                           : server_budget_take(server_workspaces_budget(workspaces),
                                                SERVER_BUDGET_FLIGHT, bytes);
}

/* The workspace's bytes are in flight beside the grant: what it holds from before and what the call
 * may take overlap, but by how much only the engine knows. */
static enum gd_status make_within(struct server_workspaces *workspaces,
                                  const struct server_budgeted_call *call, struct server_loan *loan,
                                  size_t grant)
{
    struct gd_control control = call->control;
    size_t kept = 0;
    /* to the engine, 0 is no limit */
    if (!grant || !take(workspaces, call, grant + call->aside)) return GD_BUDGET;
    control.budget_bytes = grant;
    control.workspace = loan->workspace;
    enum gd_status status = call->make(call->user, &control, &kept);
    size_t left = loan->workspace ? gd_workspace_bytes(loan->workspace) : 0;
    server_budget_adjust(server_workspaces_budget(workspaces), SERVER_BUDGET_FLIGHT,
                         grant + call->aside + loan->bytes, kept + left);
    loan->bytes = left;
    return status;
}

/* The workspace's own memory goes only for a call that would not have enough otherwise. */
static bool can_grant(struct server_workspaces *workspaces, struct server_loan *loan, size_t grant)
{
    if (server_budget_could_take(server_workspaces_budget(workspaces), grant)) return true;
    server_workspaces_trim(workspaces, loan);
    return server_budget_could_take(server_workspaces_budget(workspaces), grant);
}

/* Each grant in turn, until one is enough or all that can be had was not. */
static enum gd_status make(struct server_workspaces *workspaces,
                           const struct server_budgeted_call *call, struct server_loan *loan)
{
    for (size_t grant = call->grant; can_grant(workspaces, loan, grant); grant *= GRANT_FACTOR) {
        enum gd_status status = make_within(workspaces, call, loan, grant);
        if (status != GD_BUDGET || call->is_modest) return status;
    }
    return make_within(workspaces, call, loan,
                       server_budget_available(server_workspaces_budget(workspaces)));
}

enum gd_status server_budgeted_call_run(struct server_workspaces *workspaces,
                                        const struct server_budgeted_call *call)
{
    struct server_loan loan = server_workspaces_borrow(workspaces);
    enum gd_status status = make(workspaces, call, &loan);
    server_workspaces_return(workspaces, &loan);
    return status;
}
