/* Partition: one propagation by two wavefronts, each on one part of the surface. A plane through
 * the source divides the faces.
 *
 * DESIGN
 * - A face and its sides belong to one part, whose wavefront propagates their windows. A vertex
 *   with faces of both parts is common to both wavefronts.
 * - Both wavefronts work in turns of a fixed amount of work, each on its own memory. Between turns
 *   they exchange outboxes: windows that crossed the cut, and distances of common vertices. A
 *   wavefront reads its messages at the beginning of a turn.
 * - Each wavefront emits from a common vertex or a seed into its own part.
 * - When all messages are read, both wavefronts have the same distance of each common vertex to the
 *   last bit: the lesser one.
 * - The order of all work depends on the surface and the source only. So distances are the same on
 *   any number of threads. They equal those of one wavefront up to rounding.
 * - Messages arrive late. The delay causes repeated work, but no inexact distances, because the
 *   propagation is label-correcting (wavefront.h). */
#ifndef GD_PARTITION_PARTITION_H
#define GD_PARTITION_PARTITION_H

#include "wavefront/wavefront.h"

/* Returns true if two wavefronts are faster than one: a large surface, one seed, no bound, and
 * enough memory. */
bool gd__partition_is_worth_it(const struct gd_mesh *mesh,
                               const struct gd__propagation *propagation,
                               const struct gd_control *monitor);

/* Seeds the wavefront, propagates until nothing within the bound is left, and calls the sink. Uses
 * two tasks of the executor if that is faster. Errors: GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED,
 * GD_DEADLINE, GD_RUNAWAY and those of the sink. */
GD_MUST_USE enum gd_status gd__wavefront_run(const struct gd_mesh *mesh,
                                             const struct gd__propagation *propagation,
                                             const struct gd__sink *sink,
                                             const struct gd_control *monitor,
                                             const struct gd_executor *executor);

#endif
