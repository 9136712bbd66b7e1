#include "field/close_seed.h"
#include "field/face_frame.h"
#include "mesh/segment.h"

/* Computes the gradient of the distance: the direction of the path's last leg at the point, as a
 * vector in space. */

/* A direction in the frame of a side of a face, not of unit length. */
struct direction {
    uint32_t side;
    double x, y;
};

static struct gd_vec3 in_space(const struct gd_mesh *mesh, const struct direction *d)
{
    struct gd__axes axes = gd__axes_of_side(mesh, d->side);
    struct gd_vec3 sum = gd_vec3_along(gd_vec3_scale(axes.along, d->x), d->y, axes.across);
    return gd_vec3_scale(sum, 1 / gd_vec3_length(sum));
}

static struct direction direction_between(const struct gd_mesh *mesh, uint32_t face,
                                          const struct gd_point *from, const struct gd_point *to)
{
    double a[3], b[3];
    gd__point_weights(mesh, from, face, a);
    gd__point_weights(mesh, to, face, b);
    int k = gd__main_corner(a);
    struct gd__local way = gd__leg_key_in_face(mesh, face, k, a, b);
    return (struct direction){mesh->face_side[face][k], way.x, way.y};
}

/* Returns the direction from a segment in the face to the point, perpendicular to the segment; zero
 * on the segment. */
static struct direction from_chord(const struct gd_mesh *mesh, uint32_t face,
                                   const struct gd__seed *seed, const struct gd_point *point)
{
    uint32_t side = mesh->face_side[face][0];
    struct gd__chord chord = gd__chord(mesh, face, 0, &seed->point, &seed->end);
    double height = gd__chord_height(&chord, gd__point_local(mesh, face, point)),
           left = height > 0 ? 1 : -1;
    if (fabs(height) <= GD_TOL_PLACE * mesh->side[side].length) return (struct direction){0};
    return (struct direction){side, -left * chord.along.y, left * chord.along.x};
}

/* Returns the direction of a leg that enters its face across a side: from the wedge's source, or
 * from the wedge's end if the leg bends there. If the point lies on this side of the face, the leg
 * arrives through the neighbouring face. */
static struct direction through_wedge(const struct gd_mesh *mesh, const struct gd__leg *leg,
                                      const struct gd_point *point)
{
    int k = gd__place_of_side(mesh->face_side[leg->face], leg->side);
    double weight[3];
    gd__point_weights(mesh, point, leg->face, weight);
    struct gd__local at =
        gd__side_local(&mesh->side[leg->side], weight[(k + 1) % 3], weight[(k + 2) % 3]);
    bool linear = gd__source_is_linear(leg->source);
    double dx = linear ? -leg->x : at.x - leg->x, dy = linear ? leg->y : at.y + leg->y;
    double straight = dy > 0 ? at.x - dx * (at.y / dy) : at.x;
    if (at.y == 0 && !gd__side_is_boundary(mesh, leg->side ^ 1))
        return (struct direction){leg->side ^ 1, -dx, -dy};
    if (fabs(straight - leg->parameter) <= GD_TOL_STRAIGHT * mesh->side[leg->side].length)
        return (struct direction){leg->side, dx, dy};
    return (struct direction){leg->side, at.x - leg->parameter, at.y};
}

static struct direction along_edge(const struct gd_field *field, uint32_t vertex, uint32_t source)
{
    const struct gd_mesh *mesh = field->mesh;
    uint32_t vertices = mesh->vertex_count, side = GD_NONE;
    if (source < vertices) {
        side = gd__side_between(mesh, source, vertex);
    } else if (field->seeds[source - vertices].point.kind == GD_POINT_EDGE) {
        side = 2 * field->seeds[source - vertices].point.element;
        if (gd__side_destination(mesh, side) != vertex) side ^= 1;
    } else {
        return (struct direction){0}; /* the vertex is a seed */
    }
    if (!gd__side_is_boundary(mesh, side)) return (struct direction){side, 1, 0};
    return (struct direction){side ^ 1, -1, 0};
}

