#include "gd/spline.h"

#include <stdlib.h>

#include "line/straighten.h"
#include "line/turn.h"
#include "transport/control_points.h"
#include "base/lanes.h"

void gd_spline_free(struct gd_spline *spline)
{
    if (!spline) return;
    for (uint32_t i = 0; i < spline->count && spline->segments; i++)
        for (int k = 0; k < 3; k++) gd_path_free(&spline->segments[i].arms[k]);
    free(spline->segments);
    free(spline->knots);
    *spline = (struct gd_spline){0};
}

/* --- arms ------------------------------------------------------------------------------------- */

/* Bezier arms: the control polygon of each segment of a spline. Two arms are geodesics along the
 * tangents at the ends; the third arm joins their inner ends. */

/* The state of one lane. A lane is a thread that computes segments one after another. */
struct lane {
    const struct gd__spline_work *work;
    const struct gd_control *control;
    struct gd_detail *detail;
    struct gd__straightener straightener;
    struct gd__route route, line;
};

/* --- one segment ------------------------------------------------------------------------------ */

static enum gd_status refuse_tangent(struct gd_detail *detail, uint32_t i)
{
    gd_fail(detail, GD_INVALID_ARGUMENT,
            "the tangent at point %u is so long that its geodesic crosses more than %d edges; give "
            "a shorter one",
            i, GD_TRACE_STEPS);
    gd_detail_add(detail, GD_ELEMENT_NONE, i, 0);
    return GD_INVALID_ARGUMENT;
}

/* Traces the arm from knot i along `factor` times its tangent. At the boundary the arm may be
 * shortened or empty. */
static enum gd_status arm_trace(const struct lane *lane, uint32_t i, double factor,
                                struct gd_path *out, bool *is_clipped)
{
    const struct gd__spline_work *work = lane->work;
    const struct gd_point *from = &work->request->points[i % work->request->count];
    const struct gd_mesh *mesh = work->mesh;
    struct gd_vector vector = gd_vector_combine(mesh, from, &work->knots[i].tangent, &factor, 1);
    struct gd_trace trace;
    enum gd_status status =
        gd_trace_follow(mesh,
                        &(struct gd_trace_request){
                            .start = from, .ahead = &vector.direction, .length = vector.length},
                        lane->control, &trace, NULL);
    *is_clipped = status == GD_NOT_ON_SURFACE && vector.length > 0;
    if (status == GD_NOT_ON_SURFACE) {
        vector.direction = gd_trace_fan(mesh, from, 1, 0);
        status = gd_trace_follow(
            mesh,
            &(struct gd_trace_request){.start = from, .ahead = &vector.direction, .length = 0},
            lane->control, &trace, NULL);
    }
    if (status) return status;
    if (trace.end == GD_TRACE_END_STEP_LIMIT) {
        gd_trace_free(&trace);
        return refuse_tangent(lane->detail, i % work->request->count);
    }
    *is_clipped |= vector.length - trace.path.length > GD_TOL_JOINT * vector.length;
    *out = trace.path;
    return GD_OK;
}

/* Computes the arm between the inner control points: a geodesic. Straightens the following line:
 * from the inner end of the first outer arm back to its knot, along `path` to the next knot, and
 * along the last outer arm to its inner end. */
static enum gd_status arms_join(struct lane *lane, const struct gd_path *path,
                                struct gd_spline_segment *segment)
{
    const struct gd_path *first = &segment->arms[0], *last = &segment->arms[2];
    gd__route_clear(&lane->route);
    enum gd_status status =
        gd__route_join(&lane->route, first->points, first->count, 0, true, lane->control);
    if (!status)
        status = gd__route_join(&lane->route, path->points, path->count, 0, false, lane->control);
    if (!status)
        status = gd__route_join(&lane->route, last->points, last->count, 0, false, lane->control);
    if (!status) status = gd__straighten(&lane->straightener, &lane->route, &lane->line);
    if (!status) segment->arms[1] = gd__route_take(lane->work->mesh, &lane->line);
    return status;
}

static enum gd_status arms_make(struct lane *lane, uint32_t i, struct gd_spline_segment *out)
{
    const struct gd__spline_work *work = lane->work;
    double begin = work->knots[i].parameter, end = work->knots[i + 1].parameter,
           third = (end - begin) / 3;
    bool clipped[2] = {false, false};
    out->begin = begin;
    out->end = end;
    out->distance = work->paths[i].path.length;
    enum gd_status status = arm_trace(lane, i, third, &out->arms[0], &clipped[0]);
    if (!status) status = arm_trace(lane, i + 1, -third, &out->arms[2], &clipped[1]);
    if (!status) status = arms_join(lane, &work->paths[i].path, out);
    if (status) return status;
    out->control[1] = out->arms[0].points[out->arms[0].count - 1];
    out->control[2] = out->arms[2].points[out->arms[2].count - 1];
    gd__points_reverse(out->arms[2].points, out->arms[2].count);
    out->control[0] = out->arms[0].points[0];
    out->control[3] = out->arms[2].points[out->arms[2].count - 1];
    out->is_clipped = clipped[0] || clipped[1];
    out->is_cut = work->paths[i].is_cut;
    return GD_OK;
}

/* Computes segment i. If this fails, `*out` stays all zero. */
static enum gd_status make_segment(struct lane *lane, uint32_t i, struct gd_spline_segment *out)
{
    struct gd_spline_segment segment = {0};
    enum gd_status status = arms_make(lane, i, &segment);
    for (int k = 0; k < 3 && status; k++) gd_path_free(&segment.arms[k]);
    if (!status) *out = segment;
    return status;
}

/* --- all segments ----------------------------------------------------------------------------- */

struct making {
    struct lane lanes[GD__LANES];
    struct gd_spline_segment *segments;
};

static enum gd_status arms_make_next(void *context, uint32_t number, uint32_t i,
                                     const struct gd_control *control)
{
    struct making *making = context;
    struct lane *lane = &making->lanes[number];
    bool is_made = making->segments[i].arms[1].count > 0;
    lane->control = lane->straightener.control = control;
    return is_made ? GD_OK : make_segment(lane, i, &making->segments[i]);
}

/* Computes `segments`, one for each path. Before the call, the segments must be all zero, and the
 * knots and paths must be computed. If the executor of the request has a width of 2 or more, two
 * segments are computed at a time, each with half of the budget. If one of them fails, the missing
 * segments are computed one at a time. The result does not depend on the executor. On failure the
 * segments computed so far stay in the array. Errors: GD_INVALID_ARGUMENT (a tangent that crosses
 * too many edges), those of gd_trace_follow and of gd__straighten. */
static enum gd_status all_arms_make(const struct gd__spline_work *work,
                                    struct gd_spline_segment *segments)
{
    struct making making = {.segments = segments};
    for (uint32_t k = 0; k < GD__LANES; k++)
        making.lanes[k] = (struct lane){.work = work, .straightener = {.mesh = work->mesh}};
    /* of two lanes, neither may write the detail */
    making.lanes[GD__LANE_ALONE].detail = work->detail;
    const struct gd__lanes lanes = {work->request->executor, work->control,  work->share,
                                    work->path_count,        arms_make_next, &making};
    enum gd_status status = gd__lanes_run(&lanes);
    for (uint32_t k = 0; k < GD__LANES; k++) {
        gd__route_free(&making.lanes[k].route);
        gd__route_free(&making.lanes[k].line);
        gd__straightener_free(&making.lanes[k].straightener);
    }
    return status;
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
    if (!status) status = all_arms_make(work, spline->segments);
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
