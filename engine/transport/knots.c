#include "transport/knots.h"

#include <stdlib.h>

#include "base/tolerance.h"
#include "line/route.h"

/* --- paths ------------------------------------------------------------------------------------ */

static enum gd_status refuse(const struct gd__knotting *knotting, uint32_t which,
                             const char *sentence, uint32_t other)
{
    gd_fail(knotting->detail, GD_INVALID_ARGUMENT, sentence, other, which);
    if (knotting->detail) gd_detail_add(knotting->detail, GD_ELEMENT_NONE, which, 0);
    return GD_INVALID_ARGUMENT;
}

/* Between points that are one there is no direction. */
static enum gd_status check_apart(const struct gd__knotting *knotting)
{
    double longest = 0;
    for (uint32_t i = 0; i < knotting->hop_count; i++)
        longest = fmax(longest, knotting->hops[i].path.length);
    for (uint32_t i = 0; i < knotting->hop_count; i++) {
        if (knotting->hops[i].path.length > GD_TOL_SAME_POINT * longest) continue;
        if (i + 1 == knotting->request->count)
            return refuse(
                knotting, i,
                "point %u is there again as point %u; a closed spline joins its ends by itself", 0);
        return refuse(knotting, i + 1,
                      "points %u and %u of the spline are the same place; leave one out", i);
    }
    return GD_OK;
}

static bool is_given(const struct gd_spline_request *request, uint32_t i)
{
    return request->tangents && (!request->is_given || request->is_given[i]);
}

/* The point before point i, and the hop from there. */
static uint32_t before(const struct gd__knotting *knotting, uint32_t i)
{
    return i ? i - 1 : knotting->hop_count - 1;
}

enum gd_status gd__knots_search(struct gd__knotting *knotting)
{
    const struct gd_spline_request *request = knotting->request;
    uint32_t hops = knotting->hop_count, count = request->count;
    for (uint32_t i = 0; i < hops; i++)
        knotting->hops[i] = (struct gd__hop){.from = i, .to = (i + 1) % count};
    for (uint32_t i = request->closed ? 0 : 1; i < hops && knotting->total_count > hops; i++)
        if (!is_given(request, i))
            knotting->hops[hops + i] =
                (struct gd__hop){.from = before(knotting, i), .to = (i + 1) % count};
    enum gd_status status =
        gd__hops_search(knotting->mesh, request, knotting->share, knotting->hops,
                        knotting->total_count, knotting->detail);
    return status ? status : check_apart(knotting);
}

/* --- vectors ---------------------------------------------------------------------------------- */

/* The vector of a path, from its beginning or from its end. */
static enum gd_status log_of(const struct gd__knotting *knotting, const struct gd_path *path,
                             bool backwards, struct gd_vector *out)
{
    struct gd_path turned = *path;
    struct gd__route copy = {0};
    struct gd_log log;
    enum gd_status status = GD_OK;
    if (backwards) {
        status = gd__route_join(&copy, path->points, path->count, 0, true, knotting->control);
        turned.points = copy.points;
    }
    if (!status) status = gd_vector_log(knotting->mesh, &turned, &log, knotting->detail);
    gd__route_free(&copy);
    if (status) return status;
    *out = log.vector;
    gd_log_free(&log);
    return GD_OK;
}

/* What is at the other end of a path, moved to its beginning or, else, to its end. */
static enum gd_status moved(const struct gd__knotting *knotting, const struct gd_path *path,
                            bool to_beginning, const struct gd_vector *vector,
                            struct gd_vector *out)
{
    struct gd_path turned = *path;
    struct gd__route copy = {0};
    enum gd_status status = GD_OK;
    if (to_beginning) {
        status = gd__route_join(&copy, path->points, path->count, 0, true, knotting->control);
        turned.points = copy.points;
    }
    struct gd_vector own = *vector;
    if (!status) status = gd_vector_transport(knotting->mesh, &turned, &own, 1, knotting->detail);
    if (!status) *out = own;
    gd__route_free(&copy);
    return status;
}

/* --- inner points ----------------------------------------------------------------------------- */

/* (1-c), by the parameters' difference across point i. */
static double slope_at(const struct gd__knotting *knotting, uint32_t i)
{
    const struct gd_spline_knot *knots = knotting->knots;
    uint32_t last = before(knotting, i);
    return (1 - knotting->request->tension) / (knots[i + 1].parameter - knots[i].parameter +
                                               knots[last + 1].parameter - knots[last].parameter);
}

