/* Executor: the tasks of one request, spread over the workers that have nothing else to do.
 *
 *     struct server_executor executor;
 *     gd_executor_run(server_executor_of(&executor, workers, deadline_ns), task, context, count);
 *
 * DESIGN. The thread that runs the executor does tasks itself, one after the other. Beside it there
 * are helpers, jobs in the workers' queue; each does one task and queues up again, behind whatever
 * came meanwhile: so a request of many tasks never holds up others by more than one task on each of
 * the other threads. A helper that is refused is gone; the thread itself always gets to the end.
 *
 * Tasks are handed out under a lock. The run is over when none is left and none is running: a
 * helper that still waits in the queue by then finds nothing and touches nothing of the caller's.
 * What it needs for that is counted, and goes with the last of them. */
#ifndef SERVER_WORK_EXECUTOR_H
#define SERVER_WORK_EXECUTOR_H

#include "gd/executor.h"
#include "server/work/workers.h"

struct server_executor {
    struct gd_executor executor; /* its `user` is this struct */
    struct server_workers *workers;
    uint64_t deadline_ns; /* of the helpers in the queue */
};

/* Fills in `*out`, which is borrowed by what is returned: an executor as wide as there are workers.
 * To be run by one of them. */
const struct gd_executor *server_executor_of(struct server_executor *out,
                                             struct server_workers *workers, uint64_t deadline_ns);

#endif
