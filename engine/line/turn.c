#include "line/turn.h"

#include "field/face_frame.h"
#include "mesh/segment.h"

static uint32_t number_in_face(const struct gd_mesh *mesh, uint32_t side)
{
    return (uint32_t)gd__place_of_side(mesh->face_side[mesh->side_face[side]], side);
}

/* --- around a point --------------------------------------------------------------------------- */

double gd__turn_total(const struct gd_mesh *mesh, const struct gd_point *point)
{
    return point->kind == GD_POINT_VERTEX ? mesh->total_angle[point->element] : 2 * M_PI;
}

bool gd__turn_is_closed(const struct gd_mesh *mesh, const struct gd_point *point)
{
    uint32_t side = 2 * point->element;
    if (point->kind == GD_POINT_VERTEX)
        return mesh->vertex_kind[point->element] != GD_VERTEX_BOUNDARY;
    return point->kind == GD_POINT_FACE ||
           !(gd__side_is_boundary(mesh, side) || gd__side_is_boundary(mesh, side ^ 1));
}

static bool is_boundary_vertex(const struct gd_mesh *mesh, const struct gd_point *point)
{
    return point->kind == GD_POINT_VERTEX &&
           mesh->vertex_kind[point->element] == GD_VERTEX_BOUNDARY;
}

double gd__turn_reduce(const struct gd_mesh *mesh, const struct gd_point *point, double turn)
{
    if (is_boundary_vertex(mesh, point)) return turn;
    double total = gd__turn_total(mesh, point);
    turn = fmod(turn, total);
    if (turn < 0) turn += total;
    return turn < total ? turn : 0;
}

/* --- angles ----------------------------------------------------------------------------------- */

/* Returns the side of a face that leaves one of its corners. */
static uint32_t side_from(const struct gd_mesh *mesh, uint32_t face, uint32_t vertex)
{
    int k = 0;
    while (mesh->origin[mesh->face_side[face][k]] != vertex) k++;
    return mesh->face_side[face][k];
}

/* Returns the turn of angle zero. */
static double zero_of(const struct gd_mesh *mesh, const struct gd_point *point)
{
    struct gd_direction zero;
    uint32_t side = 2 * point->element;
    switch (point->kind) {
    /* the direction of angle 0 leads along a side of its face */
    case GD_POINT_VERTEX:
        if (gd_direction_at_angle(mesh, point, 0, &zero, NULL)) return 0;
        side = side_from(mesh, mesh->face_of_index[zero.face.index], point->element);
        return mesh->fan[gd__fan_entry(mesh, side)].angle;
    case GD_POINT_EDGE:
        return mesh->index_of_vertex[mesh->origin[side]] <
                       mesh->index_of_vertex[mesh->origin[side + 1]]
                   ? 0
                   : M_PI;
    case GD_POINT_FACE:
        break;
    }
    if (!mesh->face_flipped[point->element]) return 0;
    const struct gd_side *s = &mesh->side[mesh->face_side[point->element][0]];
    return atan2(s->left_y, s->left_x);
}

double gd__turn_scale(const struct gd_mesh *mesh, const struct gd_point *point)
{
    return is_boundary_vertex(mesh, point) ? 1 : gd__turn_total(mesh, point) / (2 * M_PI);
}

double gd__turn_of_angle(const struct gd_mesh *mesh, const struct gd_point *point, double angle)
{
    return gd__turn_reduce(mesh, point, zero_of(mesh, point) + angle * gd__turn_scale(mesh, point));
}

double gd__turn_to_angle(const struct gd_mesh *mesh, const struct gd_point *point, double turn)
{
    double angle =
        gd__turn_reduce(mesh, point, turn - zero_of(mesh, point)) / gd__turn_scale(mesh, point);
    return angle < 2 * M_PI || is_boundary_vertex(mesh, point) ? angle : 0;
}

/* --- directions ------------------------------------------------------------------------------- */

struct gd_direction gd__turn_direction(const struct gd_mesh *mesh, const struct gd_point *point,
                                       double turn)
{
    struct gd_direction direction;
    double angle = gd__turn_to_angle(mesh, point, turn);
    if (!gd_direction_at_angle(mesh, point, angle, &direction, NULL)) return direction;
    struct gd__ray ray = gd__turn_ray(mesh, point, turn);
    struct gd__axes axes = gd__axes_of_side(mesh, ray.side);
    return (struct gd_direction){
        .angle = angle,
        .xyz = gd_vec3_along(gd_vec3_scale(axes.along, ray.dx), ray.dy, axes.across),
        .face = {mesh->index_of_face[mesh->side_face[ray.side]]}};
}

static double corner_angle(const struct gd_mesh *mesh, uint32_t side)
{
    return atan2(mesh->side[side].left_y, mesh->side[side].left_x);
}

