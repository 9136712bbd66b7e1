/* Team: a second thread for the short tasks of one long call, as many turns as it takes.
 *
 *     struct server_team *team = server_team_call(workers, deadline_ns);
 *     ... gd_field_build(mesh, &request, control, server_team_executor(team), &field, NULL) ...
 *     server_team_dismiss(team);
 *
 * DESIGN. An executor (executor.h) queues its helpers for each run; that costs as much as a turn of
 * a field takes. Here one worker stays for all runs: between them it looks for the next one for
 * some microseconds, then sleeps until it is woken. It joins when a worker is free, and leaves as
 * soon as a job waits in the queue, so that nobody waits for a field but for the end of a turn;
 * while requests come densely it rests. The caller does every task that nobody has begun: with the
 * helper or without it, the tasks are the same, and so is what comes of them.
 *
 * The two share the team by count: a helper that is still queued when the call ends finds nothing
 * to do. */
#ifndef SERVER_WORK_TEAM_H
#define SERVER_WORK_TEAM_H

#include "gd/executor.h"
#include "server/work/workers.h"

struct server_team;

/* To be called by a worker. NULL: there is one worker only, or no memory; the executor of NULL is
 * NULL. */
struct server_team *server_team_call(struct server_workers *workers, uint64_t deadline_ns);

/* Of width 2. Borrowed from the team, for the caller's thread. */
const struct gd_executor *server_team_executor(struct server_team *team);

/* NULL is harmless. */
void server_team_dismiss(struct server_team *team);

#endif
