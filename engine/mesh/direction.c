#include "gd/direction.h"

#include "base/tolerance.h"
#include "mesh/axes.h"
#include "mesh/polar.h"

/* Directions at a point. The surface around the point consists of sectors in counter-clockwise
 * order. A point in a face has one sector of 2 pi. A point on an edge has two sectors of pi. At a
 * vertex, the corner of each face is a sector. A direction is stored as a sector and an angle in
 * this sector. `turned` is an angle on the surface, measured from the zero direction. The public
 * interface scales the angles at an interior vertex so that they sum to 2 pi. This file scales them
 * only when it reads or returns them. */

struct sector {
    uint32_t face;
    /* unit vectors: along the start of the sector, and perpendicular to it in the face */
    struct gd_vec3 along, across;
    double begin, extent; /* angles on the surface */
};

struct ring {
    const struct gd_mesh *mesh;
    const struct gd_point *point;
    uint32_t first, end; /* numbers of the sectors: fan entries, or 0 and 1 at an edge */
    /* at a vertex, the fan entry with angle 0; on an edge, the side */
    uint32_t zero;
    /* total angle around the point; 2 pi at a point of an edge, even at the boundary, where there
       is only one sector */
    double total;
    double scale;   /* angle in the public interface, divided by the angle on the surface */
    bool is_closed; /* true if the point is interior */
};

/* --- rings ------------------------------------------------------------------------------------ */

static bool is_boundary_vertex(const struct ring *ring)
{
    return ring->point->kind == GD_POINT_VERTEX && !ring->is_closed;
}

/* Returns the fan entry of the neighbour with the lowest number. */
static uint32_t lowest_entry(const struct gd_mesh *mesh, uint32_t first, uint32_t end)
{
    uint32_t best = first;
    for (uint32_t i = first; i < end; i++)
        if (mesh->index_of_vertex[mesh->fan[i].tip] < mesh->index_of_vertex[mesh->fan[best].tip])
            best = i;
    return best;
}

static struct ring ring_of_vertex(const struct gd_mesh *mesh, const struct gd_point *point)
{
    uint32_t v = point->element, first = mesh->fan_first[v], end = mesh->fan_first[v + 1];
    bool is_closed = mesh->vertex_kind[v] != GD_VERTEX_BOUNDARY;
    double total = mesh->total_angle[v];
    return (struct ring){.mesh = mesh,
                         .point = point,
                         .first = first,
                         .end = end,
                         .zero = is_closed ? lowest_entry(mesh, first, end) : first,
                         .total = total,
                         .scale = is_closed ? 2 * M_PI / total : 1,
                         .is_closed = is_closed};
}

static struct ring ring_of_edge(const struct gd_mesh *mesh, const struct gd_point *point)
{
    uint32_t side = 2 * point->element;
    if (mesh->index_of_vertex[mesh->origin[side]] > mesh->index_of_vertex[mesh->origin[side + 1]])
        side++;
    bool has_left = !gd__side_is_boundary(mesh, side),
         has_right = !gd__side_is_boundary(mesh, side ^ 1);
    return (struct ring){.mesh = mesh,
                         .point = point,
                         .first = has_left ? 0 : 1,
                         .end = has_right ? 2 : 1,
                         .zero = side,
                         .total = 2 * M_PI,
                         .scale = 1,
                         .is_closed = has_left && has_right};
}

static struct ring ring_of(const struct gd_mesh *mesh, const struct gd_point *point)
{
    if (point->kind == GD_POINT_VERTEX) return ring_of_vertex(mesh, point);
    if (point->kind == GD_POINT_EDGE) return ring_of_edge(mesh, point);
    return (struct ring){
        .mesh = mesh, .point = point, .end = 1, .total = 2 * M_PI, .scale = 1, .is_closed = true};
}

/* --- sectors ---------------------------------------------------------------------------------- */

static struct sector sector_of_side(const struct gd_mesh *mesh, uint32_t side, double begin,
                                    double extent)
{
    struct gd__axes axes = gd__axes_of_side(mesh, side);
    return (struct sector){mesh->side_face[side], axes.along, axes.across, begin, extent};
}

/* Returns the sector of a face. It starts in the direction from the first to the second corner that
 * the input gives for the face. If the face was flipped, the input's second corner is the internal
 * third corner. */
