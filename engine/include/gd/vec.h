/* Vec: points and vectors in space, which are passed by value. Coordinates are in the caller's
 * length unit. */
#ifndef GD_VEC_H
#define GD_VEC_H

#include <math.h>

#include "gd/language.h"

GD_EXTERN_C_BEGIN

struct gd_vec3 {
    double x, y, z;
};

static inline struct gd_vec3 gd_vec3_add(struct gd_vec3 a, struct gd_vec3 b)
{
    struct gd_vec3 result = {a.x + b.x, a.y + b.y, a.z + b.z};
    return result;
}

static inline struct gd_vec3 gd_vec3_sub(struct gd_vec3 a, struct gd_vec3 b)
{
    struct gd_vec3 result = {a.x - b.x, a.y - b.y, a.z - b.z};
    return result;
}

static inline struct gd_vec3 gd_vec3_scale(struct gd_vec3 a, double s)
{
    struct gd_vec3 result = {a.x * s, a.y * s, a.z * s};
    return result;
}

/* Returns a + s b. */
static inline struct gd_vec3 gd_vec3_along(struct gd_vec3 a, double s, struct gd_vec3 b)
{
    struct gd_vec3 result = {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
    return result;
}

static inline double gd_vec3_dot(struct gd_vec3 a, struct gd_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline struct gd_vec3 gd_vec3_cross(struct gd_vec3 a, struct gd_vec3 b)
{
    struct gd_vec3 result = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return result;
}

static inline double gd_vec3_length(struct gd_vec3 a)
{
    return sqrt(gd_vec3_dot(a, a));
}

static inline double gd_vec3_distance(struct gd_vec3 a, struct gd_vec3 b)
{
    return gd_vec3_length(gd_vec3_sub(a, b));
}

static inline int gd_vec3_is_finite(struct gd_vec3 a)
{
    return isfinite(a.x) && isfinite(a.y) && isfinite(a.z);
}

/* Returns the unit vector in the direction of `a`, or 0 if `a` is zero or not finite. The
 * coordinates may be so large or small that their squares overflow or underflow. */
static inline struct gd_vec3 gd_vec3_unit(struct gd_vec3 a)
{
    double largest = fmax(fabs(a.x), fmax(fabs(a.y), fabs(a.z)));
    if (!(largest > 0 && isfinite(largest))) {
        struct gd_vec3 none = {0, 0, 0};
        return none;
    }
    struct gd_vec3 scaled = {a.x / largest, a.y / largest, a.z / largest};
    return gd_vec3_scale(scaled, 1 / gd_vec3_length(scaled));
}

GD_EXTERN_C_END

#endif
