/* Mean: the weighted mean (centroid) of points of a surface.
 *
 * The Karcher mean: the point x at which f(x) = sum of w_i d(x, p_i)^2 is least; there the weighted
 * vectors from x to the points cancel out. It does not depend on the points' order. Where f has
 * more than one minimum (points that lie apart by half of a closed surface) the one is found that
 * the iteration comes to from the point given that is nearest to their mean in space, or from the
 * surface point nearest to it. At a vertex whose total angle exceeds 2 pi a minimum may stand where
 * the vectors do not cancel out: all directions lead up. */
#ifndef GD_MEAN_H
#define GD_MEAN_H

#include "gd/landmarks.h"
#include "gd/point.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gd_mean_request {
    const struct gd_point *points; /* borrowed; at least one, all of one component */
    const double *weights;         /* >= 0, not all 0; NULL: equal ones. Borrowed */
    uint32_t count;
    /* "Geodesic Hermite splines on triangular meshes", Figure 7: the weighted vectors from the
       first point to the others are summed there, once. Depends on which point is the first */
    bool one_step;
    const struct gd_landmarks *landmarks; /* of this mesh: searches are narrower; NULL: none */
};

struct gd_mean {
    struct gd_point point;
    /* length of the step that would be next, in the caller's unit: at a minimum 0 but for
       rounding */
    double residual;
    /* sqrt(f / sum of the weights): how far the points lie from it in the mean square */
    double spread;
    uint32_t iterations;
    /* the residual is at most 1e-11 of the spread; after 100 iterations it is what it is */
    bool converged;
    /* the mean, or a place that the iteration came by, lies on the cut locus of a point: vectors
       jump there, and another mean may be as good */
    bool is_cut;
};

/* `control` and `detail` may be NULL. Errors: GD_INVALID_ARGUMENT (no point, a weight that is
 * negative or not finite, no weight), GD_NOT_ON_SURFACE (points of different components), and those
 * of gd_pair_solve. Each iteration searches a path to each point; where paths don't bend few are
 * needed, since on flat faces the step is Newton's. Thread-safe. */
GD_MUST_USE enum gd_status gd_mean_find(const struct gd_mesh *mesh,
                                        const struct gd_mean_request *request,
                                        const struct gd_control *control, struct gd_mean *out,
                                        struct gd_detail *detail);

#ifdef __cplusplus
}
#endif

#endif
