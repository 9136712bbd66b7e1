/* The closest point of a triangle is the nearest of four candidates: one on each edge, and the foot
 * of the perpendicular if it lies inside. This method is also correct for slivers and faces of area
 * zero, for which the usual tests of the signs of areas fail. */
#include "mesh/closest_point.h"

#include "base/tolerance.h"
#include "mesh/canonical.h"

/* The corners of a face. */
struct corners {
    const uint32_t *side;
    struct gd_vec3 p[3];
};

static struct corners corners_of(const struct gd_mesh *mesh, uint32_t face)
{
    struct corners c = {.side = mesh->face_side[face]};
    for (int k = 0; k < 3; k++) c.p[k] = mesh->position[mesh->origin[c.side[k]]];
    return c;
}

/* The point of an edge nearest to q. */
struct edge_foot {
    double t;
    struct gd_vec3 position;
};

/* Returns the closest point on side k of the face. Computes it from the edge's side 0, so that both
 * faces of the edge get the same result. */
static struct edge_foot foot_on_side(const struct corners *c, int k, struct gd_vec3 q)
{
    int end = k == 2 ? 0 : k + 1, backwards = c->side[k] % 2;
    struct gd_vec3 a = c->p[backwards ? end : k], b = c->p[backwards ? k : end],
                   along = gd_vec3_sub(b, a);
    double t = gd_vec3_dot(gd_vec3_sub(q, a), along) / gd_vec3_dot(along, along);
    if (!(t > 0)) return (struct edge_foot){0, a};
    if (t >= 1) return (struct edge_foot){1, b};
    return (struct edge_foot){t, gd_vec3_along(a, t, along)};
}

struct face_foot {
    bool inside;
    double weight[3];
    struct gd_vec3 position;
};

/* Returns the foot of the perpendicular from q. Computes it from the areas of the triangles that q
 * forms with the edges. */
static struct face_foot foot_in_plane(const struct corners *c, struct gd_vec3 q)
{
    struct gd_vec3 edge[3];
    for (int k = 0; k < 3; k++) edge[k] = gd_vec3_sub(c->p[(k + 1) % 3], c->p[k]);
    struct gd_vec3 normal = gd_vec3_cross(edge[0], edge[1]);
    double scale = 1 / gd_vec3_dot(normal, normal);
    struct face_foot foot = {.inside = true};
    for (int k = 0; k < 3; k++) {
        struct gd_vec3 area = gd_vec3_cross(edge[(k + 1) % 3], gd_vec3_sub(q, c->p[(k + 1) % 3]));
        foot.weight[k] = gd_vec3_dot(area, normal) * scale;
        foot.inside = foot.inside && foot.weight[k] > 0 && foot.weight[k] < 1;
    }
    struct gd_vec3 moved =
        gd_vec3_sub(gd_vec3_scale(edge[0], foot.weight[1]), gd_vec3_scale(edge[2], foot.weight[2]));
    foot.position = gd_vec3_add(c->p[0], moved);
    return foot;
}

static double squared_distance(struct gd_vec3 a, struct gd_vec3 b)
{
    struct gd_vec3 d = gd_vec3_sub(a, b);
    return gd_vec3_dot(d, d);
}

/* The nearest of the four candidates. */
struct nearest {
    double squared;
    struct gd_vec3 position;
    /* number of the side of the face that contains the point; -1 if the point is inside the face */
    int side;
};

static struct nearest nearest_of(const struct corners *c, struct gd_vec3 q,
                                 const struct face_foot *inner)
{
    struct nearest nearest = {inner->inside ? squared_distance(q, inner->position) : INFINITY,
                              inner->position, -1};
    for (int k = 0; k < 3; k++) {
        struct gd_vec3 p = foot_on_side(c, k, q).position;
        double squared = squared_distance(q, p);
        if (squared < nearest.squared) nearest = (struct nearest){squared, p, k};
    }
    return nearest;
}

double gd__face_square_distance(const struct gd_mesh *mesh, uint32_t face, struct gd_vec3 q)
{
    struct corners c = corners_of(mesh, face);
    struct face_foot inner = foot_in_plane(&c, q);
    return nearest_of(&c, q, &inner).squared;
}

/* Returns the rounding error of coordinates up to `magnitude`, or up to the largest coordinate of
 * the face if that is larger. */
static double rounding_near(const struct corners *c, double magnitude)
{
    for (int k = 0; k < 3; k++) magnitude = fmax(magnitude, gd__largest_coordinate(c->p[k]));
    return GD_TOL_LOCATE * magnitude;
}

struct gd_point gd__face_closest_point(const struct gd_mesh *mesh, uint32_t face, struct gd_vec3 q,
                                       double magnitude)
{
    struct corners c = corners_of(mesh, face);
    struct face_foot inner = foot_in_plane(&c, q);
    struct nearest nearest = nearest_of(&c, q, &inner);
    double tolerance = rounding_near(&c, magnitude);
    for (int k = 0; k < 3; k++) {
        if (gd_vec3_distance(nearest.position, c.p[k]) <= tolerance)
            return gd__point_of_vertex(mesh->origin[c.side[k]]);
    }
    for (int k = 0; k < 3 && nearest.side < 0; k++) {
        struct gd_vec3 p = foot_on_side(&c, k, nearest.position).position;
        if (gd_vec3_distance(nearest.position, p) <= tolerance) nearest.side = k;
    }
    if (nearest.side < 0) return gd__point_of_face(mesh, face, inner.weight);
    return gd__point_of_edge(mesh, c.side[nearest.side] / 2, foot_on_side(&c, nearest.side, q).t);
}
