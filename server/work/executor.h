/* Executor: lends idle workers to the parallel tasks of one job.
 *
 *     const struct gd_executor *executor = server_executor_start(workers, width, deadline_ns);
 *     gd_executor_run(executor, row_run, matrix, rows);
 *     server_executor_stop(executor);
 *
 * DESIGN. The executor queues one helper job for each thread except the calling thread. A helper
 * serves all runs until the executor stops, because some calls, such as splines, have several runs.
 * Between runs a helper sleeps. If other jobs wait, a helper that has run for a millisecond is
 * queued again behind them.
 *
 * The caller runs every task that no helper has begun, so a run also ends without helpers. Caller
 * and helpers share the executor by reference counting. So a helper that leaves the queue after the
 * stop does not access memory of the caller. */
#pragma once

#include "gd/executor.h"
#include "server/work/workers.h"

/* Returns an executor with at most `width` threads, including the calling thread, and with at most
 * as many threads as there are workers. Returns NULL if the limit is one thread or memory is short;
 * the engine then runs all tasks on the calling thread. Use the executor only in the thread of the
 * job that called this function. */
const struct gd_executor *server_executor_start(struct server_workers *workers, uint32_t width,
                                                uint64_t deadline_ns);

/* Like server_executor_start, for work on a mesh of so many faces: with two threads. Returns NULL
 * also if the mesh is too small to be shared. */
const struct gd_executor *server_executor_start_for(struct server_workers *workers, uint32_t faces,
                                                    uint64_t deadline_ns);

/* Stops and frees the executor. NULL is allowed. */
void server_executor_stop(const struct gd_executor *executor);
