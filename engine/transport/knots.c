#include "transport/knots.h"

#include <stdlib.h>

#include "base/tolerance.h"
#include "gd/query.h"
#include "transport/route.h"

/* --- paths --------------------------------------------------------------------------------------------------------------- */

static enum gd_status refuse(const struct gd__knotting *knotting, uint32_t which, const char *sentence, uint32_t other)
{
    gd_fail(knotting->detail, GD_INVALID_ARGUMENT, sentence, other, which);
    if (knotting->detail) gd_detail_add(knotting->detail, GD_ELEMENT_NONE, which, 0);
    return GD_INVALID_ARGUMENT;
}

/* The shortest path from point i to point j. It is searched in the order of their places, so that reversed points have the same paths even where
 * there are several. */
static enum gd_status search(const struct gd__knotting *knotting, uint32_t i, uint32_t j,
                             const struct gd_control *control, struct gd_path *out)
{
    const struct gd_point *from = &knotting->request->points[i], *to = &knotting->request->points[j];
    bool is_swapped = gd__point_follows(from, to);
    struct gd_pair_answer answer;
    enum gd_status status = gd_pair_solve(knotting->mesh, is_swapped ? to : from, is_swapped ? from : to, true,
                                          knotting->request->landmarks, control, &answer, knotting->detail);
    if (status) return status;
    knotting->share->done++;
    if (!answer.path.count) {
        gd_pair_answer_free(&answer);
        return refuse(knotting, j, "points %u and %u of the spline lie on components that no path joins", i);
    }
    if (is_swapped) gd__points_reverse(answer.path.points, answer.path.count);
    *out = answer.path;
    return GD_OK;
}

/* Between points that are one there is no direction. */
static enum gd_status check_apart(const struct gd__knotting *knotting)
{
    double longest = 0;
    for (uint32_t i = 0; i < knotting->hop_count; i++) longest = fmax(longest, knotting->hops[i].length);
    for (uint32_t i = 0; i < knotting->hop_count; i++) {
        if (knotting->hops[i].length > GD_TOL_SAME_POINT * longest) continue;
        if (i + 1 == knotting->request->count)
            return refuse(knotting, i, "point %u is there again as point %u; a closed spline joins its ends by itself",
                          0);
        return refuse(knotting, i + 1, "points %u and %u of the spline are the same place; leave one out", i);
    }
    return GD_OK;
}

enum gd_status gd__knots_search(struct gd__knotting *knotting)
{
    enum gd_status status = GD_OK;
    size_t held = 0;
    for (uint32_t i = 0; i < knotting->hop_count && !status; i++) {
        const struct gd_control own = gd__share_control(knotting->share, held);
        status = search(knotting, i, (i + 1) % knotting->request->count, &own, &knotting->hops[i]);
        held += knotting->hops[i].count * sizeof(struct gd_point);
    }
    return status ? status : check_apart(knotting);
}

/* --- vectors ------------------------------------------------------------------------------------------------------------- */

/* The vector of a path, from its beginning or from its end. */
static enum gd_status log_of(const struct gd__knotting *knotting, const struct gd_path *path, bool backwards,
                             struct gd_vector *out)
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
static enum gd_status moved(const struct gd__knotting *knotting, const struct gd_path *path, bool to_beginning,
                            const struct gd_vector *vector, struct gd_vector *out)
{
    struct gd_path turned = *path;
    struct gd__route copy = {0};
    enum gd_status status = GD_OK;
    if (to_beginning) {
        status = gd__route_join(&copy, path->points, path->count, 0, true, knotting->control);
        turned.points = copy.points;
    }
    if (!status) status = gd_vector_transport(knotting->mesh, &turned, vector, 1, out, knotting->detail);
    gd__route_free(&copy);
    return status;
}

/* --- inner points -------------------------------------------------------------------------------------------------------- */

