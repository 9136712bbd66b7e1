#include "transport/legs.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "base/tolerance.h"
#include "line/straighten.h"

enum { LANES_MOST = 2 };

/* What makes segments, one after the other. */
struct lane {
    const struct gd__knotting *knotting;
    const struct gd_control *control;
    struct gd_detail *detail;
    struct gd__straightener straightener;
    struct gd__route route, line;
};

static struct lane open_lane(const struct gd__knotting *knotting, const struct gd_control *control,
                             struct gd_detail *detail)
{
    return (struct lane){.knotting = knotting,
                         .control = control,
                         .detail = detail,
                         .straightener = {.mesh = knotting->mesh, .control = control}};
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

/* The leg from knot i along `factor` times its tangent, which at the boundary ends early, or has no
 * length. */
static enum gd_status trace_leg(const struct lane *lane, uint32_t i, double factor,
                                struct gd_path *out, bool *is_clipped)
{
    const struct gd__knotting *knotting = lane->knotting;
    const struct gd_point *from = &knotting->request->points[i % knotting->request->count];
    const struct gd_mesh *mesh = knotting->mesh;
    struct gd_vector vector =
        gd_vector_combine(mesh, from, &knotting->knots[i].tangent, &factor, 1);
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
        return refuse_tangent(lane->detail, i % knotting->request->count);
    }
    *is_clipped |= vector.length - trace.path.length > GD_TOL_JOINT * vector.length;
    *out = trace.path;
    return GD_OK;
}

/* The geodesic between the inner control points that goes along with the hop between the outer
 * ones. */
static enum gd_status join_legs(struct lane *lane, const struct gd_path *hop,
                                struct gd_spline_segment *segment)
{
    const struct gd_path *first = &segment->legs[0], *last = &segment->legs[2];
    gd__route_clear(&lane->route);
    enum gd_status status =
        gd__route_join(&lane->route, first->points, first->count, 0, true, lane->control);
    if (!status)
        status = gd__route_join(&lane->route, hop->points, hop->count, 0, false, lane->control);
    if (!status)
        status = gd__route_join(&lane->route, last->points, last->count, 0, false, lane->control);
    if (!status) status = gd__straighten(&lane->straightener, &lane->route, &lane->line);
    if (!status) segment->legs[1] = gd__route_take(lane->knotting->mesh, &lane->line);
    return status;
}

static enum gd_status make_legs(struct lane *lane, uint32_t i, struct gd_spline_segment *out)
{
    const struct gd__knotting *knotting = lane->knotting;
    double begin = knotting->knots[i].parameter, end = knotting->knots[i + 1].parameter,
           third = (end - begin) / 3;
    bool clipped[2] = {false, false};
    out->begin = begin;
    out->end = end;
    out->distance = knotting->hops[i].path.length;
    enum gd_status status = trace_leg(lane, i, third, &out->legs[0], &clipped[0]);
    if (!status) status = trace_leg(lane, i + 1, -third, &out->legs[2], &clipped[1]);
    if (!status) status = join_legs(lane, &knotting->hops[i].path, out);
    if (status) return status;
    out->control[1] = out->legs[0].points[out->legs[0].count - 1];
    out->control[2] = out->legs[2].points[out->legs[2].count - 1];
    gd__points_reverse(out->legs[2].points, out->legs[2].count);
    out->control[0] = out->legs[0].points[0];
    out->control[3] = out->legs[2].points[out->legs[2].count - 1];
    out->is_clipped = clipped[0] || clipped[1];
    out->is_cut = knotting->hops[i].is_cut;
    return GD_OK;
}

/* A segment that could not be made stays all zero. */
static enum gd_status make_segment(struct lane *lane, uint32_t i, struct gd_spline_segment *out)
{
    struct gd_spline_segment segment = {0};
    enum gd_status status = make_legs(lane, i, &segment);
    for (int k = 0; k < 3 && status; k++) gd_path_free(&segment.legs[k]);
    if (!status) *out = segment;
    return status;
}

static bool is_made(const struct gd_spline_segment *segment)
{
    return segment->legs[1].count > 0;
}

/* --- two at a time ---------------------------------------------------------------------------- */

/* A thread is known by where its own copy of it lies. */
static _Thread_local char here;

struct making {
    const struct gd__knotting *knotting;
    struct gd_spline_segment *segments;
    struct gd_control control; /* of a lane */
    const char *home;          /* the caller's thread: progress is reported there only */
    bool is_cancelled;         /* what it said there */
    atomic_uint next;
    atomic_bool has_failed;
};

static bool report(void *user, double fraction)
{
    struct making *making = user;
    if (atomic_load(&making->has_failed)) return false;
    const struct gd_control *control = making->knotting->control;
    if (&here != making->home || !control->progress) return true;
    making->is_cancelled = !control->progress(control->user, fraction);
    return !making->is_cancelled;
}

static void make_in_lane(void *context, uint32_t index)
{
    (void)index;
    struct making *making = context;
    struct lane lane = open_lane(making->knotting, &making->control, NULL);
    for (uint32_t i; !atomic_load(&making->has_failed) &&
                     (i = atomic_fetch_add(&making->next, 1)) < making->knotting->hop_count;)
        if (make_segment(&lane, i, &making->segments[i])) atomic_store(&making->has_failed, true);
    close_lane(&lane);
}

/* Whatever fails here but for the caller's wish is left to be made by itself, which tells why. */
static enum gd_status make_together(const struct gd__knotting *knotting,
                                    struct gd_spline_segment *segments)
{
    struct making making = {
        .knotting = knotting, .segments = segments, .control = *knotting->control, .home = &here};
    if (making.control.budget_bytes > LANES_MOST) making.control.budget_bytes /= LANES_MOST;
    making.control.progress = report;
    making.control.user = &making;
    atomic_init(&making.next, 0);
    atomic_init(&making.has_failed, false);
    gd_executor_run(knotting->request->executor, make_in_lane, &making, LANES_MOST);
    return making.is_cancelled ? GD_CANCELLED : GD_OK;
}

enum gd_status gd__legs_make(const struct gd__knotting *knotting,
                             struct gd_spline_segment *segments)
{
    const struct gd_executor *executor = knotting->request->executor;
    enum gd_status status = executor && executor->width > 1 && knotting->hop_count > 1
                                ? make_together(knotting, segments)
                                : GD_OK;
    struct lane lane = open_lane(knotting, knotting->control, knotting->detail);
    for (uint32_t i = 0; i < knotting->hop_count && !status; i++)
        if (!is_made(&segments[i])) status = make_segment(&lane, i, &segments[i]);
    close_lane(&lane);
    return status;
}
