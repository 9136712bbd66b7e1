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
 * `start`, and covering radii to out->radii. radii[i] is the greatest distance of any point of the
 * surface to the nearest of points 0 to i, and so the distance of point i + 1 from the nearest
 * previous point. Radii never increase. Each point is the exact farthest one (gd_field_farthest): a
 * vertex, a point of a boundary edge, or inside a face. While some component has no point, radii
 * are INFINITY, and the next point is the unreached vertex of least index. If `start` is NULL, the
 * first point is the referenced vertex of least index. `control` and `detail` may be NULL; both
 * arrays are untouched on failure. Errors: GD_INVALID_ARGUMENT (a count of 0), those of
 * gd_field_build, GD_INTERNAL. Cost: for each point, a field of all points so far and the search
 * for its farthest point. Thread-safe. */
GD_MUST_USE enum gd_status gd_sampling_farthest(const struct gd_mesh *mesh,
                                                const struct gd_point *start,
                                                const struct gd_control *control,
                                                struct gd_sampling *out, struct gd_detail *detail);

GD_EXTERN_C_END

#endif