static struct sector sector_of_face(const struct gd_mesh *mesh, uint32_t face)
{
    uint32_t side = mesh->face_side[face][0];
    struct sector sector = sector_of_side(mesh, side, 0, 2 * M_PI);
    if (!mesh->face_flipped[face]) return sector;
    double x = mesh->side[side].left_x, y = mesh->side[side].left_y;
    struct gd_vec3 along = sector.along;
    sector.along = gd_vec3_along(gd_vec3_scale(along, x), y, sector.across);
    sector.across = gd_vec3_along(gd_vec3_scale(along, -y), x, sector.across);
    return sector;
}

static struct sector sector_of_corner(const struct ring *ring, uint32_t i)
{
    const struct gd_mesh *mesh = ring->mesh;
    uint32_t side = mesh->fan[i].side;
    double begin = mesh->fan[i].angle - mesh->fan[ring->zero].angle;
    return sector_of_side(mesh, side, i < ring->zero ? begin + ring->total : begin,
                          atan2(mesh->side[side].left_y, mesh->side[side].left_x));
}

static struct sector sector_at(const struct ring *ring, uint32_t i)
{
    switch (ring->point->kind) {
    case GD_POINT_VERTEX:
        return sector_of_corner(ring, i);
    case GD_POINT_EDGE:
        return sector_of_side(ring->mesh, ring->zero ^ i, i * M_PI, M_PI);
    case GD_POINT_FACE:
        break;
    }
    return sector_of_face(ring->mesh, ring->point->element);
}

/* --- headings --------------------------------------------------------------------------------- */

/* A direction, as a sector and an angle in it. */
struct heading {
    struct sector sector;
    double angle; /* angle in the sector, in [0, extent] */
    /* angle between the given direction and the sector; 0 if the direction lies in the sector;
       INFINITY if there is no direction */
    double outside;
    /* if the heading was computed from a vector: the squared length of the difference between
       heading and vector, both scaled to length 1 */
    double deviation;
};

static const struct heading nowhere = {.outside = INFINITY};

static struct heading heading_in(const struct sector *sector, double angle)
{
    double within = fmin(fmax(angle, 0), sector->extent);
    return (struct heading){.sector = *sector, .angle = within, .outside = fabs(angle - within)};
}

static struct gd_vec3 vector_of(const struct heading *heading)
{
    return gd_vec3_along(gd_vec3_scale(heading->sector.along, cos(heading->angle)),
                         sin(heading->angle), heading->sector.across);
}

static double mesh_direction_angle_of(const struct ring *ring, const struct heading *heading)
{
    double angle = (heading->sector.begin + heading->angle) * ring->scale;
    return angle < 2 * M_PI || is_boundary_vertex(ring) ? angle : 0;
}

static struct gd_direction direction_of(const struct ring *ring, const struct heading *heading)
{
    return (struct gd_direction){.angle = mesh_direction_angle_of(ring, heading),
                                 .xyz = vector_of(heading),
                                 .face = {ring->mesh->index_of_face[heading->sector.face]}};
}

static enum gd_status refuse_outside(struct gd_detail *detail)
{
    return gd_fail(
        detail, GD_NOT_ON_SURFACE,
        "the direction leads over the boundary, off the surface; choose one that stays on it");
}

/* --- from an angle ---------------------------------------------------------------------------- */

static struct heading heading_at(const struct ring *ring, double turned)
{
    struct heading best = nowhere;
    for (uint32_t i = ring->first; i < ring->end && best.outside > 0; i++) {
        struct sector sector = sector_at(ring, i);
        double angle = turned - sector.begin;
        if (ring->point->kind != GD_POINT_VERTEX) angle = gd__turn_nearest(angle, sector.extent);
        struct heading heading = heading_in(&sector, angle);
        if (heading.outside < best.outside) best = heading;
    }
    return best;
}

/* Reduces the angle to [0, 2 pi) at an interior point; never returns -0. */
static double mesh_direction_reduce(const struct ring *ring, double angle)
{
    if (is_boundary_vertex(ring)) return angle + 0.0;
    angle = fmod(angle, 2 * M_PI) + 0.0;
    if (angle < 0) angle += 2 * M_PI;
    return angle < 2 * M_PI ? angle : 0;
}

