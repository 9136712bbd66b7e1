#include "gd/curve_distance.h"

#include <math.h>

#include "field/profile.h"
#include "mesh/canonical.h"
#include "mesh/tangent_angle.h"

/* of the size of a face: nearer than this is at the same place */
#define MEETING (8 * GD_TOL_PLACE)

enum { CHECK_INTERVAL = 64 /* segments */ };

void gd_curve_distance_free(struct gd_curve_distance *distance)
{
    if (distance) gd_path_free(&distance->path);
}

/* --- places ----------------------------------------------------------------------------------- */

/* A place while it is known by its segment: from point `segment` on, that far along it. A curve of
 * one point has none. */
struct spot {
    uint32_t segment;
    double t, length; /* of the segment; length 0: the point itself */
    struct gd_point point;
};

static uint32_t segments_of(const struct gd_curve *curve)
{
    return gd_curve_seed_count(curve) - curve->count;
}

static const struct gd_point *end_of(const struct gd_curve *curve, uint32_t segment)
{
    return &curve->points[(segment + 1) % curve->count];
}

static double length_of(const struct gd_mesh *mesh, const struct gd_curve *curve, uint32_t segment)
{
    return gd_vec3_distance(gd_point_position(mesh, &curve->points[segment]),
                            gd_point_position(mesh, end_of(curve, segment)));
}

/* The point of a segment at part `s` of it; its ends are the curve's points, to the last bit. */
static struct gd_point point_along(const struct gd_mesh *mesh, const struct gd_point *a,
                                   const struct gd_point *b, double s)
{
    struct gd__home home;
    double from[3], to[3], weight[3];
    if (s <= 0 || !gd__segment_home(mesh, a, b, &home)) return *a;
    if (s >= 1) return *b;
    if (home.face == GD_NONE) home.face = mesh->side_face[2 * home.edge];
    if (home.face == GD_NONE) home.face = mesh->side_face[2 * home.edge + 1];
    gd__point_weights(mesh, a, home.face, from);
    gd__point_weights(mesh, b, home.face, to);
    for (int k = 0; k < 3; k++) weight[k] = (1 - s) * from[k] + s * to[k];
    return gd__point_of_face(mesh, home.face, weight);
}

static double parameter_of(const struct gd_mesh *mesh, const struct gd_curve *curve,
                           const struct spot *spot)
{
    double before = 0, whole = 0;
    for (uint32_t i = 0; i < segments_of(curve); i++) {
        double length = length_of(mesh, curve, i),
               part = spot->length > 0 ? spot->t / spot->length : 0;
        if (i < spot->segment) before += length;
        if (i == spot->segment) before += part * length;
        whole += length;
    }
    return whole > 0 ? fmin(before / whole, 1) : 0;
}

/* --- angles ----------------------------------------------------------------------------------- */

/* Keeps the least angle between the path, which goes on to `next`, and the curve, which does to
 * `to`. */
static void compare(const struct gd_mesh *mesh, const struct gd_point *at,
                    const struct gd_point *next, const struct gd_point *to, double *least)
{
    if (gd_point_equal(at, to)) return;
    double angle = gd__tangent_angle(mesh, at, next, to);
    if (!(angle >= *least)) *least = angle;
}

/* `next`: of the path, on its way from the spot. */
static double angle_at(const struct gd_mesh *mesh, const struct gd_curve *curve,
                       const struct spot *spot, const struct gd_point *next)
{
    double least = NAN;
    uint32_t i = spot->segment, segments = segments_of(curve), last = curve->count - 1;
    if (!segments) return NAN;
    bool at_start = gd_point_equal(&spot->point, &curve->points[i]),
         at_end = i < segments && !at_start && gd_point_equal(&spot->point, end_of(curve, i));
    if (i < segments) {
        compare(mesh, &spot->point, next, &curve->points[i], &least);
        compare(mesh, &spot->point, next, end_of(curve, i), &least);
    }
    if (at_start && (i > 0 || curve->closed))
        compare(mesh, &spot->point, next, &curve->points[i > 0 ? i - 1 : last], &least);
    if (at_end && (i < last || curve->closed))
        compare(mesh, &spot->point, next, end_of(curve, (i + 1) % curve->count), &least);
    return least;
}

/* --- the search ------------------------------------------------------------------------------- */

struct search {
    const struct gd_field *field;
    const struct gd_mesh *mesh;
    const struct gd_curve *b;
    const struct gd_control *control;
    bool greatest; /* what is looked for */
    double best;   /* inside unit; GD__FAR: no path */
    struct spot spot;
};

/* By more than rounding: so a corner of the curve stands rather than a place beside it. */
static bool is_better(const struct search *search, double distance)
{
    double slack = GD_TOL_BETTER * distance;
    return search->greatest ? distance - slack > search->best : distance + slack < search->best;
}

static void offer(struct search *search, uint32_t segment, double t, double length,
                  struct gd_point point, double distance)
{
    if (!is_better(search, distance)) return;
    search->best = distance;
    search->spot = (struct spot){segment, t, length, point};
}

static void try_point(struct search *search, uint32_t i)
{
    struct gd__way way;
    gd__field_way(search->field, &search->b->points[i], &way);
    offer(search, i, 0, 0, search->b->points[i], way.kind == GD__LEG_NONE ? GD__FAR : way.distance);
}

