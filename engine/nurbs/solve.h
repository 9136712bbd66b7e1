/* Solve: computes a geodesic of the surface, within a tolerance, from a polyline in the domain. */
#pragma once

#include "gd/geodesic_like.h"
#include "nurbs/newton.h"
#include "nurbs/uv_polyline.h"

struct gd__task {
    const struct gd_parametric *surface;
    uint32_t degree, control_points;
    double tolerance;
    struct gd__pace *pace;
};

struct gd__solution {
    struct gd__chain *chain; /* owned; freed by free() */
    struct gd__newton_report report;
    double error;
    uint32_t iterations;
    bool converged; /* true if the tolerance is met */
    /* true if an end of the path cannot move further along its curve, because it is at a corner or
       an end of the curve */
    bool corner;
};

/* Computes a coarse curve, which is used to compare candidates, from a polyline that begins and
 * ends at the joints. The curve is one piece over all cells. The joints may be anywhere on the
 * curves (`whole` in chain.h). If task->control_points is set, this curve is the geodesic-like
 * curve of the paper and already the final result. Errors: those of gd__newton. */
GD_MUST_USE enum gd_status gd__solve_coarse(const struct gd__task *task,
                                            const struct gd__uv_polyline *polyline,
                                            const struct gd__joint *from,
                                            const struct gd__joint *to, struct gd__solution *out);

/* Divides the curve at the surface's lines, and refines it until the tolerance is met. */
GD_MUST_USE enum gd_status gd__solve_fine(const struct gd__task *task,
                                          struct gd__solution *solution);

/* Returns true if the curve bends much more than a curve that is nearly a geodesic. Such a curve
 * shrank into a pole or did not converge. A curve with a requested number of control points may
 * bend. Ends early if the chain's pace stops. */
bool gd__solution_is_bent(const struct gd__task *task, const struct gd__solution *solution);