/* The parameters' difference across point i, and the hop that comes to it. */
static double span_around(const struct gd__knotting *knotting, uint32_t i, uint32_t *before)
{
    const struct gd_spline_knot *knots = knotting->knots;
    *before = i ? i - 1 : knotting->hop_count - 1;
    return knots[i + 1].parameter - knots[i].parameter + knots[*before + 1].parameter - knots[*before].parameter;
}

static enum gd_status symmetric_tangent(const struct gd__knotting *knotting, uint32_t i, struct gd_vector *out)
{
    uint32_t before;
    double factor = (1 - knotting->request->tension) / span_around(knotting, i, &before);
    struct gd_vector vectors[2];
    enum gd_status status = log_of(knotting, &knotting->hops[i], false, &vectors[0]);
    if (!status) status = log_of(knotting, &knotting->hops[before], true, &vectors[1]);
    if (!status)
        *out =
            gd_vector_combine(knotting->mesh, &knotting->request->points[i], vectors, (double[2]){factor, -factor}, 2);
    return status;
}

static enum gd_status paper_tangent(const struct gd__knotting *knotting, uint32_t i, struct gd_vector *out)
{
    uint32_t before, count = knotting->request->count;
    double factor = (1 - knotting->request->tension) / span_around(knotting, i, &before);
    struct gd_path path;
    struct gd_vector vector = {0};
    enum gd_status status = search(knotting, before, (i + 1) % count, knotting->control, &path);
    if (status) return status;
    status = log_of(knotting, &path, false, &vector);
    gd_path_free(&path);
    vector.length *= factor;
    return status ? status : moved(knotting, &knotting->hops[before], false, &vector, out);
}

/* --- ends ---------------------------------------------------------------------------------------------------------------- */

/* (3/2) log / D - v / 2, where log / D leads along the curve: at the first point towards the second, at the last one away from the one before. */
static enum gd_status natural_tangent(const struct gd__knotting *knotting, bool at_end, bool is_alone,
                                      struct gd_vector *out)
{
    uint32_t hop = at_end ? knotting->hop_count - 1 : 0, here = hop + at_end, neighbour = hop + !at_end;
    const struct gd_spline_knot *knots = knotting->knots;
    double slope = (at_end ? -1 : 1) / (knots[hop + 1].parameter - knots[hop].parameter);
    struct gd_vector vectors[2] = {0};
    enum gd_status status = log_of(knotting, &knotting->hops[hop], at_end, &vectors[0]);
    if (!status && !is_alone)
        status = moved(knotting, &knotting->hops[hop], !at_end, &knots[neighbour].tangent, &vectors[1]);
    if (status) return status;
    *out = gd_vector_combine(knotting->mesh, &knotting->request->points[here], vectors,
                             (double[2]){is_alone ? slope : 1.5 * slope, -0.5}, is_alone ? 1 : 2);
    return GD_OK;
}

static bool is_given(const struct gd_spline_request *request, uint32_t i)
{
    return request->tangents && (!request->is_given || request->is_given[i]);
}

static enum gd_status fill_ends(const struct gd__knotting *knotting)
{
    const struct gd_spline_request *request = knotting->request;
    enum gd_status status = GD_OK;
    uint32_t last = knotting->hop_count;
    bool first_is_given = is_given(request, 0), last_is_given = is_given(request, last);
    bool is_alone = last == 1 && !first_is_given && !last_is_given;
    if (request->end_rule == GD_END_ZERO) return GD_OK;
    if (!first_is_given) status = natural_tangent(knotting, false, is_alone, &knotting->knots[0].tangent);
    if (!last_is_given && !status) status = natural_tangent(knotting, true, is_alone, &knotting->knots[last].tangent);
    return status;
}

/* --- the whole ----------------------------------------------------------------------------------------------------------- */

static void fill_parameters(const struct gd__knotting *knotting)
{
    double parameter = 0;
    for (uint32_t i = 0; i <= knotting->hop_count; i++) {
        knotting->knots[i].parameter = parameter;
        if (i < knotting->hop_count) parameter += pow(knotting->hops[i].length, knotting->request->alpha);
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
        status = is_symmetric ? symmetric_tangent(knotting, i, out) : paper_tangent(knotting, i, out);
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
