/* gd_locate_nearest: branch and bound over the bounding boxes. */
#include "base/tolerance.h"
#include "mesh/bvh.h"
#include "mesh/closest_point.h"

struct nearest {
    struct gd__bvh_search search; /* a search whose keys are squared distances */
    const struct gd_mesh *mesh;
    struct gd_vec3 q;
    double slack; /* rounding error of a distance */
    double best;
    uint32_t face; /* the nearest face so far, or GD_NONE if there is none */
};

static double bound_of_box(const struct gd__bvh_search *search, const struct gd__box *box)
{
    return gd__box_square_distance(box, ((const struct nearest *)search)->q);
}

static void visit_face(struct gd__bvh_search *search, uint32_t face)
{
    struct nearest *nearest = (struct nearest *)search;
    double distance = gd__face_square_distance(nearest->mesh, face, nearest->q);
    const uint32_t *index = nearest->mesh->index_of_face;
    bool better = nearest->face == GD_NONE || distance < nearest->best ||
                  (distance == nearest->best && index[face] < index[nearest->face]);
    if (!better) return;
    nearest->best = distance;
    nearest->face = face;
    double reach = sqrt(distance) + nearest->slack;
    search->limit = reach * reach;
}

/* Converts a point to the normalised unit. If the square of a coordinate would overflow, moves the
 * point towards the origin. At such a distance, all points of the surface are equally near up to
 * rounding, so the move does not change the result. */
static struct gd_vec3 bring_inside(const struct gd_mesh *mesh, struct gd_vec3 xyz)
{
    double largest = gd__largest_coordinate(xyz);
    if (largest / GD_EXTENT_MAX > mesh->unit)
        return gd_vec3_scale(gd_vec3_scale(xyz, 1 / largest), GD_EXTENT_MAX);
    return gd_vec3_scale(xyz, 1 / mesh->unit);
}

double gd_locate_distance(const struct gd_mesh *mesh, struct gd_vec3 xyz,
                          const struct gd_point *point)
{
    struct gd_vec3 d = gd_vec3_sub(xyz, gd_point_position(mesh, point));
    return hypot(hypot(d.x, d.y), d.z);
}

enum gd_status gd_locate_nearest(const struct gd_mesh *mesh, struct gd_vec3 xyz, double max_snap,
                                 struct gd_point *out, struct gd_detail *detail)
{
    if (!isfinite(xyz.x) || !isfinite(xyz.y) || !isfinite(xyz.z) || isnan(max_snap))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "a coordinate or max_snap is not a finite number");
    struct nearest nearest = {
        {INFINITY, bound_of_box, visit_face}, mesh, bring_inside(mesh, xyz), 0, INFINITY, GD_NONE};
    double magnitude = fmax(gd__largest_coordinate(nearest.q), gd__bvh_magnitude(mesh));
    nearest.slack = GD_TOL_LOCATE * magnitude;
    gd__bvh_run(mesh, &nearest.search);
    struct gd_point point =
        gd__face_closest_point(mesh, nearest.face, nearest.q, gd__largest_coordinate(nearest.q));
    double moved = max_snap >= 0 ? gd_locate_distance(mesh, xyz, &point) : 0;
    if (max_snap >= 0 && moved > max_snap)
        return gd_fail(
            detail, GD_NOT_ON_SURFACE,
            "the nearest point of the surface is %.17g away, farther than max_snap = %.17g", moved,
            max_snap);
    *out = point;
    return GD_OK;
}
