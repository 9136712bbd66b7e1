#include "transport/bezier_arms.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "base/tolerance.h"
#include "line/straighten.h"

enum { LANES_MOST = 2 };

/* The state of one lane. A lane is a thread that computes segments one after another. */
struct lane {
    const struct gd__spline_work *work;
    const struct gd_control *control;
    struct gd_detail *detail;
    struct gd__straightener straightener;
    struct gd__route route, line;
};

static struct lane open_lane(const struct gd__spline_work *work, const struct gd_control *control,
                             struct gd_detail *detail)
{
    return (struct lane){.work = work,
                         .control = control,
                         .detail = detail,
                         .straightener = {.mesh = work->mesh, .control = control}};
}

static void close_lane(struct lane *lane)
{
    gd__route_free(&lane->route);
    gd__route_free(&lane->line);
    gd__straightener_free(&lane->straightener);
}

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

static bool is_made(const struct gd_spline_segment *segment)
{
    return segment->arms[1].count > 0;
}

/* --- two segments at a time ------------------------------------------------------------------- */

/* The address of a thread's own copy of this variable identifies the thread. */
static _Thread_local char here;

struct making {
    const struct gd__spline_work *work;
    struct gd_spline_segment *segments;
    struct gd_control control; /* control of each lane */
    /* identifies the caller's thread, the only thread that reports progress */
    const char *location;
    /* true if a progress report on the caller's thread cancelled the call */
    bool is_cancelled;
    atomic_uint next;
    atomic_bool has_failed;
};

static bool bezier_arms_report(void *user, double fraction)
{
    struct making *making = user;
    if (atomic_load(&making->has_failed)) return false;
    const struct gd_control *control = making->work->control;
    if (&here != making->location || !control->progress) return true;
    making->is_cancelled = !control->progress(control->user, fraction);
    return !making->is_cancelled;
}

static void make_in_lane(void *context, uint32_t index)
{
    (void)index;
    struct making *making = context;
    struct lane lane = open_lane(making->work, &making->control, NULL);
    for (uint32_t i; !atomic_load(&making->has_failed) &&
                     (i = atomic_fetch_add(&making->next, 1)) < making->work->path_count;)
        if (make_segment(&lane, i, &making->segments[i])) atomic_store(&making->has_failed, true);
    close_lane(&lane);
}

/* Computes all segments in two lanes. After a failure other than a cancel, returns GD_OK. The
 * caller then computes the missing segments in a single lane, which reports the failure if it
 * occurs again. */
static enum gd_status make_together(const struct gd__spline_work *work,
                                    struct gd_spline_segment *segments)
{
    struct making making = {
        .work = work, .segments = segments, .control = *work->control, .location = &here};
    if (making.control.budget_bytes > LANES_MOST) making.control.budget_bytes /= LANES_MOST;
    making.control.progress = bezier_arms_report;
    making.control.user = &making;
    atomic_init(&making.next, 0);
    atomic_init(&making.has_failed, false);
    gd_executor_run(work->request->executor, make_in_lane, &making, LANES_MOST);
    return making.is_cancelled ? GD_CANCELLED : GD_OK;
}

enum gd_status gd__bezier_arms_make(const struct gd__spline_work *work,
                                    struct gd_spline_segment *segments)
{
    const struct gd_executor *executor = work->request->executor;
    enum gd_status status = executor && executor->width > 1 && work->path_count > 1
                                ? make_together(work, segments)
                                : GD_OK;
    struct lane lane = open_lane(work, work->control, work->detail);
    for (uint32_t i = 0; i < work->path_count && !status; i++)
        if (!is_made(&segments[i])) status = make_segment(&lane, i, &segments[i]);
    close_lane(&lane);
    return status;
}
