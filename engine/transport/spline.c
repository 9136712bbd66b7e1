#include "gd/spline.h"

#include <stdlib.h>

#include "base/tolerance.h"
#include "transport/knots.h"
#include "transport/straighten.h"
#include "transport/turn.h"

void gd_spline_free(struct gd_spline *spline)
{
    if (!spline) return;
    for (uint32_t i = 0; i < spline->count && spline->segments; i++)
        for (int k = 0; k < 3; k++) gd_path_free(&spline->segments[i].legs[k]);
    free(spline->segments);
    free(spline->knots);
    *spline = (struct gd_spline){0};
}

/* --- legs ---------------------------------------------------------------------------------------------------------------- */

struct spline_work {
    struct gd__knotting knotting;
    struct gd__straightener straightener;
    struct gd__route route, line;
};

static enum gd_status refuse_tangent(const struct gd__knotting *knotting, uint32_t i)
{
    gd_fail(knotting->detail, GD_INVALID_ARGUMENT,
            "the tangent at point %u is so long that its geodesic crosses more than %d edges; give a shorter one", i,
            GD_TRACE_STEPS);
    gd_detail_add(knotting->detail, GD_ELEMENT_NONE, i, 0);
    return GD_INVALID_ARGUMENT;
}

/* The leg from knot i along `factor` times its tangent, which at the boundary ends early, or has no length. */
static enum gd_status trace_leg(const struct gd__knotting *knotting, uint32_t i, double factor, struct gd_path *out,
                                bool *is_clipped)
{
    const struct gd_point *from = &knotting->request->points[i % knotting->request->count];
    const struct gd_mesh *mesh = knotting->mesh;
    struct gd_vector vector = gd_vector_combine(mesh, from, &knotting->knots[i].tangent, &factor, 1);
    struct gd_trace trace;
    enum gd_status status =
        gd_trace_follow(mesh, from, &vector.direction, vector.length, NULL, knotting->control, &trace, NULL);
    *is_clipped = status == GD_NOT_ON_SURFACE && vector.length > 0;
    if (status == GD_NOT_ON_SURFACE) {
        vector.direction = gd_trace_fan(mesh, from, 1, 0);
        status = gd_trace_follow(mesh, from, &vector.direction, 0, NULL, knotting->control, &trace, NULL);
    }
    if (status) return status;
    if (trace.end == GD_TRACE_END_STEP_LIMIT) {
        gd_trace_free(&trace);
        return refuse_tangent(knotting, i % knotting->request->count);
    }
    *is_clipped |= vector.length - trace.path.length > GD_TOL_JOINT * vector.length;
    *out = trace.path;
    return GD_OK;
}

/* The geodesic between the inner control points that goes along with the hop between the outer ones. */
static enum gd_status join_legs(struct spline_work *work, const struct gd_path *hop, struct gd_spline_segment *segment)
{
    const struct gd_control *control = work->knotting.control;
    const struct gd_path *first = &segment->legs[0], *last = &segment->legs[2];
    gd__route_clear(&work->route);
    enum gd_status status = gd__route_join(&work->route, first->points, first->count, 0, true, control);
    if (!status) status = gd__route_join(&work->route, hop->points, hop->count, 0, false, control);
    if (!status) status = gd__route_join(&work->route, last->points, last->count, 0, false, control);
    if (!status) status = gd__straighten(&work->straightener, &work->route, &work->line);
    if (!status) segment->legs[1] = gd__route_take(work->knotting.mesh, &work->line);
    return status;
}

