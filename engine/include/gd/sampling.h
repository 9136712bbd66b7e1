/* Sampling: points that cover a surface evenly. Each point is the farthest from all previous
 * points.
 *
 *     struct gd_point points[64];
 *     double radii[64];
 *     struct gd_sampling sampling = {64, points, radii};
 *     if (gd_sampling_farthest(mesh, &start, NULL, &sampling, NULL) == GD_OK)
 *         printf("%.17g\n", radii[63]); */
#ifndef GD_SAMPLING_H
#define GD_SAMPLING_H

#include "gd/control.h"
#include "gd/point.h"

GD_EXTERN_C_BEGIN

/* The caller's arrays for a sampling of `count` > 0 points. */
struct gd_sampling {
    uint32_t count;
    struct gd_point *points; /* count entries */
    double *radii;           /* count entries */
};

/* Computes a farthest-point sampling. Writes out->count points to out->points, beginning with
 * `start`, and covering radii to out->radii. radii[i] is the greatest distance that a point of the
 * surface has from the nearest one of points 0 to i. So it is also the distance of point i + 1 from
 * the nearest previous point. Radii never increase. Each point is exactly the farthest point of the
 * surface (gd_field_farthest): a vertex, a point of a boundary edge, or a point inside a face. As
 * long as a component has no point, radii are INFINITY, and the next point is the vertex with the
 * lowest index on a component without points. If `start` is NULL, the first point is the vertex
 * with the lowest index among those that faces use. `control` and `detail` may be NULL; both arrays
 * are untouched on failure. Errors: GD_INVALID_ARGUMENT (a count of 0), those of gd_field_build,
 * GD_INTERNAL. Cost: for each point, a field of all points so far and the search for its farthest
 * point. Thread-safe. */
GD_MUST_USE enum gd_status gd_sampling_farthest(const struct gd_mesh *mesh,
                                                const struct gd_point *start,
                                                const struct gd_control *control,
                                                struct gd_sampling *out, struct gd_detail *detail);

GD_EXTERN_C_END

#endif