double gd__turn_in_face(const struct gd_mesh *mesh, const struct gd_point *point, uint32_t side,
                        double x, double y)
{
    uint32_t face = mesh->side_face[side], own = mesh->face_side[face][0], k = 0;
    struct gd__face_frame frame = gd__face_frame_of(mesh, face);
    if (point->kind == GD_POINT_VERTEX) own = side_from(mesh, face, point->element);
    if (point->kind == GD_POINT_EDGE)
        own = gd__side_is_boundary(mesh, 2 * point->element) ? 2 * point->element + 1
                                                             : 2 * point->element;
    if (point->kind == GD_POINT_EDGE && mesh->side_face[own] != face) own ^= 1;
    k = number_in_face(mesh, own);
    struct gd__local d = gd__face_frame_turn(&frame, (int)number_in_face(mesh, side), x, y),
                     axis = frame.along[k];
    double angle = atan2(axis.x * d.y - axis.y * d.x, axis.x * d.x + axis.y * d.y);
    if (point->kind == GD_POINT_VERTEX)
        angle = mesh->fan[gd__fan_entry(mesh, own)].angle +
                gd__turn_nearest(angle, corner_angle(mesh, own));
    if (point->kind == GD_POINT_EDGE && own & 1) angle += M_PI;
    return gd__turn_reduce(mesh, point, angle);
}

static bool is_in_face_of(const struct gd_mesh *mesh, uint32_t side, const struct gd_point *point)
{
    uint32_t face = mesh->side_face[side];
    return face != GD_NONE && gd__face_contains(mesh, face, point);
}

/* Returns a side of a face that contains both points; GD_NONE if there is none. */
static uint32_t common_side(const struct gd_mesh *mesh, const struct gd_point *at,
                            const struct gd_point *to)
{
    uint32_t side = 2 * at->element;
    switch (at->kind) {
    case GD_POINT_VERTEX:
        for (uint32_t i = mesh->fan_first[at->element]; i < mesh->fan_first[at->element + 1]; i++)
            if (is_in_face_of(mesh, mesh->fan[i].side, to)) return mesh->fan[i].side;
        return GD_NONE;
    case GD_POINT_EDGE:
        if (!is_in_face_of(mesh, side, to)) side++;
        break;
    case GD_POINT_FACE:
        side = mesh->face_side[at->element][0];
        break;
    }
    return is_in_face_of(mesh, side, to) ? side : GD_NONE;
}

/* Returns the turn of the direction to a point. Computes the direction from differences of weights,
 * because these are precise for short vectors. Returns NaN if the points have no common face. */
static double turn_towards(const struct gd_mesh *mesh, const struct gd_point *at,
                           const struct gd_point *to)
{
    uint32_t side = common_side(mesh, at, to);
    double from[3], there[3];
    if (side == GD_NONE) return NAN;
    gd__point_weights(mesh, at, mesh->side_face[side], from);
    gd__point_weights(mesh, to, mesh->side_face[side], there);
    struct gd__local d = gd__leg_key_in_face(mesh, mesh->side_face[side],
                                             (int)number_in_face(mesh, side), from, there);
    return gd__turn_in_face(mesh, at, side, d.x, d.y);
}

double gd__turn_between(const struct gd_mesh *mesh, const struct gd_point *at,
                        const struct gd_point *a, const struct gd_point *b)
{
    double apart = fabs(turn_towards(mesh, at, a) - turn_towards(mesh, at, b));
    return is_boundary_vertex(mesh, at) ? apart : fabs(remainder(apart, gd__turn_total(mesh, at)));
}

/* --- rays ------------------------------------------------------------------------------------- */

static struct gd__ray ray_from(uint32_t side, double x, double y, double angle)
{
    return (struct gd__ray){side, x, y, cos(angle), sin(angle)};
}

static struct gd__ray ray_from_vertex(const struct gd_mesh *mesh, uint32_t vertex, double turn)
{
    uint32_t i = mesh->fan_first[vertex], end = mesh->fan_first[vertex + 1];
    while (i + 1 < end && mesh->fan[i + 1].angle <= turn) i++;
    return ray_from(mesh->fan[i].side, 0, 0, turn - mesh->fan[i].angle);
}

/* Returns the ray of a turn at a point of an edge. Due to rounding, a turn along a boundary edge
 * may lie in the half plane without a face. It is then mirrored into the other half plane. */
static struct gd__ray ray_from_edge(const struct gd_mesh *mesh, const struct gd_point *point,
                                    double turn)
{
    uint32_t side = 2 * point->element + (turn > M_PI);
    double angle = turn > M_PI ? turn - M_PI : turn;
    if (gd__side_is_boundary(mesh, side)) {
        side ^= 1;
        angle -= M_PI;
    }
    double part = side & 1 ? gd__edge_rest(point) : point->weight[0];
    return ray_from(side, part * mesh->side[side].length, 0, angle);
}

struct gd__ray gd__turn_ray(const struct gd_mesh *mesh, const struct gd_point *point, double turn)
{
    if (point->kind == GD_POINT_VERTEX) return ray_from_vertex(mesh, point->element, turn);
    if (point->kind == GD_POINT_EDGE) return ray_from_edge(mesh, point, turn);
    uint32_t side = mesh->face_side[point->element][0];
    struct gd__local at = gd__face_local(mesh, side, point->weight);
    return ray_from(side, at.x, at.y, turn);
}
