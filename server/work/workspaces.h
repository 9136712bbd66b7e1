/* Workspaces: the memory that a worker's long call leaves behind for the next one, within the byte
 * budget.
 *
 *     struct server_loan loan = server_workspaces_borrow(workspaces);
 *     ... a call with loan.workspace in its gd_control; then set loan.bytes to what is counted for
 * it ... server_workspaces_return(workspaces, &loan);
 *
 * DESIGN. A stack of idle workspaces, at most one a worker. A call borrows the one on top, whose
 * memory was touched last; so a daemon with little to do keeps the memory of one worker, and one
 * that is fully at work has one a thread. Who has borrowed a workspace owns it: nobody else sees
 * it, so only idle ones are ever given back to the system.
 *
 * Bytes: those of a borrowed workspace are SERVER_BUDGET_FLIGHT, those of an idle one
 * SERVER_BUDGET_WORKSPACES. The latter are the first that the budget reclaims, those that were idle
 * for longest before the others.
 *
 * One mutex guards the stack; workspaces are destroyed without it. All functions are thread-safe.
 */
#ifndef SERVER_WORK_WORKSPACES_H
#define SERVER_WORK_WORKSPACES_H

#include "gd/workspace.h"
#include "server/work/budget.h"

struct server_workspaces;

/* Keeps at most `most` idle ones. `budget` becomes the workspaces' to reclaim from; it is borrowed
 * and outlives them. NULL without memory. */
struct server_workspaces *server_workspaces_create(struct server_budget *budget, uint32_t most);

/* The budget that they were created with. */
struct server_budget *server_workspaces_budget(const struct server_workspaces *workspaces);

/* Everything was returned by then. NULL is harmless. */
void server_workspaces_destroy(struct server_workspaces *workspaces);

/* A workspace for one call at a time, and the bytes of SERVER_BUDGET_FLIGHT that are counted for
 * it. */
struct server_loan {
    struct gd_workspace *workspace; /* NULL: no memory; a call does without */
    size_t bytes;                   /* the borrower's to keep true while the workspace grows */
};

struct server_loan server_workspaces_borrow(struct server_workspaces *workspaces);

/* Gives the memory of a borrowed workspace back, and its bytes; it stays usable. */
void server_workspaces_trim(struct server_workspaces *workspaces, struct server_loan *loan);

/* Ends the loan: loan->bytes become those of an idle workspace, or are given back with it when
 * there are enough of those. */
void server_workspaces_return(struct server_workspaces *workspaces, struct server_loan *loan);

#endif
