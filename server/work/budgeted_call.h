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
 * times as much, so the failed attempts cost a fraction of the last one. If other calls hold that
 * memory, it runs with the rest. If that is too little, it waits until no other call runs. So a
 * call must not be made within another call, which would wait for itself.
 *
 * Workspaces keep the scratch memory of a call for the next one. They form a stack: a call borrows
 * the most recently used workspace. Idle ones are reclaimed before all caches except that of packed
 * files, the longest idle first. The bytes of a borrowed workspace are SERVER_BUDGET_FLIGHT. All
 * functions are thread-safe. */
#ifndef SERVER_WORK_BUDGETED_CALL_H
#define SERVER_WORK_BUDGETED_CALL_H

#include "gd/control.h"
#include "gd/workspace.h"
#include "server/work/budget.h"

struct server_workspaces;

/* Keeps at most `most` idle workspaces. Borrows `budget`, which must outlive them, and registers a
 * reclaimer there. Returns NULL if out of memory. */
struct server_workspaces *server_workspaces_create(struct server_budget *budget, uint32_t most);

/* Returns the budget that the workspaces were created with. */
struct server_budget *server_workspaces_budget(const struct server_workspaces *workspaces);

/* Call this function when no call runs. NULL is allowed. */
void server_workspaces_destroy(struct server_workspaces *workspaces);

struct server_space {               /* private: a borrowed workspace */
    struct gd_workspace *workspace; /* NULL: no memory; the call allocates its own */
    size_t bytes;                   /* bytes that the budget counts for the workspace */
};

struct server_budgeted_call {
    struct server_workspaces *workspaces;
    struct gd_control control; /* its budget and workspace are those of the attempt */
    size_t grant;              /* bytes that most such calls need */
    size_t aside;              /* bytes that the call allocates in addition to its budget */
    bool is_modest;            /* uses only free memory, reclaims nothing, makes one attempt */
    size_t *held;              /* grows by `kept` at the end of a call that succeeds; or NULL */
    /* set by the loop after an attempt; at the end, the status of the call */
    enum gd_status status;
    size_t kept;               /* the loop sets the bytes of the result */
    struct server_space space; /* this and the rest are private */
    size_t taken;              /* bytes taken by the current attempt; 0: none */
    bool is_last;              /* the attempt has all available memory, and runs alone */
    bool is_crowded;           /* the attempt has the memory that other calls left */
};

/* Ends an attempt and begins the next. False: the call has succeeded or failed. The loop must not
 * end before. On success the caller owns the `kept` bytes of SERVER_BUDGET_FLIGHT, to move them to
 * another class or to give them back. Errors: the call's; GD_BUDGET: all memory was too little. */
bool server_budgeted_call_next(struct server_budgeted_call *call);

#endif
