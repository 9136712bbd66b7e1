#include "gd/frame.h"

struct gd_frame gd_frame_at(const struct gd_mesh *mesh, const struct gd_spline_place *place)
{
    struct gd_vec3 x, y, tangent = place->tangent.xyz;
    gd_direction_axes(mesh, place->tangent.face, &x, &y);
    struct gd_vec3 normal = gd_vec3_cross(x, y);
    return (struct gd_frame){.parameter = place->parameter,
                             .position = gd_point_position(mesh, &place->point),
                             .tangent = tangent,
                             .normal = normal,
                             .binormal = gd_vec3_cross(normal, tangent)};
}
