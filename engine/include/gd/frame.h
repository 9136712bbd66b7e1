/* Frame: three perpendicular unit vectors at a point of a curve, for an object or a camera that
 * moves along the curve ("Geodesic Hermite splines on triangular meshes", section 5.3). */
#ifndef GD_FRAME_H
#define GD_FRAME_H

#include "gd/spline.h"

GD_EXTERN_C_BEGIN

struct gd_frame {
    double parameter;
    struct gd_vec3 position; /* in the caller's unit */
    struct gd_vec3 tangent, normal,
        /* normal: the outward normal of the face into which the tangent leads; binormal = normal x
           tangent, to the left */
        binormal;
};

/* Returns the frame at a sampled place of a spline. O(1). Thread-safe. */
struct gd_frame gd_frame_at(const struct gd_mesh *mesh, const struct gd_spline_place *place);

GD_EXTERN_C_END

#endif