static enum gd_status make_segment(struct spline_work *work, uint32_t i, struct gd_spline_segment *out)
{
    const struct gd__knotting *knotting = &work->knotting;
    double begin = knotting->knots[i].parameter, end = knotting->knots[i + 1].parameter, third = (end - begin) / 3;
    bool clipped[2] = {false, false};
    out->begin = begin;
    out->end = end;
    out->distance = knotting->hops[i].path.length;
    enum gd_status status = trace_leg(knotting, i, third, &out->legs[0], &clipped[0]);
    if (!status) status = trace_leg(knotting, i + 1, -third, &out->legs[2], &clipped[1]);
    if (!status) status = join_legs(work, &knotting->hops[i].path, out);
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

/* --- joints -------------------------------------------------------------------------------------------------------------- */

/* By how much a line that comes and one that goes miss half a turn, of angles as directions have them. */
static enum gd_status angle_between(const struct gd_mesh *mesh, const struct gd_path *in, const struct gd_path *out,
                                    double *angle)
{
    double back, ahead;
    enum gd_status status = gd__route_back(mesh, in->points, in->count, &back);
    if (!status) status = gd__route_ahead(mesh, out->points, out->count, &ahead);
    if (status) return status;
    struct gd__bend bend = gd__bend_of_turns(mesh, &out->points[0], back, ahead);
    *angle = fabs(fmin(bend.left, bend.right) / gd__turn_scale(mesh, &out->points[0]) - M_PI);
    return GD_OK;
}

static enum gd_status measure_joint(const struct gd_mesh *mesh, const struct gd_spline_segment *in,
                                    const struct gd_spline_segment *out, struct gd_spline_knot *knot)
{
    double from = in->legs[2].length / (in->end - in->begin), to = out->legs[0].length / (out->end - out->begin);
    knot->speed_jump = fmax(from, to) > 0 ? fabs(to - from) / fmax(from, to) : 0;
    if (in->legs[2].count < 2 || out->legs[0].count < 2) return GD_OK;
    return angle_between(mesh, &in->legs[2], &out->legs[0], &knot->angle_jump);
}

static enum gd_status measure_joints(const struct gd_mesh *mesh, struct gd_spline *spline)
{
    enum gd_status status = GD_OK;
    for (uint32_t i = 1; i < spline->count && !status; i++)
        status = measure_joint(mesh, &spline->segments[i - 1], &spline->segments[i], &spline->knots[i]);
    if (!spline->closed || status) return status;
    status = measure_joint(mesh, &spline->segments[spline->count - 1], &spline->segments[0], &spline->knots[0]);
    spline->knots[spline->count].angle_jump = spline->knots[0].angle_jump;
    spline->knots[spline->count].speed_jump = spline->knots[0].speed_jump;
    return status;
}

/* --- the whole ----------------------------------------------------------------------------------------------------------- */

static enum gd_status check(const struct gd_spline_request *request, struct gd_detail *detail)
{
    if (request->count < 2)
        return gd_fail(detail, GD_INVALID_ARGUMENT, "a spline goes through at least two points; %u %s given",
                       request->count, request->count == 1 ? "is" : "are");
    if (!(request->alpha >= 0 && request->alpha <= 1))
        return gd_fail(detail, GD_INVALID_ARGUMENT, "alpha is %.17g; it runs from 0 (uniform) to 1 (chordal)",
                       request->alpha);
    if (!(request->tension >= 0 && request->tension <= 1))
        return gd_fail(detail, GD_INVALID_ARGUMENT, "the tension is %.17g; it runs from 0 to 1", request->tension);
    for (uint32_t i = 0; i < request->count && request->tangents; i++) {
        const struct gd_vector *tangent = &request->tangents[i];
        if (request->is_given && !request->is_given[i]) continue;
        if (isfinite(tangent->direction.angle) && isfinite(tangent->length) && tangent->length >= 0) continue;
        gd_fail(detail, GD_INVALID_ARGUMENT, "the tangent at point %u is not a finite vector", i);
        gd_detail_add(detail, GD_ELEMENT_NONE, i, 0);
        return GD_INVALID_ARGUMENT;
    }
    return GD_OK;
}

static enum gd_status make(struct spline_work *work, struct gd_spline *spline)
{
    enum gd_status status = gd__knots_search(&work->knotting);
    if (!status) status = gd__knots_fill(&work->knotting);
    for (uint32_t i = 0; i < spline->count && !status; i++) status = make_segment(work, i, &spline->segments[i]);
    return status ? status : measure_joints(work->knotting.mesh, spline);
}

static enum gd_status allocate(struct spline_work *work, struct gd_spline *spline)
{
    size_t count = spline->count, hops = work->knotting.total_count,
           bytes = hops * sizeof *work->knotting.hops + count * (sizeof *spline->segments + sizeof *spline->knots);
    enum gd_status status = gd_control_afford(work->knotting.control, bytes);
    if (status) return status;
    spline->segments = calloc(count, sizeof *spline->segments);
    spline->knots = calloc(count + 1, sizeof *spline->knots);
    work->knotting.hops = calloc(hops, sizeof *work->knotting.hops);
    work->knotting.knots = spline->knots;
    return spline->segments && spline->knots && work->knotting.hops ? GD_OK : GD_NO_MEMORY;
}

static void release(struct spline_work *work)
{
    gd__hops_free(work->knotting.hops, work->knotting.total_count);
    gd__route_free(&work->route);
    gd__route_free(&work->line);
    gd__straightener_free(&work->straightener);
}

enum gd_status gd_spline_build(const struct gd_mesh *mesh, const struct gd_spline_request *request,
                               const struct gd_control *control, struct gd_spline *out, struct gd_detail *detail)
{
    enum gd_status status = check(request, detail);
    if (status) return status;
    struct gd_spline spline = {.closed = request->closed, .count = request->count - !request->closed};
    uint32_t hops = request->tangent_rule == GD_TANGENT_PAPER ? 2 * spline.count : spline.count;
    struct gd__share share = {.control = control, .total = hops + spline.count + 1};
    const struct gd_control own = gd__share_control(&share, 0);
    struct spline_work work = {.knotting = {mesh, request, &share, &own, detail, spline.count, hops, NULL, NULL},
                               .straightener = {.mesh = mesh, .control = &own}};
    status = allocate(&work, &spline);
    if (!status) status = make(&work, &spline);
    release(&work);
    if (status) {
        gd_spline_free(&spline);
        return status;
    }
    *out = spline;
    return GD_OK;
}
