#include "gd/spline.h"

#include <stdlib.h>

#include "base/tolerance.h"
#include "transport/bezier_arms.h"
#include "line/straighten.h"
#include "line/turn.h"

void gd_spline_free(struct gd_spline *spline)
{
    if (!spline) return;
    for (uint32_t i = 0; i < spline->count && spline->segments; i++)
        for (int k = 0; k < 3; k++) gd_path_free(&spline->segments[i].arms[k]);
    free(spline->segments);
    free(spline->knots);
    *spline = (struct gd_spline){0};
}

/* --- joints ----------------------------------------------------------------------------------- */

/* Computes the angle between the straight continuation of an arriving path and a leaving path.
 * Angles are measured as in gd_direction. */
static enum gd_status angle_between(const struct gd_mesh *mesh, const struct gd_path *in,
                                    const struct gd_path *out, double *angle)
{
    double back, ahead;
    enum gd_status status = gd__route_back(mesh, in->points, in->count, &back);
    if (!status) status = gd__route_ahead(mesh, out->points, out->count, &ahead);
    if (status) return status;
    struct gd__bend bend = gd__bend_of_turns(mesh, &out->points[0], back, ahead);
    *angle = fabs(fmin(bend.left, bend.right) / gd__turn_scale(mesh, &out->points[0]) - M_PI);
    return GD_OK;
}

/* Returns the arm to which the curve is tangent at its beginning (side 0) or end (side 1). It is
 * the first arm, counted from this end, that is not a single point. If the arm at this end is a
 * single point, the speed at this end is 0. When the curve is halved, the control points near this
 * end stay on the next arm, so the next arm has the direction of the tangent. Returns NULL if all
 * arms are single points. */
static const struct gd_path *tangent_arm(const struct gd_spline_segment *segment, int side)
{
    for (int k = 0; k < 3; k++) {
        const struct gd_path *arm = &segment->arms[side ? 2 - k : k];
        if (arm->count >= 2) return arm;
    }
    return NULL;
}

static enum gd_status measure_joint(const struct gd_mesh *mesh, const struct gd_spline_segment *in,
                                    const struct gd_spline_segment *out,
                                    struct gd_spline_knot *knot)
{
    double from = in->arms[2].length / (in->end - in->begin),
           to = out->arms[0].length / (out->end - out->begin);
    knot->speed_jump = fmax(from, to) > 0 ? fabs(to - from) / fmax(from, to) : 0;
    const struct gd_path *arriving = tangent_arm(in, 1), *leaving = tangent_arm(out, 0);
    if (!arriving || !leaving) return GD_OK;
    return angle_between(mesh, arriving, leaving, &knot->angle_jump);
}

static enum gd_status measure_joints(const struct gd_mesh *mesh, struct gd_spline *spline)
{
    enum gd_status status = GD_OK;
    for (uint32_t i = 1; i < spline->count && !status; i++)
        status =
            measure_joint(mesh, &spline->segments[i - 1], &spline->segments[i], &spline->knots[i]);
    if (!spline->closed || status) return status;
    status = measure_joint(mesh, &spline->segments[spline->count - 1], &spline->segments[0],
                           &spline->knots[0]);
    spline->knots[spline->count].angle_jump = spline->knots[0].angle_jump;
    spline->knots[spline->count].speed_jump = spline->knots[0].speed_jump;
    return status;
}

/* --- public call ------------------------------------------------------------------------------ */

static enum gd_status spline_check(const struct gd_spline_request *request,
                                   struct gd_detail *detail)
{
    if (request->count < 2)
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "a spline goes through at least two points; %u %s given", request->count,
                       request->count == 1 ? "is" : "are");
    if (!(request->alpha >= 0 && request->alpha <= 1))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "alpha is %.17g; it runs from 0 (uniform) to 1 (chordal)", request->alpha);
    if (!(request->tension >= 0 && request->tension <= 1))
        return gd_fail(detail, GD_INVALID_ARGUMENT, "the tension is %.17g; it runs from 0 to 1",
                       request->tension);
    for (uint32_t i = 0; i < request->count && request->tangents; i++) {
        const struct gd_vector *tangent = &request->tangents[i];
        if (request->is_given && !request->is_given[i]) continue;
        if (isfinite(tangent->direction.angle) && isfinite(tangent->length) && tangent->length >= 0)
            continue;
        gd_fail(detail, GD_INVALID_ARGUMENT, "the tangent at point %u is not a finite vector", i);
        gd_detail_add(detail, GD_ELEMENT_NONE, i, 0);
        return GD_INVALID_ARGUMENT;
    }
    return GD_OK;
}

static enum gd_status spline_make(struct gd__spline_work *work, struct gd_spline *spline)
{
    enum gd_status status = gd__control_points_search(work);
    if (!status) status = gd__control_points_fill(work);
    if (!status) status = gd__bezier_arms_make(work, spline->segments);
    return status ? status : measure_joints(work->mesh, spline);
}

static enum gd_status spline_allocate(struct gd__spline_work *work, struct gd_spline *spline)
{
    size_t count = spline->count, paths = work->total_count,
           bytes = paths * sizeof *work->paths +
                   count * (sizeof *spline->segments + sizeof *spline->knots);
    enum gd_status status = gd_control_afford(work->control, bytes);
    if (status) return status;
    spline->segments = calloc(count, sizeof *spline->segments);
    spline->knots = calloc(count + 1, sizeof *spline->knots);
    work->paths = calloc(paths, sizeof *work->paths);
    work->knots = spline->knots;
    return spline->segments && spline->knots && work->paths ? GD_OK : GD_NO_MEMORY;
}

enum gd_status gd_spline_build(const struct gd_mesh *mesh, const struct gd_spline_request *request,
                               const struct gd_control *control, struct gd_spline *out,
                               struct gd_detail *detail)
{
    enum gd_status status = spline_check(request, detail);
    if (status) return status;
    struct gd_spline spline = {.closed = request->closed,
                               .count = request->count - !request->closed};
    uint32_t paths = request->tangent_rule == GD_TANGENT_PAPER ? 2 * spline.count : spline.count;
    struct gd__share share = {.control = control, .total = paths + spline.count + 1};
    const struct gd_control own = gd__share_control(&share, 0);
    struct gd__spline_work work = {mesh,         request, &share, &own, detail,
                                   spline.count, paths,   NULL,   NULL};
    status = spline_allocate(&work, &spline);
    if (!status) status = spline_make(&work, &spline);
    gd__point_paths_free(work.paths, paths);
    if (status) {
        gd_spline_free(&spline);
        return status;
    }
    *out = spline;
    return GD_OK;
}
