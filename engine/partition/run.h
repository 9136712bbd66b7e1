/* Runs a propagation by one or two wavefronts. */
#ifndef GD_PARTITION_RUN_H
#define GD_PARTITION_RUN_H

#include "wavefront/wavefront.h"

/* Seeds the wavefront, propagates until nothing within the bound is left, and calls the sink. Uses
 * two tasks of the executor if that is faster. Errors: GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED,
 * GD_DEADLINE, GD_RUNAWAY and those of the sink. */
GD_MUST_USE enum gd_status gd__wavefront_run(const struct gd_mesh *mesh,
                                             const struct gd__propagation *propagation,
                                             const struct gd__sink *sink,
                                             const struct gd_control *monitor,
                                             const struct gd_executor *executor);

#endif
