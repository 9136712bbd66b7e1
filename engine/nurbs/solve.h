/* Solve: from a trail to a geodesic of the surface, as exact as asked for. */
#ifndef GD_NURBS_SOLVE_H
#define GD_NURBS_SOLVE_H

#include "gd/geodesic_like.h"
#include "nurbs/newton.h"
#include "nurbs/trail.h"

struct gd__task {
    const struct gd_parametric *surface;
    uint32_t degree, control_points;
    double tolerance;
    struct gd__watch *watch;
};

struct gd__solution {
    struct gd__chain *chain; /* owned: free() */
    struct gd__newton_report report;
    double error;
    uint32_t iterations;
    bool converged; /* the tolerance is met */
    bool corner;    /* an end is held at a corner or end of its curve */
};

/* A coarse curve over all cells from a trail that begins and ends at the joints: enough to compare
 * ways by. The joints are `whole`. With task->control_points it is the paper's curve and the
 * answer. Errors of gd__newton. */
GD_MUST_USE enum gd_status gd__solve_coarse(const struct gd__task *task,
                                            const struct gd__trail *trail,
                                            const struct gd__joint *from,
                                            const struct gd__joint *to, struct gd__solution *out);

/* Cuts the curve at the surface's lines, and refines it until the tolerance is met. */
GD_MUST_USE enum gd_status gd__solve_fine(const struct gd__task *task,
                                          struct gd__solution *solution);

/* A curve that fell into a pole, or would not settle, bends by much more than any that is nearly a
 * geodesic; one of so many control points as were asked for may bend as it must. Ends early when
 * the watch says so. */
bool gd__solution_is_bent(const struct gd__task *task, const struct gd__solution *solution);

#endif
