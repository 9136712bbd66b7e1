/* Computes the geodesic between two places by shooting. */
#include <math.h>
#include <stdlib.h>

#include "base/tolerance.h"
#include "gd/limit_path.h"

enum { SHOTS = 24 };

/* The start, the axes x and y of its tangent plane, and the target. The direction with an angle is
 * cos(angle) x + sin(angle) y. */
struct aim {
    const struct gd_subdivision *surface;
    const struct gd_control *control;
    struct gd_limit_point start;
    struct gd_vec3 x, y;
    struct gd_vec3 target;
    struct gd_detail *detail;
};

struct shot {
    double angle, length;
    struct gd_limit_path path;
    /* end of the path; if the path met the boundary, it is extended straight to the length
       `length` */
    struct gd_vec3 end;
    double miss;
};

static enum gd_status shoot(const struct aim *aim, double angle, double length, struct shot *out)
{
    struct gd_vec3 direction = gd_vec3_along(gd_vec3_scale(aim->x, cos(angle)), sin(angle), aim->y);
    struct shot shot = {.angle = angle, .length = length};
    enum gd_status status = gd_limit_trace(
        aim->surface, &(struct gd_limit_trace_request){aim->start, direction, length}, aim->control,
        &shot.path, aim->detail);
    if (status) return status;
    shot.end = gd_vec3_along(shot.path.steps[shot.path.step_count - 1].position,
                             length - shot.path.length, shot.path.direction);
    shot.miss = gd_vec3_distance(shot.end, aim->target);
    *out = shot;
    return GD_OK;
}

/* Computes the derivative of the path's end by the angle of the direction at the start. Returns
 * only its component across the path. */
static enum gd_status end_movement(const struct aim *aim, const struct shot *shot,
                                   struct gd_vec3 *out)
{
    struct shot beside;
    enum gd_status status = shoot(aim, shot->angle + GD_TOL_BESIDE_SHOT, shot->length, &beside);
    if (status) return status;
    *out = gd_vec3_scale(gd_vec3_sub(beside.end, shot->end), 1 / GD_TOL_BESIDE_SHOT);
    *out = gd_vec3_along(*out, -gd_vec3_dot(*out, shot->path.direction), shot->path.direction);
    gd_limit_path_free(&beside.path);
    return GD_OK;
}

/* Makes a step of Newton's method, halves it until the end of the path is nearer to the target than
 * before, and replaces *shot. Sets *better to false if no fraction of the step is better. */
static enum gd_status relax_improve(const struct aim *aim, struct shot *shot, bool *better)
{
    struct gd_vec3 sideways, miss = gd_vec3_sub(aim->target, shot->end);
    enum gd_status status = end_movement(aim, shot, &sideways);
    double square = gd_vec3_dot(sideways, sideways);
    *better = false;
    if (status || !(square > 0)) return status;
    double turn = gd_vec3_dot(miss, sideways) / square,
           longer = gd_vec3_dot(miss, shot->path.direction);
    turn = fmin(fmax(turn, -0.3), 0.3);
    for (int halvings = 0; halvings < 6 && !*better; halvings++, turn /= 2, longer /= 2) {
        struct shot next;
        status = shoot(aim, shot->angle + turn, fmax(shot->length + longer, 0), &next);
        if (status) return status;
        *better = next.miss < shot->miss;
        gd_limit_path_free(*better ? &shot->path : &next.path);
        if (*better) *shot = next;
    }
    return GD_OK;
}

static enum gd_status hit(const struct aim *aim, double length, struct gd_limit_geodesic *out)
{
    struct shot shot;
    bool better = true;
    enum gd_status status = shoot(aim, 0, length, &shot);
    if (status) return status;
    for (int i = 0; !status && better && i < SHOTS && shot.miss > GD_TOL_PLACE * length; i++)
        status = relax_improve(aim, &shot, &better);
    *out = (struct gd_limit_geodesic){.path = shot.path};
    /* the path may have met the boundary before its end */
    double off = shot.miss + fabs(shot.length - shot.path.length);
    out->error_estimate = off + GD_TOL_GEODESIC * shot.path.step_count * length;
    out->converged =
        off <= GD_TOL_SHOT * length && fabs(shot.length - length) <= GD_TOL_SAME_WAY * length;
    if (status || !out->converged) gd_limit_path_free(&out->path);
    return status;
}

/* Computes the axes of the tangent plane, with x towards the end of the polyline's first tenth, and
 * the polyline's length. */
static enum gd_status take_aim(const struct gd_limit_jet *jets, size_t count, struct aim *aim,
                               double *length)
{
    struct gd_vec3 start = jets[0].position, normal = jets[0].normal;
    *length = 0;
    for (size_t i = 1; i < count; i++)
        *length += gd_vec3_distance(jets[i].position, jets[i - 1].position);
    size_t ahead = 1;
    while (ahead + 1 < count && gd_vec3_distance(jets[ahead].position, start) < *length / 10)
        ahead++;
    struct gd_vec3 way = gd_vec3_sub(jets[ahead].position, start);
    way = gd_vec3_along(way, -gd_vec3_dot(way, normal), normal);
    double size = gd_vec3_length(way);
    if (!(size > 0))
        return gd_fail(aim->detail, GD_INVALID_ARGUMENT,
                       "the polyline does not lead away from where it starts");
    aim->x = gd_vec3_scale(way, 1 / size);
    aim->y = gd_vec3_cross(normal, aim->x);
    aim->target = jets[count - 1].position;
    return GD_OK;
}

enum gd_status gd_limit_relax(const struct gd_subdivision *surface,
                              const struct gd_limit_places *polyline,
                              const struct gd_control *control, struct gd_limit_geodesic *out,
                              struct gd_detail *detail)
{
    size_t count = polyline->count;
    if (count < 2)
        return gd_fail(detail, GD_INVALID_ARGUMENT, "a polyline has at least two points");
    struct aim aim = {
        .surface = surface, .control = control, .start = polyline->items[0], .detail = detail};
    double length = 0;
    struct gd_limit_jet *jets = malloc(count * sizeof *jets);
    if (!jets) return GD_NO_MEMORY;
    enum gd_status status = gd_limit_evaluate_many(surface, polyline, control, jets, detail);
    if (!status) status = take_aim(jets, count, &aim, &length);
    free(jets);
    struct gd_limit_geodesic found;
    if (!status) status = hit(&aim, length, &found);
    if (!status) *out = found;
    return status;
}
