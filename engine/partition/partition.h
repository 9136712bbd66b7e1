/* Partition: one of the two parts into which a surface is cut by a plane through the source, each with
 * a wavefront of its own.
 *
 * DESIGN
 * - A face belongs to one part, and with it its sides: their windows are propagated by that part's
 *   wavefront. A vertex of faces of both parts is known to both wavefronts. The two work by turns
 *   of a fixed amount of work, each on its own memory; between turns the mail is handed over, and a
 *   turn begins with reading it: windows that crossed the cut, and distances of vertices that the
 *   other one has to know.
 * - What a common vertex or a seed emits, each wavefront emits into its own part.
 * - Both know the same distance of each common vertex, to the last bit, once the mail is read: the
 *   lesser one.
 * - The order of everything is fixed by the surface and the source: distances are the same on any
 *   number of threads, every time. They are those of one wavefront up to rounding.
 * - Mail arrives late. That costs work, not exactness: propagation corrects itself
 *   (wavefront.h). */
#ifndef GD_PARTITION_PARTITION_H
#define GD_PARTITION_PARTITION_H

#include "wavefront/wavefront.h"

/* Whether a propagation is worth two wavefronts: a large surface, one seed, the whole of it, and
 * memory enough. */
bool gd__partition_is_worth_it(const struct gd_mesh *mesh,
                               const struct gd__propagation *propagation,
                               const struct gd_control *monitor);

/* Propagates by two wavefronts. `front` is not open yet; in the end it holds all as if it had
 * worked alone. Errors: those of gd__wavefront_run; GD_BUDGET where one wavefront may still have
 * enough. */
GD_MUST_USE enum gd_status gd__partition_propagate(struct gd__wavefront *front,
                                                   const struct gd__propagation *propagation,
                                                   const struct gd_executor *executor);

#endif
