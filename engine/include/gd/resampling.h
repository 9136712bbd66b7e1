/* Resampling: points of a curve at equal arc lengths, and geodesics between consecutive points. */
#ifndef GD_RESAMPLING_H
#define GD_RESAMPLING_H

#include "gd/curve.h"

GD_EXTERN_C_BEGIN

#define GD_RESAMPLING_POINTS (1u << 20)

struct gd_resampling_request {
    const struct gd_curve *curve;
    uint32_t count; /* number of points, from 2 to GD_RESAMPLING_POINTS */
};

struct gd_resampling {
    struct gd_curve curve; /* the curve through all points */
    struct gd_point *points;
    uint32_t count;
};

void gd_resampling_free(struct gd_resampling *resampling); /* NULL is allowed */

/* Computes request->count points of the curve at equal arc lengths, and straightens the pieces
 * between them to geodesics. The points of an open curve include its ends; those of a closed curve
 * include its first point. The caller frees `*out` by gd_resampling_free. `control` and `detail`
 * may be NULL. Errors: GD_INVALID_ARGUMENT (fewer than two points, or a curve of length zero),
 * GD_TOO_LARGE (more than GD_RESAMPLING_POINTS), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED,
 * GD_DEADLINE, GD_INTERNAL. O(points and faces). Thread-safe. */
GD_MUST_USE enum gd_status gd_curve_resample(const struct gd_mesh *mesh,
                                             const struct gd_resampling_request *request,
                                             const struct gd_control *control,
                                             struct gd_resampling *out, struct gd_detail *detail);

GD_EXTERN_C_END

#endif