enum gd_status gd_direction_at_angle(const struct gd_mesh *mesh, const struct gd_point *point,
                                     double angle, struct gd_direction *out,
                                     struct gd_detail *detail)
{
    if (!isfinite(angle))
        return gd_fail(detail, GD_INVALID_ARGUMENT, "the angle is not a finite number");
    struct ring ring = ring_of(mesh, point);
    angle = mesh_direction_reduce(&ring, angle);
    struct heading heading = heading_at(&ring, angle / ring.scale);
    if (!ring.is_closed && heading.outside > GD_TOL_INPUT) return refuse_outside(detail);
    *out = direction_of(&ring, &heading);
    if (heading.outside == 0) out->angle = angle;
    return GD_OK;
}

/* --- from a vector ---------------------------------------------------------------------------- */

/* Projects a vector into a sector. The projection is along the normal if there is a normal and the
 * face is not turned away from it. Otherwise it is perpendicular to the face. */
static struct heading mesh_direction_project(const struct sector *sector, struct gd_vec3 normal,
                                             struct gd_vec3 v)
{
    struct gd_vec3 up = gd_vec3_cross(sector->along, sector->across), w = v;
    double slope = gd_vec3_dot(up, normal);
    if (slope > 0) w = gd_vec3_along(v, -gd_vec3_dot(v, up) / slope, normal);
    double x = gd_vec3_dot(w, sector->along), y = gd_vec3_dot(w, sector->across);
    if (!(hypot(x, y) > GD_TOL_INPUT)) return nowhere;
    struct heading heading = heading_in(sector, gd__turn_nearest(atan2(y, x), sector->extent));
    struct gd_vec3 apart = gd_vec3_sub(vector_of(&heading), v);
    heading.deviation = gd_vec3_dot(apart, apart);
    return heading;
}

/* Returns true if `a` approximates the given vector better than `b`. A heading inside its sector is
 * better than one outside. If both are inside, the heading with the smaller deviation is better. */
static bool mesh_direction_is_better(const struct heading *a, const struct heading *b)
{
    bool a_inside = a->outside <= GD_TOL_BETTER, b_inside = b->outside <= GD_TOL_BETTER;
    if (a_inside && b_inside) return a->deviation < b->deviation;
    return a->outside < b->outside;
}

enum gd_status gd_direction_along(const struct gd_mesh *mesh, const struct gd_point *point,
                                  struct gd_vec3 vector, struct gd_direction *out,
                                  struct gd_detail *detail)
{
    struct gd_vec3 v = gd_vec3_unit(vector);
    if (!(gd_vec3_length(v) > 0))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the vector has no direction: it is zero, or not finite");
    struct ring ring = ring_of(mesh, point);
    struct gd_vec3 normal = {0, 0, 0};
    if (point->kind == GD_POINT_VERTEX)
        normal = gd_vec3_unit(gd__vertex_normal(mesh, point->element));
    struct heading best = nowhere;
    for (uint32_t i = ring.first; i < ring.end; i++) {
        struct sector sector = sector_at(&ring, i);
        struct heading heading = mesh_direction_project(&sector, normal, v);
        if (mesh_direction_is_better(&heading, &best)) best = heading;
    }
    if (isinf(best.outside))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the vector is normal to the surface there: it has no direction on the "
                       "surface; choose another one");
    if (!ring.is_closed && best.outside > GD_TOL_INPUT) return refuse_outside(detail);
    *out = direction_of(&ring, &best);
    return GD_OK;
}

/* --- derived directions ----------------------------------------------------------------------- */

struct gd_direction gd_direction_opposite(const struct gd_mesh *mesh, const struct gd_point *point,
                                          const struct gd_direction *back)
{
    struct gd_direction direction;
    if (!gd_direction_at_angle(mesh, point, back->angle + M_PI, &direction, NULL)) return direction;
    if (!gd_direction_at_angle(mesh, point, back->angle - M_PI, &direction, NULL)) return direction;
    struct ring ring = ring_of(mesh, point);
    return (struct gd_direction){.angle = mesh_direction_reduce(&ring, back->angle + M_PI),
                                 .xyz = gd_vec3_scale(back->xyz, -1),
                                 .face = back->face};
}

void gd_direction_axes(const struct gd_mesh *mesh, struct gd_face face, struct gd_vec3 *x,
                       struct gd_vec3 *y)
{
    struct sector sector = sector_of_face(mesh, mesh->face_of_index[face.index]);
    *x = sector.along;
    *y = sector.across;
}
