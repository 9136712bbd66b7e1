/* Call: one long call of the engine, with a workspace, within the byte budget. */
#ifndef SERVER_WORK_BUDGETED_CALL_H
#define SERVER_WORK_BUDGETED_CALL_H

#include "gd/control.h"
#include "server/work/workspaces.h"

struct server_budgeted_call {
    /* Makes the call under `control`; on success `*kept` are the bytes of its result that it holds.
     */
    enum gd_status (*make)(void *user, const struct gd_control *control, size_t *kept);
    void *user;
    struct gd_control control; /* who ends it early; its budget and its workspace are filled in */
    size_t grant;              /* bytes that most such calls need */
    size_t aside;              /* bytes that it takes besides, without asking its budget */
    /* makes do with memory that is free: nothing is let go of, and there is one attempt */
    bool is_modest;
};

/* On success `*kept` bytes of SERVER_BUDGET_FLIGHT are held for the result, for the caller to pass
 * on or give back. Errors: those of the call; GD_BUDGET: not even all that could be had was enough.
 */
GD_MUST_USE enum gd_status server_budgeted_call_run(struct server_workspaces *workspaces,
                                                    const struct server_budgeted_call *call);

#endif
