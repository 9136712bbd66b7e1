/* Budgeted call: one long call of the engine, in a reused workspace and within the memory budget.
 *
 *     struct server_budgeted_call call = {.workspaces = …, .control = …, .grant = bytes};
 *     while (server_budgeted_call_next(&call)) {
 *         call.status = gd_mesh_build(…, &call.control, …);
 *         call.kept = bytes of the result;
 *     }
 *     return call.status;
 *
 * DESIGN. The memory of a call is known only when the call ends. So a call gets a grant that
 * suffices for most calls of its kind. A call that fails for lack of memory runs again with several
 * times as much. Therefore the failed attempts take a fraction of the time of the last attempt. If
 * other calls hold this memory, the call runs with the rest. If the rest is too little, the call
 * waits until no other call runs. Therefore a call must not be made within another call: it would
 * wait for itself.
 *
 * Workspaces keep the scratch memory of a call for the next one. They form a stack: a call borrows
 * the most recently used workspace. Idle workspaces are reclaimed before all caches, the longest
 * idle first. The bytes of a borrowed workspace are SERVER_BUDGET_FLIGHT. All functions are
 * thread-safe. */
#pragma once

#include "gd/control.h"
#include "gd/workspace.h"
#include "server/work/budget.h"

struct server_workspaces;

/* Creates a stack of at most `most` idle workspaces. Borrows `budget`, which must outlive the
 * stack, and registers a reclaimer of it. Returns NULL if out of memory. */
struct server_workspaces *server_workspaces_create(struct server_budget *budget, uint32_t most);

/* Returns the budget that the workspaces were created with. */
struct server_budget *server_workspaces_budget(const struct server_workspaces *workspaces);

/* Call this function when no call runs. NULL is allowed. */
void server_workspaces_destroy(struct server_workspaces *workspaces);

struct server_space { /* private: a borrowed workspace */
    /* NULL means that memory was short, and the call allocates its own memory */
    struct gd_workspace *workspace;
    size_t bytes; /* bytes that the budget counts for the workspace */
};

struct server_budgeted_call {
    struct server_workspaces *workspaces;
    struct gd_control control; /* the loop sets its budget and workspace for each attempt */
    size_t grant;              /* bytes that most such calls need */
    size_t aside;              /* bytes that the call allocates in addition to its budget */
    /* true if the call uses only free memory, reclaims nothing, and makes one attempt */
    bool is_modest;
    size_t *held; /* increased by `kept` when the call succeeds; may be NULL */
    /* the loop's body sets the status of an attempt; after the loop this is the status of the
       call */
    enum gd_status status;
    size_t kept;               /* the loop's body sets the bytes of the result */
    struct server_space space; /* this and the rest are private */
    size_t taken;              /* bytes taken by the current attempt; 0 means none */
    bool is_last;              /* true if the attempt has all available memory, and runs alone */
    bool is_crowded;           /* true if the attempt has the memory that other calls do not use */
};

/* Ends an attempt and begins the next one. Returns false when the call has succeeded or failed; the
 * loop must not end before. On success the caller owns the `kept` bytes of SERVER_BUDGET_FLIGHT,
 * and moves them to another class or returns them. Errors: those of the call; GD_BUDGET (all
 * available memory is too little). */
bool server_budgeted_call_next(struct server_budgeted_call *call);
