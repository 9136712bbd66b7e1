/* Directions in a tangent plane. */
#include "gd/limit_place.h"

#include "subdiv/surface.h"

enum gd_status gd_limit_place_check(const struct gd_subdivision *surface,
                                    struct gd_limit_point *place, struct gd_detail *detail)
{
    return gd__place_check(surface, place, detail);
}

/* Returns the axis of angle 0. The axis of angle pi / 2 is the cross product of the normal and this
 * axis. */
static struct gd_vec3 first_axis(const struct gd_limit_jet *jet)
{
    return gd_vec3_scale(jet->du, 1 / gd_vec3_length(jet->du));
}

struct gd_vec3 gd_limit_direction(const struct gd_limit_jet *jet, double angle)
{
    struct gd_vec3 x = first_axis(jet);
    return gd_vec3_along(gd_vec3_scale(x, cos(angle)), sin(angle), gd_vec3_cross(jet->normal, x));
}

double gd_limit_angle(const struct gd_limit_jet *jet, struct gd_vec3 vector)
{
    struct gd_vec3 x = first_axis(jet);
    double angle =
        atan2(gd_vec3_dot(vector, gd_vec3_cross(jet->normal, x)), gd_vec3_dot(vector, x));
    if (angle < 0) angle += 2 * M_PI;
    return angle >= 2 * M_PI ? 0 : angle;
}
