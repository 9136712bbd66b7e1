/* See call.h.
 *
 * How much memory a call takes is not known before it is made. So it is granted what most need, taken from the budget in full
 * before it begins, and made again with several times as much when that was too little: the work done in vain is a fraction of
 * the last attempt's. */
#include "server/call.h"

#define GRANT_FACTOR 4

static bool take(struct server *server, const struct server_call *call, size_t bytes)
{
    return call->is_modest ? server_budget_take_spare(&server->budget, SERVER_BUDGET_FLIGHT, bytes)
                           : server_budget_take(&server->budget, SERVER_BUDGET_FLIGHT, bytes);
}

/* The workspace's bytes are in flight beside the grant: what it holds from before and what the call may take overlap, but by
 * how much only the engine knows. */
static enum gd_status make_within(struct server *server, const struct server_call *call, struct server_loan *loan,
                                  size_t grant)
{
    struct gd_control control = call->control;
    size_t kept = 0;
    if (!take(server, call, grant + call->aside)) return GD_BUDGET;
    control.budget_bytes = grant;
    control.workspace = loan->workspace;
    enum gd_status status = call->make(call->user, &control, &kept);
    size_t left = loan->workspace ? gd_workspace_bytes(loan->workspace) : 0;
    server_budget_adjust(&server->budget, SERVER_BUDGET_FLIGHT, grant + call->aside + loan->bytes, kept + left);
    loan->bytes = left;
    return status;
}

/* Each grant in turn, until one is enough or all that can be had was not. */
static enum gd_status make(struct server *server, const struct server_call *call, struct server_loan *loan)
{
    for (size_t grant = call->grant;; grant *= GRANT_FACTOR) {
        size_t most = server_budget_available(&server->budget);
        if (grant >= most) {
            server_workspaces_trim(server->workspaces, loan);
            most = server_budget_available(&server->budget);
        }
        bool is_last = grant >= most;
        enum gd_status status = make_within(server, call, loan, is_last ? most : grant);
        if (status != GD_BUDGET || is_last || call->is_modest) return status;
    }
}

enum gd_status server_call_make(struct server *server, const struct server_call *call)
{
    struct server_loan loan = server_workspaces_borrow(server->workspaces);
    enum gd_status status = make(server, call, &loan);
    server_workspaces_return(server->workspaces, &loan);
    return status;
}
