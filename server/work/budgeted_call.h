/* Budgeted call: one long call of the engine, in a reused workspace and within the memory budget.
 *
 *     const struct server_budgeted_call call = {
 *         .make = build, .user = &wanted, .control = …, .grant = bytes};
 *     enum gd_status status = server_budgeted_call_run(workspaces, &call);
 *
 * DESIGN. The memory of a call is known only when the call ends. So a call gets a grant that most
 * calls of its kind need. A call that fails for lack of memory runs again with several times as
 * much: the wasted work is a fraction of the last attempt's.
 *
 * Workspaces keep the scratch memory of a call for the next one, in a stack: a call borrows the one
 * whose memory was touched last. Idle ones are reclaimed first of all classes, the longest idle
 * first. The bytes of a borrowed workspace are SERVER_BUDGET_FLIGHT. All functions are
 * thread-safe. */
#ifndef SERVER_WORK_BUDGETED_CALL_H
#define SERVER_WORK_BUDGETED_CALL_H

#include "gd/control.h"
#include "gd/workspace.h"
#include "server/work/budget.h"

struct server_workspaces;

/* Keeps at most `most` idle workspaces. Borrows `budget`, which must outlive them, and registers a
 * reclaimer there. NULL without memory. */
struct server_workspaces *server_workspaces_create(struct server_budget *budget, uint32_t most);

/* The budget that they were created with. */
struct server_budget *server_workspaces_budget(const struct server_workspaces *workspaces);

/* Call it when no call runs. NULL is harmless. */
void server_workspaces_destroy(struct server_workspaces *workspaces);

struct server_budgeted_call {
    /* Makes the call under `control`. On success `*kept` is the size of its result in bytes. */
    enum gd_status (*make)(void *user, const struct gd_control *control, size_t *kept);
    void *user;
    /* without budget and workspace, which server_budgeted_call_run sets */
    struct gd_control control;
    size_t grant;   /* bytes that most such calls need */
    size_t aside;   /* bytes that the call allocates beside its budget */
    bool is_modest; /* uses free memory only: reclaims nothing, and makes one attempt */
};

/* On success the caller owns the `*kept` bytes of SERVER_BUDGET_FLIGHT: it moves them to another
 * class or gives them back. Errors are those of the call. GD_BUDGET: all available memory was not
 * enough. */
GD_MUST_USE enum gd_status server_budgeted_call_run(struct server_workspaces *workspaces,
                                                    const struct server_budgeted_call *call);

#endif
