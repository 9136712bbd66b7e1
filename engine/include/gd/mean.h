/* Mean: the weighted mean (centroid) of points on a surface.
 *
 * The mean (Karcher mean) is the point x that minimises f(x) = sum of w_i d(x, p_i)^2. The weighted
 * vectors from x to the points sum to zero. The mean does not depend on the order of the points. If
 * f has several minima (for example for two points on opposite sides of a closed surface), the
 * iteration converges to one of them. The iteration starts near the points' mean in space: either
 * at the nearest of the given points, or at the nearest point of the surface. At a vertex whose
 * total angle exceeds 2 pi, f may have a minimum although the vectors do not sum to zero. */
#ifndef GD_MEAN_H
#define GD_MEAN_H

#include "gd/landmarks.h"
#include "gd/point.h"

GD_EXTERN_C_BEGIN

struct gd_mean_request {
    const struct gd_point *points; /* borrowed; at least one, all on one component */
    const double *weights;         /* borrowed; >= 0, not all 0; NULL means equal weights */
    uint32_t count;
    /* If true, only one step is computed instead of the mean ("Geodesic Hermite splines on
       triangular meshes", Figure 7). The step is the sum of the weighted vectors from the first
       point to the others. The result depends on the choice of the first point. */
    bool one_step;
    /* landmarks of the same mesh, which make searches faster; may be NULL */
    const struct gd_landmarks *landmarks;
};

struct gd_mean {
    struct gd_point point;
    /* length of the next step, in the caller's unit; it is 0 at a minimum, up to rounding */
    double residual;
    /* sqrt(f / sum of the weights): the root mean square distance from the points */
    double spread;
    uint32_t iterations;
    /* true if the residual is at most 1e-11 of the spread; false if this is not reached in 100
       iterations */
    bool converged;
    /* true if the mean, or an iterate, lies on the cut locus of a point; vectors are not continuous
       there, and another mean may be equally good */
    bool is_cut;
};

/* Computes a mean. `control` and `detail` may be NULL. Errors: GD_INVALID_ARGUMENT (no point, a
 * weight that is negative or not finite, all weights zero), GD_NOT_ON_SURFACE (points of different
 * components), and those of gd_pair_solve. Each iteration computes a path to each point. If paths
 * do not bend at vertices, few iterations are needed, because the step is then an exact step of
 * Newton's method. Thread-safe. */
GD_MUST_USE enum gd_status gd_mean_find(const struct gd_mesh *mesh,
                                        const struct gd_mean_request *request,
                                        const struct gd_control *control, struct gd_mean *out,
                                        struct gd_detail *detail);

GD_EXTERN_C_END

#endif
