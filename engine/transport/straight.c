#include "transport/straight.h"

#include "base/tolerance.h"
#include "mesh/axes.h"

/* --- normals ---------------------------------------------------------------------------------- */

/* The plane through a vertex that contains the arriving line and the normal. `ahead` is the line's
 * direction without its component along the normal. */
struct plane {
    struct gd_vec3 across, ahead;
};

static struct plane plane_of(const struct gd_mesh *mesh, uint32_t vertex, double back,
                             struct gd_vec3 normal)
{
    struct gd_point point = {.kind = GD_POINT_VERTEX, .element = vertex};
    struct gd__ray ray = gd__turn_ray(mesh, &point, back);
    struct gd__axes axes = gd__axes_of_side(mesh, ray.side);
    struct gd_vec3 v = gd_vec3_along(gd_vec3_scale(axes.along, ray.dx), ray.dy, axes.across);
    return (struct plane){gd_vec3_cross(v, normal),
                          gd_vec3_sub(gd_vec3_scale(normal, gd_vec3_dot(v, normal)), v)};
}

/* Intersects the plane with the edge opposite to the vertex in the face of a fan entry. Returns the
 * cosine of the angle between `ahead` and the direction to the intersection, and sets *turn to the
 * turn of this direction. Returns -1 if there is no intersection. */
static double meet_face(const struct gd_mesh *mesh, uint32_t vertex, const struct gd_fan *fan,
                        const struct plane *plane, double *turn)
{
    struct gd_vec3 origin = mesh->position[vertex],
                   w = gd_vec3_sub(mesh->position[fan->tip], origin),
                   apex = gd_vec3_sub(mesh->position[gd__side_apex(mesh, fan->side)], origin),
                   u = gd_vec3_sub(apex, w);
    double s = -gd_vec3_dot(plane->across, w) / gd_vec3_dot(plane->across, u);
    if (!(s >= -GD_TOL_HIT && s <= 1 + GD_TOL_HIT)) return -1;
    struct gd_vec3 x = gd_vec3_along(w, s, u);
    *turn = fan->angle + atan2(gd_vec3_length(gd_vec3_cross(w, x)), gd_vec3_dot(w, x));
    return gd_vec3_dot(x, plane->ahead) / (gd_vec3_length(x) * gd_vec3_length(plane->ahead));
}

/* Computes the turn of a direction in the plane of the line and the normal. If there are several
 * such directions, uses the one nearest to `ahead`. Returns false if there is none. */
static bool by_normal(const struct gd_mesh *mesh, uint32_t vertex, double back,
                      struct gd_vec3 normal, double *out)
{
    struct plane plane = plane_of(mesh, vertex, back, gd_vec3_unit(normal));
    double best = 0, turn = 0;
    if (!(gd_vec3_length(plane.across) > GD_TOL_HIT)) return false;
    for (uint32_t i = mesh->fan_first[vertex]; i < mesh->fan_first[vertex + 1]; i++) {
        double cosine = meet_face(mesh, vertex, &mesh->fan[i], &plane, &turn);
        if (!(cosine > best)) continue;
        best = cosine;
        *out = turn;
    }
    return best > 0;
}

/* --- the rules -------------------------------------------------------------------------------- */

static bool at_boundary(double total, double back, double *out)
{
    if (back + M_PI <= total + GD_TOL_HIT)
        *out = fmin(back + M_PI, total);
    else if (back - M_PI >= -GD_TOL_HIT)
        *out = fmax(back - M_PI, 0);
    else
        return false;
    return true;
}

bool gd__straight_on(const struct gd_mesh *mesh, uint32_t vertex, double back,
                     const struct gd_trace_options *options, double *out)
{
    if (mesh->vertex_kind[vertex] == GD_VERTEX_BOUNDARY)
        return at_boundary(mesh->total_angle[vertex], back, out);
    double total = mesh->total_angle[vertex], ahead = back + 0.5 * total;
    *out = ahead < total ? ahead : ahead - total;
    if (options->vertex_rule == GD_VERTEX_RULE_NORMAL)
        by_normal(mesh, vertex, back,
                  options->normals ? options->normals[mesh->index_of_vertex[vertex]]
                                   : gd__vertex_normal(mesh, vertex),
                  out);
    return true;
}

bool gd__straight_slide(const struct gd_mesh *mesh, uint32_t vertex, double back, uint32_t *side,
                        bool *forward)
{
    uint32_t first = mesh->fan[mesh->fan_first[vertex]].side,
             last = mesh->fan[mesh->fan_first[vertex + 1] - 1].side;
    double to_first = fabs(back - M_PI), to_last = fabs(back + M_PI - mesh->total_angle[vertex]);
    if (!(fmin(to_first, to_last) < M_PI_2 - GD_TOL_HIT)) return false;
    *forward = to_last < to_first;
    *side = *forward ? mesh->side[last].left : first ^ 1;
    return true;
}
