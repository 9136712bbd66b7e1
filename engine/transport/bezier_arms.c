#include "transport/bezier_arms.h"

#include <stdlib.h>

#include "base/tolerance.h"
#include "line/straighten.h"
#include "transport/lanes.h"

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

enum gd_status gd__bezier_arms_make(const struct gd__spline_work *work,
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
