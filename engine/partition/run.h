/* Runs a propagation, by one wavefront or by two. */
#ifndef GD_PARTITION_RUN_H
#define GD_PARTITION_RUN_H

#include "wavefront/wavefront.h"

/* Seeds the wavefront, propagates until nothing within the bound is left, and hands the result to
 * the sink. Two tasks of the executor share the work where that pays. Errors: GD_NO_MEMORY,
 * GD_BUDGET, GD_CANCELLED, GD_DEADLINE, GD_RUNAWAY and the sink's. */
GD_MUST_USE enum gd_status gd__wavefront_run(const struct gd_mesh *mesh,
                                             const struct gd__propagation *propagation,
                                             const struct gd__sink *sink,
                                             const struct gd_control *monitor,
                                             const struct gd_executor *executor);

#endif
