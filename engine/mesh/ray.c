/* gd_locate_first_hit. The intersection test is watertight: two faces test the ray against their
 * common edge with the same numbers, so no ray passes between them. Source: S. Woop, C. Benthin, I.
 * Wald, "Watertight ray/triangle intersection", JCGT 2(1), 2013. */
#include "base/tolerance.h"
#include "mesh/bvh.h"
#include "mesh/closest_point.h"

/* A point in the frame of the ray, which is the axis x = y = 0 in the direction of z. */
struct sheared {
    double x, y, z;
};

struct ray {
    struct gd__bvh_search search; /* its keys are z */
    const struct gd_mesh *mesh;
    struct gd_vec3 origin,
        /* in the normalised unit; the largest coordinate of `direction` is +-1 */
        direction;
    struct gd_vec3 inverse; /* 1 / direction, by coordinate */
    int axis;               /* coordinate in which `direction` is largest */
    double slack;           /* rounding error of a coordinate */
    double best;
    uint32_t face; /* the first face hit so far, or GD_NONE if there is none */
    double weight[3];
};

static struct sheared shear(const struct ray *ray, uint32_t vertex)
{
    struct gd_vec3 p = gd_vec3_sub(ray->mesh->position[vertex], ray->origin), d = ray->direction;
    if (ray->axis == 0)
        return (struct sheared){p.y - d.y * d.x * p.x, p.z - d.z * d.x * p.x, d.x * p.x};
    if (ray->axis == 1)
        return (struct sheared){p.z - d.z * d.y * p.y, p.x - d.x * d.y * p.y, d.y * p.y};
    return (struct sheared){p.x - d.x * d.z * p.z, p.y - d.y * d.z * p.z, d.z * p.z};
}

/* Returns twice the signed area between the ray, a and b. If a and b are exchanged, the result
 * changes its sign and nothing else, even in the last bit. */
static double mesh_ray_area(struct sheared a, struct sheared b)
{
    return a.x * b.y - a.y * b.x;
}

static void mesh_ray_offer(struct ray *ray, uint32_t face, double z, const double weight[3])
{
    const uint32_t *index = ray->mesh->index_of_face;
    if (!(z >= -ray->slack)) return;
    z = fmax(z, 0);
    if (ray->face != GD_NONE &&
        (z > ray->best || (z == ray->best && index[face] > index[ray->face])))
        return;
    ray->best = z;
    ray->face = face;
    for (int k = 0; k < 3; k++) ray->weight[k] = weight[k];
    ray->search.limit = z + ray->slack;
}

/* A crossing of the ray with the border of a face whose plane contains the ray. */
struct crossing {
    double z;
    double weight[3];
};

/* Returns the point where the ray meets side k of the face. z is NaN if the ray does not meet the
 * side. If the side lies along the ray, returns the side's point that is nearest to the ray's
 * origin. */
static struct crossing cross_side(const struct ray *ray, const struct sheared p[3], int k)
{
    struct sheared a = p[k], b = p[(k + 1) % 3];
    double x = b.x - a.x, y = b.y - a.y, squared = x * x + y * y;
    double t = squared > 0 ? -(a.x * x + a.y * y) / squared : -a.z / (b.z - a.z);
    t = fmin(fmax(t, 0), 1);
    bool met = fabs(a.x + t * x) <= ray->slack && fabs(a.y + t * y) <= ray->slack;
    struct crossing crossing = {.z = met ? a.z + t * (b.z - a.z) : NAN};
    crossing.weight[k] = 1 - t;
    crossing.weight[(k + 1) % 3] = t;
    return crossing;
}

/* Handles a face whose plane contains the ray. The ray is in the face between its first and its
 * last crossing of the face's border. The origin of the ray may lie in the face. */
static void offer_edge_on(struct ray *ray, uint32_t face, const struct sheared p[3])
{
    struct crossing first = {.z = INFINITY}, last = {.z = -INFINITY};
    for (int k = 0; k < 3; k++) {
        struct crossing c = cross_side(ray, p, k);
        if (c.z < first.z) first = c;
        if (c.z > last.z) last = c;
    }
    if (first.z < 0 && last.z > 0) {
        double t = first.z / (first.z - last.z);
        for (int k = 0; k < 3; k++) first.weight[k] += t * (last.weight[k] - first.weight[k]);
        first.z = 0;
    }
    if (first.z < INFINITY) mesh_ray_offer(ray, face, first.z, first.weight);
}