/* Returns the direction of the last leg to a vertex, from the vertex' predecessor. */
static struct direction at_vertex(const struct gd_field *field, uint32_t vertex)
{
    struct gd__predecessor predecessor = field->predecessor[vertex];
    if (predecessor.side == GD_NONE) return along_edge(field, vertex, predecessor.source);
    const struct gd_side *s = &field->mesh->side[predecessor.side];
    if (predecessor.source != GD_NONE && gd__source_is_linear(predecessor.source))
        return (struct direction){predecessor.side, -predecessor.x, predecessor.y};
    return (struct direction){predecessor.side, s->left_length * s->left_x - predecessor.x,
                              s->left_length * s->left_y + predecessor.y};
}

static struct direction from_close_seed(const struct gd_field *field, const struct gd__leg *leg,
                                        const struct gd_point *point)
{
    struct gd__close_seed close;
    double weight[3];
    gd__point_weights(field->mesh, point, leg->face, weight);
    if (!gd__close_seed_find(field, leg->face, weight, GD__FAR, &close))
        return (struct direction){0};
    return (struct direction){close.side, close.way.x, close.way.y};
}

/* Returns true if the point lies on the segment from which the leg comes. The leg then has no
 * length, and its wedge lies on the segment itself. */
static bool is_on_segment(const struct gd_field *field, const struct gd__leg *leg,
                          const struct gd_point *point)
{
    if (!gd__source_is_linear(leg->source)) return false;
    const struct gd__seed *seed = &field->seeds[gd__field_seed_of(field, leg->source)];
    uint32_t edge = leg->side >> 1;
    return gd__point_is_on_edge(field->mesh, point, edge) &&
           gd__point_is_on_edge(field->mesh, &seed->point, edge) &&
           gd__point_is_on_edge(field->mesh, &seed->end, edge);
}

static struct direction of_leg(const struct gd_field *field, const struct gd__leg *leg,
                               const struct gd_point *point)
{
    if (point->kind == GD_POINT_VERTEX) return at_vertex(field, point->element);
    if (leg->kind == GD__LEG_WEDGE && is_on_segment(field, leg, point))
        return (struct direction){0};
    if (leg->kind == GD__LEG_WEDGE) return through_wedge(field->mesh, leg, point);
    if (leg->kind == GD__LEG_CLOSE) return from_close_seed(field, leg, point);
    struct gd_point corner = {.kind = GD_POINT_VERTEX, .element = leg->from};
    const struct gd__seed *seed = leg->kind == GD__LEG_SEED ? &field->seeds[leg->from] : NULL;
    if (seed && seed->is_segment) return from_chord(field->mesh, leg->face, seed, point);
    return direction_between(field->mesh, leg->face, seed ? &seed->point : &corner, point);
}

/* A path arrives at a point of a boundary edge from inside. Rounding may turn its direction across
 * the boundary: by the error of the stored ends of wedges, divided by the length of the leg. The
 * direction is then along the boundary. */
static struct gd_vec3 inside_boundary(const struct gd_mesh *mesh, const struct gd_point *point,
                                      struct gd_vec3 gradient)
{
    if (point->kind != GD_POINT_EDGE) return gradient;
    for (uint32_t side = 2 * point->element; side < 2 * point->element + 2; side++) {
        if (!gd__side_is_boundary(mesh, side ^ 1)) continue;
        struct gd__axes axes = gd__axes_of_side(mesh, side);
        if (gd_vec3_dot(gradient, axes.across) > 0)
            return gd_vec3_scale(axes.along, copysign(1, gd_vec3_dot(gradient, axes.along)));
    }
    return gradient;
}

enum gd_status gd_field_gradient(const struct gd_field *field, const struct gd_point *point,
                                 struct gd_vec3 *out)
{
    struct gd__leg leg = gd__field_leg(field, point);
    if (leg.distance > field->reach) return GD_BEYOND_REACH;
    if (leg.kind == GD__LEG_NONE) return GD_NOT_ON_SURFACE;
    struct direction direction = of_leg(field, &leg, point);
    if (direction.x == 0 && direction.y == 0) return GD_INVALID_ARGUMENT;
    struct gd_vec3 gradient = in_space(field->mesh, &direction);
    /* for a very short leg the square underflows */
    if (!isfinite(gd_vec3_length(gradient))) return GD_INVALID_ARGUMENT;
    *out = inside_boundary(field->mesh, point, gradient);
    return GD_OK;
}
