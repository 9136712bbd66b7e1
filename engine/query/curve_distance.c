#include "gd/curve_distance.h"

#include <math.h>

#include "field/profile.h"
#include "line/route.h"
#include "line/turn.h"
#include "mesh/canonical.h"

/* Two points count as the same if their distance is below this, relative to the size of a face. */
#define MEETING (8 * GD_TOL_PLACE)

enum { CHECK_INTERVAL = 64 /* number of segments between two checks of the control */ };

void gd_curve_distance_free(struct gd_curve_distance *distance)
{
    if (distance) gd_path_free(&distance->path);
}

/* --- locations -------------------------------------------------------------------------------- */

/* A location on a curve: the position at the distance `t` along the segment that begins at point
 * `segment`. A curve of one point has no segment. */
struct curve_location {
    uint32_t segment;
    /* `length` is the length of the segment; if it is 0, the location is the point itself */
    double t, length;
    struct gd_point point;
};

static uint32_t curve_distance_segments_of(const struct gd_curve *curve)
{
    return gd_curve_seed_count(curve) - curve->count;
}

static const struct gd_point *curve_distance_end_of(const struct gd_curve *curve, uint32_t segment)
{
    return &curve->points[(segment + 1) % curve->count];
}

static double curve_distance_length_of(const struct gd_mesh *mesh, const struct gd_curve *curve,
                                       uint32_t segment)
{
    return gd_vec3_distance(gd_point_position(mesh, &curve->points[segment]),
                            gd_point_position(mesh, curve_distance_end_of(curve, segment)));
}

/* Returns the point of a segment at the fraction s. For s = 0 and s = 1, returns exactly the
 * curve's points. */
static struct gd_point point_along(const struct gd_mesh *mesh, const struct gd_point *a,
                                   const struct gd_point *b, double s)
{
    struct gd__segment_location location;
    double from[3], to[3], weight[3];
    if (s <= 0 || !gd__segment_locate(mesh, a, b, &location)) return *a;
    if (s >= 1) return *b;
    if (location.face == GD_NONE) location.face = mesh->side_face[2 * location.edge];
    if (location.face == GD_NONE) location.face = mesh->side_face[2 * location.edge + 1];
    gd__point_weights(mesh, a, location.face, from);
    gd__point_weights(mesh, b, location.face, to);
    for (int k = 0; k < 3; k++) weight[k] = (1 - s) * from[k] + s * to[k];
    return gd__point_of_face(mesh, location.face, weight);
}

static double parameter_of(const struct gd_mesh *mesh, const struct gd_curve *curve,
                           const struct curve_location *location)
{
    double before = 0, whole = 0;
    for (uint32_t i = 0; i < curve_distance_segments_of(curve); i++) {
        double length = curve_distance_length_of(mesh, curve, i),
               part = location->length > 0 ? location->t / location->length : 0;
        if (i < location->segment) before += length;
        if (i == location->segment) before += part * length;
        whole += length;
    }
    return whole > 0 ? fmin(before / whole, 1) : 0;
}

/* --- angles ----------------------------------------------------------------------------------- */

/* Computes the angle at `at` between the directions to `next` (along the path) and to `to` (along
 * the curve). Updates *least if this angle is smaller. */
static void curve_distance_compare(const struct gd_mesh *mesh, const struct gd_point *at,
                                   const struct gd_point *next, const struct gd_point *to,
                                   double *least)
{
    if (gd_point_equal(at, to)) return;
    double angle = gd__turn_between(mesh, at, next, to);
    if (!(angle >= *least)) *least = angle;
}

/* Returns the angle between path and curve at a location. `next` is the path's next point. */
static double curve_distance_angle_at(const struct gd_mesh *mesh, const struct gd_curve *curve,
                                      const struct curve_location *location,
                                      const struct gd_point *next)
{
    double least = NAN;
    uint32_t i = location->segment, segments = curve_distance_segments_of(curve),
             last = curve->count - 1;
    if (!segments) return NAN;
    bool at_start = gd_point_equal(&location->point, &curve->points[i]),
         at_end = i < segments && !at_start &&
                  gd_point_equal(&location->point, curve_distance_end_of(curve, i));
    if (i < segments) {
        curve_distance_compare(mesh, &location->point, next, &curve->points[i], &least);
        curve_distance_compare(mesh, &location->point, next, curve_distance_end_of(curve, i),
                               &least);
    }
    if (at_start && (i > 0 || curve->closed))
        curve_distance_compare(mesh, &location->point, next, &curve->points[i > 0 ? i - 1 : last],
                               &least);
    if (at_end && (i < last || curve->closed))
        curve_distance_compare(mesh, &location->point, next,
                               curve_distance_end_of(curve, (i + 1) % curve->count), &least);
    return least;
}

/* --- the search ------------------------------------------------------------------------------- */

struct search {
    const struct gd_field *field;
    const struct gd_mesh *mesh;
    const struct gd_curve *b;
    const struct gd_control *control;
    bool greatest; /* true if the greatest distance is searched, false if the least */
    double best;   /* normalised unit; GD__FAR means no path */
    struct curve_location location;
};

/* Returns true if the distance is better by more than rounding errors. So a point close to a corner
 * of the curve does not replace the corner. */
static bool curve_distance_is_better(const struct search *search, double distance)
{
    double slack = GD_TOL_BETTER * distance;
    return search->greatest ? distance - slack > search->best : distance + slack < search->best;
}

