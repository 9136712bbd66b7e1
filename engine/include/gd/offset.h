/* Offset: the curves at a constant distance from a curve. */
#ifndef GD_OFFSET_H
#define GD_OFFSET_H

#include "gd/curve.h"
#include "gd/isoline.h"

GD_EXTERN_C_BEGIN

struct gd_offset_request {
    const struct gd_curve *curve;
    double distance; /* > 0, in the mesh's unit */
};

/* Computes the isoline of the curve's exact field at a distance > 0: all points of the surface at
 * that distance from the curve, on both sides and around its ends. The result has no lines if no
 * point is that far. The caller frees `*out` by gd_isoline_free. `control` and `detail` may be
 * NULL. Errors: GD_INVALID_ARGUMENT (the distance), and those of gd_field_build and
 * gd_isoline_trace. Cost: that of a field with the distance as radius. Thread-safe. */
GD_MUST_USE enum gd_status gd_curve_offset(const struct gd_mesh *mesh,
                                           const struct gd_offset_request *request,
                                           const struct gd_control *control, struct gd_isoline *out,
                                           struct gd_detail *detail);

GD_EXTERN_C_END

#endif
