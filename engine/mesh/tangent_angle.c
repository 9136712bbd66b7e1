#include "mesh/tangent_angle.h"

#include <math.h>

#include "mesh/segment.h"

static bool is_in_face(const struct gd_mesh *mesh, const struct gd_point *point, uint32_t face)
{
    return face != GD_NONE && gd__face_contains(mesh, face, point);
}

/* Returns the angle of a direction at a point of a face, in the frame of `side`. Computes the
 * direction from differences of weights, because these are precise for short vectors. */
static double angle_in_face(const struct gd_mesh *mesh, uint32_t side, const struct gd_point *at,
                            const struct gd_point *to)
{
    uint32_t face = mesh->side_face[side];
    double from[3], there[3];
    gd__point_weights(mesh, at, face, from);
    gd__point_weights(mesh, to, face, there);
    struct gd__local d = gd__leg_key_in_face(
        mesh, face, gd__place_of_side(mesh->face_side[face], side), from, there);
    return atan2(d.y, d.x);
}

/* Returns the angle of a direction from the first entry of the vertex' fan. */
static double angle_at_vertex(const struct gd_mesh *mesh, const struct gd_point *at,
                              const struct gd_point *to)
{
    for (uint32_t i = mesh->fan_first[at->element]; i < mesh->fan_first[at->element + 1]; i++) {
        uint32_t side = mesh->fan[i].side;
        if (is_in_face(mesh, to, mesh->side_face[side]))
            return mesh->fan[i].angle + angle_in_face(mesh, side, at, to);
    }
    return NAN;
}

/* Returns the angle of a direction from the edge's side 0. */
static double angle_at_edge(const struct gd_mesh *mesh, const struct gd_point *at,
                            const struct gd_point *to)
{
    for (uint32_t k = 0; k < 2; k++) {
        uint32_t side = 2 * at->element + k;
        if (is_in_face(mesh, to, mesh->side_face[side]))
            return k * M_PI + angle_in_face(mesh, side, at, to);
    }
    return NAN;
}

static double angle_towards(const struct gd_mesh *mesh, const struct gd_point *at,
                            const struct gd_point *to)
{
    switch (at->kind) {
    case GD_POINT_VERTEX:
        return angle_at_vertex(mesh, at, to);
    case GD_POINT_EDGE:
        return angle_at_edge(mesh, at, to);
    case GD_POINT_FACE:
        break;
    }
    return is_in_face(mesh, to, at->element)
               ? angle_in_face(mesh, mesh->face_side[at->element][0], at, to)
               : NAN;
}

double gd__tangent_angle(const struct gd_mesh *mesh, const struct gd_point *at,
                         const struct gd_point *a, const struct gd_point *b)
{
    double apart = fabs(angle_towards(mesh, at, a) - angle_towards(mesh, at, b)), total = 2 * M_PI;
    if (at->kind == GD_POINT_VERTEX) {
        if (mesh->vertex_kind[at->element] == GD_VERTEX_BOUNDARY) return apart;
        total = mesh->total_angle[at->element];
    }
    return fabs(remainder(apart, total));
}
