/* Axes: the frame of a side (topology.h) in space. */
#pragma once

#include <math.h>

#include "mesh/topology.h"

struct gd__axes {
    struct gd_vec3 origin;        /* normalised unit */
    struct gd_vec3 along, across; /* unit vectors: along the side, and across it into its face */
};

static inline struct gd__axes gd__axes_of_side(const struct gd_mesh *mesh, uint32_t side)
{
    struct gd_vec3 origin = mesh->position[mesh->origin[side]];
    struct gd_vec3 along = gd_vec3_sub(mesh->position[gd__side_destination(mesh, side)], origin),
                   apex = gd_vec3_sub(mesh->position[gd__side_apex(mesh, side)], origin);
    along = gd_vec3_scale(along, 1 / gd_vec3_length(along));
    struct gd_vec3 across = gd_vec3_along(apex, -gd_vec3_dot(apex, along), along);
    return (struct gd__axes){origin, along, gd_vec3_scale(across, 1 / gd_vec3_length(across))};
}

/* Returns the sum of the normals of a vertex' faces, weighted by angle; not of unit length. */
static inline struct gd_vec3 gd__vertex_normal(const struct gd_mesh *mesh, uint32_t vertex)
{
    struct gd_vec3 sum = {0, 0, 0};
    for (uint32_t i = mesh->fan_first[vertex]; i < mesh->fan_first[vertex + 1]; i++) {
        const struct gd_side *s = &mesh->side[mesh->fan[i].side];
        struct gd__axes axes = gd__axes_of_side(mesh, mesh->fan[i].side);
        sum =
            gd_vec3_along(sum, atan2(s->left_y, s->left_x), gd_vec3_cross(axes.along, axes.across));
    }
    return sum;
}
