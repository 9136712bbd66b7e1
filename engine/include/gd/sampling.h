/* Sampling: points of a surface that cover it as evenly as may be, each the farthest from all
 * before it.
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

#ifdef __cplusplus
extern "C" {
#endif

/* The caller's arrays for a sampling of `count` > 0 points. */
struct gd_sampling {
    uint32_t count;
    struct gd_point *points; /* count of them */
    double *radii;           /* as many */
};

/* Farthest-point sampling: writes out->count points to out->points, the first of them `start`, and
 * to out->radii how far the surface is from them: radii[i] is the greatest distance of any point of
 * the surface to the nearest of points 0 to i; so it is also how far point i + 1 is from all before
 * it, and radii never grow. Each point is the exact farthest one (gd_field_farthest): a vertex, a
 * point of a boundary edge, or inside a face. Components come first: as long as one has no point,
 * radii are INFINITY, and the next point is the vertex of least index that no path reaches. `start`
 * NULL: the vertex of least index that faces refer to. `control` and `detail` may be NULL; both
 * arrays are untouched on failure. Errors: GD_INVALID_ARGUMENT (a count of 0), those of
 * gd_field_build, GD_INTERNAL. Cost: a field of i points for each i up to `count`, one after the
 * other, and the search for its farthest point. Thread-safe. */
GD_MUST_USE enum gd_status gd_sampling_farthest(const struct gd_mesh *mesh,
                                                const struct gd_point *start,
                                                const struct gd_control *control,
                                                struct gd_sampling *out, struct gd_detail *detail);

#ifdef __cplusplus
}
#endif

#endif