/* The distance that is given is the one that the field has at the very point. */
static enum gd_status try_segment(struct search *search, uint32_t i, struct gd__profile *profile)
{
    const struct gd_point *a = &search->b->points[i], *b = end_of(search->b, i);
    enum gd_status status = gd__profile_of(search->field, a, b, profile);
    if (status || !profile->windows.count) return status;
    struct gd__profile_place place =
        search->greatest ? gd__profile_greatest(profile) : gd__profile_least(profile);
    if (!is_better(search, place.distance)) return GD_OK;
    struct gd_point point = point_along(search->mesh, a, b, place.t / profile->length);
    struct gd__way way;
    gd__field_way(search->field, &point, &way);
    offer(search, i, place.t, profile->length, point, way.distance);
    return GD_OK;
}

static enum gd_status run(struct search *search)
{
    struct gd__profile profile = {0};
    uint32_t segments = segments_of(search->b);
    enum gd_status status = gd_control_check(search->control, 0);
    search->best = search->greatest ? -1 : GD__FAR;
    for (uint32_t i = 0; i < search->b->count; i++) try_point(search, i);
    for (uint32_t i = 0; i < segments && !status; i++) {
        if (i % CHECK_INTERVAL == 0)
            status = gd_control_check(search->control, (double)i / segments);
        if (!status) status = try_segment(search, i, &profile);
    }
    gd__profile_destroy(&profile);
    return status;
}

/* --- the answer ------------------------------------------------------------------------------- */

static void reverse(struct gd_path *path)
{
    for (uint32_t i = 0, j = path->count - 1; i < j; i++, j--) {
        struct gd_point point = path->points[i];
        path->points[i] = path->points[j];
        path->points[j] = point;
    }
}

/* Where the path's end lies on the curve whose seed it is. */
static struct spot spot_of_seed(const struct gd_mesh *mesh, const struct gd_curve *a, uint32_t seed,
                                const struct gd_point *point)
{
    struct spot spot = {.segment = seed / 2, .point = *point};
    if (seed % 2) {
        spot.length = length_of(mesh, a, spot.segment);
        spot.t = gd_vec3_distance(gd_point_position(mesh, &a->points[spot.segment]),
                                  gd_point_position(mesh, point));
    }
    return spot;
}

static struct gd_curve_place place_of(const struct gd_mesh *mesh, const struct gd_curve *curve,
                                      const struct spot *spot, const struct gd_point *next)
{
    return (struct gd_curve_place){.point = spot->point,
                                   .parameter = parameter_of(mesh, curve, spot),
                                   .angle = next ? angle_at(mesh, curve, spot, next) : NAN};
}

/* The length of an edge at a point, the first that comes. */
static double face_size(const struct gd_mesh *mesh, const struct gd_point *point)
{
    switch (point->kind) {
    case GD_POINT_VERTEX:
        return mesh->side[mesh->fan[mesh->fan_first[point->element]].side].length;
    case GD_POINT_EDGE:
        return mesh->side[2 * point->element].length;
    case GD_POINT_FACE:
        break;
    }
    return mesh->side[mesh->face_side[point->element][0]].length;
}

static enum gd_status solve(struct search *search, const struct gd_curve *a,
                            struct gd_curve_distance *out)
{
    const struct gd_mesh *mesh = search->mesh;
    struct gd_curve_distance answer = {.distance = INFINITY};
    uint32_t seed;
    enum gd_status status = run(search);
    if (status) return status;
    if (search->best >= GD__FAR) {
        *out = answer;
        return GD_OK;
    }
    status = gd_field_path_to_seed(search->field, &search->spot.point, &answer.path, &seed);
    if (status) return status;
    const struct gd_path *path = &answer.path;
    bool meet = path->count < 2;
    struct spot at_a = spot_of_seed(mesh, a, seed, &path->points[path->count - 1]);
    /* they meet, up to rounding */
    if (search->best <= MEETING * face_size(mesh, &search->spot.point)) {
        search->best = 0;
        answer.path.length = 0;
        path->points[0] = path->points[path->count - 1];
        answer.path.count = 1;
        meet = true;
    }
    answer.distance = search->best * mesh->unit;
    answer.a = place_of(mesh, a, &at_a, meet ? NULL : &path->points[path->count - 2]);
    answer.b = place_of(mesh, search->b, &search->spot, meet ? NULL : &path->points[1]);
    reverse(&answer.path);
    *out = answer;
    return GD_OK;
}

static enum gd_status ask(const struct gd_field *field, const struct gd_curve *a,
                          const struct gd_curve *b, const struct gd_control *control, bool greatest,
                          struct gd_curve_distance *out)
{
    if (field->seed_count != gd_curve_seed_count(a)) return GD_INVALID_ARGUMENT;
    if (field->reach < GD__FAR) return GD_BEYOND_REACH;
    struct search search = {
        .field = field, .mesh = field->mesh, .b = b, .control = control, .greatest = greatest};
    return solve(&search, a, out);
}

enum gd_status gd_curve_distance(const struct gd_field *field, const struct gd_curve *a,
                                 const struct gd_curve *b, const struct gd_control *control,
                                 struct gd_curve_distance *out)
{
    return ask(field, a, b, control, false, out);
}

enum gd_status gd_curve_farthest(const struct gd_field *field, const struct gd_curve *a,
                                 const struct gd_curve *b, const struct gd_control *control,
                                 struct gd_curve_distance *out)
{
    return ask(field, a, b, control, true, out);
}
