#include "proto/values/domain_curve.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- from the request ------------------------------------------------------------------------- */

bool proto_domain_bspline_check(const struct proto_object *object,
                                struct proto_domain_bspline *read)
{
    return proto_knots_check(read->control_points.count, read->degree, read->knots.count,
                             object->place, object->problem);
}

bool proto_domain_curve_check(const struct proto_object *object, struct proto_domain_curve *read)
{
    return !read->has_range || read->range[0] < read->range[1] ||
           proto_problem_refuse_member(object->problem, object->place, "range",
                                       "a range is [a, b] with a < b");
}

bool proto_domain_curve_decode_member(const json_t *document, const char *member,
                                      struct proto_domain_curve *out, struct proto_problem *problem)
{
    char place[PROTO_PLACE];
    const json_t *value = proto_decode_member(document, "", member, problem);
    proto_place_of_member(place, "", member);
    return value && proto_domain_curve_decode(value, place, out, problem);
}

bool proto_domain_curve_decode_point(const json_t *document, const char *member,
                                     struct proto_domain_curve *out, struct proto_problem *problem)
{
    struct proto_domain_curve curve = {.form = PROTO_DOMAIN_CURVE_POINT};
    double uv[2];
    if (!proto_decode_numbers(document, "", member, 2, uv, problem)) return false;
    curve.polyline = (struct proto_uvs){malloc(sizeof *curve.polyline.items), 1};
    if (!curve.polyline.items) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    memcpy(curve.polyline.items[0], uv, sizeof uv);
    snprintf(curve.place, sizeof curve.place, "/%s", member);
    *out = curve;
    return true;
}

/* --- on the surface --------------------------------------------------------------------------- */

static bool check_points(const struct gd_parametric *surface,
                         const struct proto_domain_curve *curve, struct proto_problem *problem)
{
    bool is_spline = curve->form == PROTO_DOMAIN_CURVE_BSPLINE;
    const struct proto_uvs *points = is_spline ? &curve->bspline.control_points : &curve->polyline;
    for (uint32_t i = 0; i < points->count; i++) {
        char list[PROTO_PLACE], place[PROTO_PLACE];
        if (gd_parametric_contains(surface, points->items[i][0], points->items[i][1])) continue;
        proto_place_of_member(list, curve->place,
                              is_spline ? "bspline/control_points" : "polyline");
        proto_place_of_element(place, list, i);
        return proto_uv_check(surface, points->items[i],
                              curve->form == PROTO_DOMAIN_CURVE_POINT ? curve->place : place,
                              problem);
    }
    return true;
}

static enum gd_status make_iso(const struct gd_parametric *surface,
                               const struct proto_domain_curve *curve,
                               const struct gd_control *control, struct gd_domain_curve **out,
                               struct gd_detail *detail)
{
    enum gd_iso fixed = curve->iso == PROTO_ISO_U ? GD_ISO_U : GD_ISO_V;
    if (!curve->has_range) return gd_domain_curve_iso(surface, fixed, curve->value, out, detail);
    double low = curve->range[0], high = curve->range[1], ends[2][2];
    for (int i = 0; i < 2; i++) {
        ends[i][fixed] = curve->value;
        ends[i][1 - fixed] = curve->range[i];
    }
    return gd_domain_curve_bspline(surface,
                                   &(struct gd_domain_bspline){1, (double[]){low, low, high, high},
                                                               (const double(*)[2])ends, 2},
                                   control, out, detail);
}

static enum gd_status make(const struct gd_parametric *surface,
                           const struct proto_domain_curve *curve, const struct gd_control *control,
                           struct gd_domain_curve **out, struct gd_detail *detail)
{
    const double(*points)[2] = (const double(*)[2])curve->polyline.items;
    const struct proto_domain_bspline *spline = &curve->bspline;
    switch (curve->form) {
    case PROTO_DOMAIN_CURVE_POLYLINE:
        return gd_domain_curve_polyline(surface,
                                        &(struct gd_domain_polyline){points, curve->polyline.count},
                                        control, out, detail);
    case PROTO_DOMAIN_CURVE_BSPLINE:
        return gd_domain_curve_bspline(
            surface,
            &(struct gd_domain_bspline){spline->degree, spline->knots.items,
                                        (const double(*)[2])spline->control_points.items,
                                        spline->control_points.count},
            control, out, detail);
    case PROTO_DOMAIN_CURVE_ISO:
        return make_iso(surface, curve, control, out, detail);
    case PROTO_DOMAIN_CURVE_POINT:
        break;
    }
    return gd_domain_curve_point(surface, points[0][0], points[0][1], out, detail);
}

static enum gd_status close_polyline(const struct gd_parametric *surface,
                                     const struct proto_domain_curve *curve,
                                     const struct gd_control *control, struct gd_domain_curve **out,
                                     struct gd_detail *detail)
{
    uint32_t count = curve->polyline.count;
    double(*corners)[2] = malloc((count + 1) * sizeof *corners);
    if (!corners) return GD_NO_MEMORY;
    memcpy(corners, curve->polyline.items, count * sizeof *corners);
    memcpy(corners[count], corners[0], sizeof *corners);
    enum gd_status status = gd_domain_curve_polyline(
        surface, &(struct gd_domain_polyline){(const double(*)[2])corners, count + 1}, control, out,
        detail);
    free(corners);
    return status;
}

/* Checks that the curve stays within the loops of a trimmed surface. */
static bool check_inside(const struct gd_domain_curve *made, const struct proto_domain_curve *curve,
                         const struct gd_control *control, struct proto_problem *problem)
{
    double uv[2];
    bool inside;
    enum gd_status status = gd_domain_curve_inside(made, control, &inside, uv);
    if (status) return proto_problem_from_status(problem, status, NULL);
    return inside || proto_uv_check(gd_domain_curve_surface(made), uv, curve->place, problem);
}

bool proto_domain_curve_locate(const struct gd_parametric *surface,
                               const struct proto_domain_curve *curve,
                               const struct gd_control *control, struct gd_domain_curve **out,
                               struct proto_problem *problem)
{
    struct gd_domain_curve *made = NULL;
    struct gd_detail detail = {0};
    if (!check_points(surface, curve, problem)) return false;
    enum gd_status status = make(surface, curve, control, &made, &detail);
    if (!status && curve->closed && !gd_domain_curve_is_closed(made)) {
        gd_domain_curve_release(made);
        if (curve->form != PROTO_DOMAIN_CURVE_POLYLINE)
            return proto_problem_refuse(
                problem, curve->place,
                "the B-spline's ends are two places, so it is not closed; let it end where it "
                "begins, or leave \"closed\" out");
        status = close_polyline(surface, curve, control, &made, &detail);
    }
    if (status) {
        proto_problem_from_status(problem, status, &detail);
        return status == GD_INVALID_ARGUMENT ? proto_problem_at(problem, curve->place) : false;
    }
    if (!check_inside(made, curve, control, problem)) {
        gd_domain_curve_release(made);
        return false;
    }
    *out = made;
    return true;
}