static void curve_distance_offer(struct search *search, uint32_t segment, double t, double length,
                                 struct gd_point point, double distance)
{
    if (!curve_distance_is_better(search, distance)) return;
    search->best = distance;
    search->location = (struct curve_location){segment, t, length, point};
}

static void try_point(struct search *search, uint32_t i)
{
    struct gd__leg_key way;
    gd__field_leg_key(search->field, &search->b->points[i], &way);
    curve_distance_offer(search, i, 0, 0, search->b->points[i],
                         way.kind == GD__LEG_NONE ? GD__FAR : way.distance);
}

/* Searches segment i. Stores the best point, and the field's distance at exactly this point. */
static enum gd_status try_segment(struct search *search, uint32_t i, struct gd__profile *profile)
{
    const struct gd_point *a = &search->b->points[i], *b = curve_distance_end_of(search->b, i);
    enum gd_status status = gd__profile_of(search->field, a, b, profile);
    if (status || !profile->windows.count) return status;
    struct gd__profile_place place =
        search->greatest ? gd__profile_greatest(profile) : gd__profile_least(profile);
    if (!curve_distance_is_better(search, place.distance)) return GD_OK;
    struct gd_point point = point_along(search->mesh, a, b, place.t / profile->length);
    struct gd__leg_key way;
    gd__field_leg_key(search->field, &point, &way);
    curve_distance_offer(search, i, place.t, profile->length, point, way.distance);
    return GD_OK;
}

static enum gd_status curve_distance_run(struct search *search)
{
    struct gd__profile profile = {0};
    uint32_t segments = curve_distance_segments_of(search->b);
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

/* --- result ----------------------------------------------------------------------------------- */

/* Returns the location of the path's end on the curve to which the seed belongs. */
static struct curve_location location_of_seed(const struct gd_mesh *mesh, const struct gd_curve *a,
                                              uint32_t seed, const struct gd_point *point)
{
    struct curve_location location = {.segment = seed / 2, .point = *point};
    if (seed % 2) {
        location.length = curve_distance_length_of(mesh, a, location.segment);
        location.t = gd_vec3_distance(gd_point_position(mesh, &a->points[location.segment]),
                                      gd_point_position(mesh, point));
    }
    return location;
}

static struct gd_curve_place curve_distance_place_of(const struct gd_mesh *mesh,
                                                     const struct gd_curve *curve,
                                                     const struct curve_location *location,
                                                     const struct gd_point *next)
{
    return (struct gd_curve_place){
        .point = location->point,
        .parameter = parameter_of(mesh, curve, location),
        .angle = next ? curve_distance_angle_at(mesh, curve, location, next) : NAN};
}

/* Returns the length of an edge of a face that contains the point. */
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

static enum gd_status curve_distance_solve(struct search *search, const struct gd_curve *a,
                                           struct gd_curve_distance *out)
{
    const struct gd_mesh *mesh = search->mesh;
    struct gd_curve_distance answer = {.distance = INFINITY};
    uint32_t seed;
    enum gd_status status = curve_distance_run(search);
    if (status) return status;
    if (search->best >= GD__FAR) {
        *out = answer;
        return GD_OK;
    }
    status = gd_field_path_to_seed(search->field, &search->location.point, &answer.path, &seed);
    if (status) return status;
    const struct gd_path *path = &answer.path;
    bool meet = path->count < 2;
    struct curve_location at_a = location_of_seed(mesh, a, seed, &path->points[path->count - 1]);
    /* up to rounding, the curves meet */
    if (search->best <= MEETING * face_size(mesh, &search->location.point)) {
        search->best = 0;
        answer.path.length = 0;
        path->points[0] = path->points[path->count - 1];
        answer.path.count = 1;
        meet = true;
    }
    answer.distance = search->best * mesh->unit;
    answer.a =
        curve_distance_place_of(mesh, a, &at_a, meet ? NULL : &path->points[path->count - 2]);
    answer.b =
        curve_distance_place_of(mesh, search->b, &search->location, meet ? NULL : &path->points[1]);
    gd__points_reverse(answer.path.points, answer.path.count);
    *out = answer;
    return GD_OK;
}

static enum gd_status curve_distance_from_field(const struct gd_field *field,
                                                const struct gd_curve *a, const struct gd_curve *b,
                                                const struct gd_control *control, bool greatest,
                                                struct gd_curve_distance *out)
{
    if (field->seed_count != gd_curve_seed_count(a)) return GD_INVALID_ARGUMENT;
    if (field->reach < GD__FAR) return GD_BEYOND_REACH;
    struct search search = {
        .field = field, .mesh = field->mesh, .b = b, .control = control, .greatest = greatest};
    return curve_distance_solve(&search, a, out);
}

enum gd_status gd_curve_distance(const struct gd_field *field, const struct gd_curve *a,
                                 const struct gd_curve *b, const struct gd_control *control,
                                 struct gd_curve_distance *out)
{
    return curve_distance_from_field(field, a, b, control, false, out);
}

enum gd_status gd_curve_farthest(const struct gd_field *field, const struct gd_curve *a,
                                 const struct gd_curve *b, const struct gd_control *control,
                                 struct gd_curve_distance *out)
{
    return curve_distance_from_field(field, a, b, control, true, out);
}