static enum gd_status symmetric_tangent(const struct gd__knotting *knotting, uint32_t i,
                                        struct gd_vector *out)
{
    double slope = slope_at(knotting, i);
    struct gd_vector vectors[2];
    enum gd_status status = log_of(knotting, &knotting->hops[i].path, false, &vectors[0]);
    if (!status)
        status = log_of(knotting, &knotting->hops[before(knotting, i)].path, true, &vectors[1]);
    if (!status)
        *out = gd_vector_combine(knotting->mesh, &knotting->request->points[i], vectors,
                                 (double[2]){slope, -slope}, 2);
    return status;
}

static enum gd_status paper_tangent(const struct gd__knotting *knotting, uint32_t i,
                                    struct gd_vector *out)
{
    const struct gd_path *chord = &knotting->hops[knotting->hop_count + i].path;
    struct gd_vector vector = {0};
    if (!chord->count) { /* there and back: both neighbours are one point */
        *out = gd_vector_combine(knotting->mesh, &knotting->request->points[i], NULL, NULL, 0);
        return GD_OK;
    }
    enum gd_status status = log_of(knotting, chord, false, &vector);
    vector.length *= slope_at(knotting, i);
    return status ? status
                  : moved(knotting, &knotting->hops[before(knotting, i)].path, false, &vector, out);
}

/* --- ends ------------------------------------------------------------------------------------- */

/* (3/2) log / D - v / 2, where log / D leads along the curve: at the first point towards the
 * second, at the last one away from the one before. */
static enum gd_status natural_tangent(const struct gd__knotting *knotting, bool at_end,
                                      bool is_alone, struct gd_vector *out)
{
    uint32_t hop = at_end ? knotting->hop_count - 1 : 0, here = hop + at_end,
             neighbour = hop + !at_end;
    const struct gd_spline_knot *knots = knotting->knots;
    double slope = (at_end ? -1 : 1) / (knots[hop + 1].parameter - knots[hop].parameter);
    struct gd_vector vectors[2] = {0};
    enum gd_status status = log_of(knotting, &knotting->hops[hop].path, at_end, &vectors[0]);
    if (!status && !is_alone)
        status = moved(knotting, &knotting->hops[hop].path, !at_end, &knots[neighbour].tangent,
                       &vectors[1]);
    if (status) return status;
    *out = gd_vector_combine(knotting->mesh, &knotting->request->points[here], vectors,
                             (double[2]){is_alone ? slope : 1.5 * slope, -0.5}, is_alone ? 1 : 2);
    return GD_OK;
}

static enum gd_status fill_ends(const struct gd__knotting *knotting)
{
    const struct gd_spline_request *request = knotting->request;
    enum gd_status status = GD_OK;
    uint32_t last = knotting->hop_count;
    bool first_is_given = is_given(request, 0), last_is_given = is_given(request, last);
    bool is_alone = last == 1 && !first_is_given && !last_is_given;
    if (request->end_rule == GD_END_ZERO) return GD_OK;
    if (!first_is_given)
        status = natural_tangent(knotting, false, is_alone, &knotting->knots[0].tangent);
    if (!last_is_given && !status)
        status = natural_tangent(knotting, true, is_alone, &knotting->knots[last].tangent);
    return status;
}

/* --- the whole -------------------------------------------------------------------------------- */

static void fill_parameters(const struct gd__knotting *knotting)
{
    double parameter = 0;
    for (uint32_t i = 0; i <= knotting->hop_count; i++) {
        knotting->knots[i].parameter = parameter;
        if (i < knotting->hop_count)
            parameter += pow(knotting->hops[i].path.length, knotting->request->alpha);
    }
}

static enum gd_status fill_inner(const struct gd__knotting *knotting)
{
    const struct gd_spline_request *request = knotting->request;
    bool is_symmetric = request->tangent_rule == GD_TANGENT_SYMMETRIC;
    enum gd_status status = GD_OK;
    for (uint32_t i = request->closed ? 0 : 1; i < knotting->hop_count && !status; i++) {
        struct gd_vector *out = &knotting->knots[i].tangent;
        if (is_given(request, i)) continue;
        status =
            is_symmetric ? symmetric_tangent(knotting, i, out) : paper_tangent(knotting, i, out);
    }
    return status;
}

enum gd_status gd__knots_fill(const struct gd__knotting *knotting)
{
    const struct gd_spline_request *request = knotting->request;
    fill_parameters(knotting);
    for (uint32_t i = 0; i < request->count; i++)
        if (is_given(request, i)) knotting->knots[i].tangent = request->tangents[i];
    enum gd_status status = fill_inner(knotting);
    if (status) return status;
    if (!request->closed) return fill_ends(knotting);
    knotting->knots[knotting->hop_count].tangent = knotting->knots[0].tangent;
    return GD_OK;
}