static void visit_face(struct gd__bvh_search *search, uint32_t face)
{
    struct ray *ray = (struct ray *)search;
    struct sheared p[3];
    for (int k = 0; k < 3; k++) p[k] = shear(ray, ray->mesh->origin[ray->mesh->face_side[face][k]]);
    double u = mesh_ray_area(p[1], p[2]), v = mesh_ray_area(p[2], p[0]),
           w = mesh_ray_area(p[0], p[1]), sum = u + v + w;
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return;
    if (sum == 0) {
        offer_edge_on(ray, face, p);
        return;
    }
    double weight[3] = {u / sum, v / sum, w / sum};
    mesh_ray_offer(ray, face, weight[0] * p[0].z + weight[1] * p[1].z + weight[2] * p[2].z, weight);
}

/* Clips the range [*enter, *leave] of the ray's parameter to the part where one coordinate is
 * between min and max. If the computation multiplies 0 by infinity, the result is NaN. Every
 * comparison with NaN is false, so the coordinate does not limit the range then. */
static void clip_slab(double min, double max, double origin, double inverse, double *enter,
                      double *leave)
{
    double a = (min - origin) * inverse, b = (max - origin) * inverse;
    double first = inverse < 0 ? b : a, last = inverse < 0 ? a : b;
    if (first > *enter) *enter = first;
    if (last < *leave) *leave = last;
}

static double bound_of_box(const struct gd__bvh_search *search, const struct gd__box *box)
{
    const struct ray *ray = (const struct ray *)search;
    double enter = -ray->slack, leave = INFINITY, s = ray->slack;
    clip_slab(box->min.x - s, box->max.x + s, ray->origin.x, ray->inverse.x, &enter, &leave);
    clip_slab(box->min.y - s, box->max.y + s, ray->origin.y, ray->inverse.y, &enter, &leave);
    clip_slab(box->min.z - s, box->max.z + s, ray->origin.z, ray->inverse.z, &enter, &leave);
    return enter <= leave + s ? enter : INFINITY;
}

static struct ray make_ray(const struct gd_mesh *mesh, struct gd_vec3 origin,
                           struct gd_vec3 direction)
{
    double largest = gd__largest_coordinate(direction);
    struct ray ray = {
        .search = {INFINITY, bound_of_box, visit_face},
        .mesh = mesh,
        .origin = gd_vec3_scale(origin, 1 / mesh->unit),
        .direction = {direction.x / largest, direction.y / largest, direction.z / largest},
        .axis = fabs(direction.x) == largest   ? 0
                : fabs(direction.y) == largest ? 1
                                               : 2,
        .best = INFINITY,
        .face = GD_NONE,
    };
    ray.inverse = (struct gd_vec3){1 / ray.direction.x, 1 / ray.direction.y, 1 / ray.direction.z};
    ray.slack = GD_TOL_LOCATE * fmax(gd__largest_coordinate(ray.origin), gd__bvh_magnitude(mesh));
    return ray;
}

static struct gd_vec3 hit_position(const struct ray *ray)
{
    struct gd_vec3 p = {0, 0, 0};
    for (int k = 0; k < 3; k++)
        p = gd_vec3_along(
            p, ray->weight[k],
            ray->mesh->position[ray->mesh->origin[ray->mesh->face_side[ray->face][k]]]);
    return p;
}

enum gd_status gd_locate_first_hit(const struct gd_mesh *mesh, struct gd_vec3 origin,
                                   struct gd_vec3 direction, struct gd_point *out,
                                   struct gd_detail *detail)
{
    if (!gd_vec3_is_finite(origin) || !gd_vec3_is_finite(direction))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "a coordinate of the ray is not a finite number");
    if (gd__largest_coordinate(direction) == 0)
        return gd_fail(detail, GD_INVALID_ARGUMENT, "the ray's direction has length zero");
    struct ray ray = make_ray(mesh, origin, direction);
    if (gd__largest_coordinate(ray.origin) <= GD_EXTENT_RATIO) gd__bvh_run(mesh, &ray.search);
    if (ray.face == GD_NONE)
        return gd_fail(detail, GD_NOT_ON_SURFACE, "the ray does not meet the surface");
    *out = gd__face_closest_point(mesh, ray.face, hit_position(&ray),
                                  gd__largest_coordinate(ray.origin));
    return GD_OK;
}
