#include "proto/values/domain_curve.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "proto/json/decode.h"

void proto_domain_curve_free(struct proto_domain_curve *curve)
{
    proto_uvs_free(&curve->points);
    free(curve->knots);
    *curve = (struct proto_domain_curve){0};
}

/* --- from the request ------------------------------------------------------------------------- */

static bool decode_polyline(const json_t *value, struct proto_domain_curve *curve,
                            struct proto_problem *problem)
{
    static const char *const members[] = {"polyline", "closed", NULL};
    return proto_decode_object(value, curve->place, members, problem) &&
           proto_uvs_decode(value, curve->place, "polyline", PROTO_DOMAIN_CURVE_POINTS,
                            &curve->points, problem) &&
           proto_decode_flag(value, curve->place, "closed", &curve->wants_closed, problem);
}

static bool decode_bspline(const json_t *value, struct proto_domain_curve *curve,
                           struct proto_problem *problem)
{
    static const char *const members[] = {"bspline", "closed", NULL}, *const inner[] = {
                                                                          "degree", "knots",
                                                                          "control_points", NULL};
    const json_t *spline = json_object_get(value, "bspline");
    char place[PROTO_PLACE];
    proto_place_of_member(place, curve->place, "bspline");
    return proto_decode_object(value, curve->place, members, problem) &&
           proto_decode_object(spline, place, inner, problem) &&
           proto_decode_flag(value, curve->place, "closed", &curve->wants_closed, problem) &&
           proto_decode_index(spline, place, "degree", &curve->degree, problem) &&
           proto_uvs_decode(spline, place, "control_points", PROTO_DOMAIN_CURVE_POINTS,
                            &curve->points, problem) &&
           proto_numbers_decode(spline, place, "knots", 2 * PROTO_DOMAIN_CURVE_POINTS,
                                &curve->knots, &curve->knot_count, problem) &&
           proto_knots_check(curve->points.count, curve->degree, curve->knot_count, place, problem);
}

static bool decode_range(const json_t *value, struct proto_domain_curve *curve,
                         struct proto_problem *problem)
{
    curve->has_range = json_object_get(value, "range") != NULL;
    if (!curve->has_range) return true;
    if (!proto_decode_numbers(value, curve->place, "range", 2, curve->range, problem)) return false;
    if (curve->range[0] < curve->range[1]) return true;
    return proto_problem_refuse_member(problem, curve->place, "range",
                                       "a range is [a, b] with a < b");
}

static bool decode_iso(const json_t *value, struct proto_domain_curve *curve,
                       struct proto_problem *problem)
{
    static const char *const members[] = {"iso", "value", "range", NULL};
    const char *fixed = json_string_value(json_object_get(value, "iso"));
    if (!proto_decode_object(value, curve->place, members, problem)) return false;
    if (!fixed || (strcmp(fixed, "u") != 0 && strcmp(fixed, "v") != 0))
        return proto_problem_refuse_member(
            problem, curve->place, "iso",
            "iso is \"u\" or \"v\": the parameter that stays the same");
    curve->fixed = fixed[0] == 'u' ? GD_ISO_U : GD_ISO_V;
    return proto_decode_number(value, curve->place, "value", &curve->value, problem) &&
           decode_range(value, curve, problem);
}

/* A form in which a request gives a curve. */
static const struct form {
    const char *member;
    enum proto_domain_curve_kind kind;
    bool (*decode)(const json_t *value, struct proto_domain_curve *curve,
                   struct proto_problem *problem);
} forms[] = {{"polyline", PROTO_DOMAIN_CURVE_POLYLINE, decode_polyline},
             {"bspline", PROTO_DOMAIN_CURVE_BSPLINE, decode_bspline},
             {"iso", PROTO_DOMAIN_CURVE_ISO, decode_iso}};

static const struct form *find_form(const json_t *value, const char *place,
                                    struct proto_problem *problem)
{
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++)
        if (json_object_get(value, forms[i].member)) return &forms[i];
    proto_problem_refuse(problem, place,
                         "a curve has one of \"polyline\", \"bspline\" and \"iso\"");
    return NULL;
}

bool proto_domain_curve_decode(const json_t *document, const char *member,
                               struct proto_domain_curve *out, struct proto_problem *problem)
{
    struct proto_domain_curve curve = {0};
    const json_t *value = proto_decode_member(document, "", member, problem);
    if (!value) return false;
    snprintf(curve.place, sizeof curve.place, "/%s", member);
    const struct form *form = find_form(value, curve.place, problem);
    if (!form) return false;
    curve.kind = form->kind;
    if (form->decode(value, &curve, problem)) {
        *out = curve;
        return true;
    }
    proto_domain_curve_free(&curve);
    return false;
}

bool proto_domain_curve_decode_point(const json_t *document, const char *member,
                                     struct proto_domain_curve *out, struct proto_problem *problem)
{
    struct proto_domain_curve curve = {.kind = PROTO_DOMAIN_CURVE_POINT};
    double uv[2];
    if (!proto_uv_decode(document, "", member, uv, problem)) return false;
    curve.points = (struct proto_uvs){malloc(sizeof *curve.points.items), 1};
    if (!curve.points.items) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    memcpy(curve.points.items[0], uv, sizeof uv);
    snprintf(curve.place, sizeof curve.place, "/%s", member);
    *out = curve;
    return true;
}

/* --- on the surface --------------------------------------------------------------------------- */

static bool check_points(const struct gd_parametric *surface,
                         const struct proto_domain_curve *curve, struct proto_problem *problem)
{
    static const char *const lists[] = {[PROTO_DOMAIN_CURVE_POLYLINE] = "polyline",
                                        [PROTO_DOMAIN_CURVE_BSPLINE] = "bspline/control_points"};
    for (uint32_t i = 0; i < curve->points.count; i++) {
        char list[PROTO_PLACE], place[PROTO_PLACE];
        if (gd_parametric_contains(surface, curve->points.items[i][0], curve->points.items[i][1]))
            continue;
        if (curve->kind == PROTO_DOMAIN_CURVE_POINT) {
            snprintf(place, sizeof place, "%s", curve->place);
        } else {
            proto_place_of_member(list, curve->place, lists[curve->kind]);
            proto_place_of_element(place, list, i);
        }
        return proto_uv_check(surface, curve->points.items[i], place, problem);
    }
    return true;
}

static enum gd_status make_iso(const struct gd_parametric *surface,
                               const struct proto_domain_curve *curve,
                               const struct gd_control *control, struct gd_domain_curve **out,
                               struct gd_detail *detail)
{
    if (!curve->has_range)
        return gd_domain_curve_iso(surface, curve->fixed, curve->value, out, detail);
    double low = curve->range[0], high = curve->range[1], ends[2][2];
    int fixed = curve->fixed == GD_ISO_U ? 0 : 1;
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
    const double(*points)[2] = (const double(*)[2])curve->points.items;
    switch (curve->kind) {
    case PROTO_DOMAIN_CURVE_POLYLINE:
        return gd_domain_curve_polyline(surface,
                                        &(struct gd_domain_polyline){points, curve->points.count},
                                        control, out, detail);
    case PROTO_DOMAIN_CURVE_BSPLINE:
        return gd_domain_curve_bspline(
            surface,
            &(struct gd_domain_bspline){curve->degree, curve->knots, points, curve->points.count},
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
    uint32_t count = curve->points.count;
    double(*corners)[2] = malloc((count + 1) * sizeof *corners);
    if (!corners) return GD_NO_MEMORY;
    memcpy(corners, curve->points.items, count * sizeof *corners);
    memcpy(corners[count], corners[0], sizeof *corners);
    enum gd_status status = gd_domain_curve_polyline(
        surface, &(struct gd_domain_polyline){(const double(*)[2])corners, count + 1}, control, out,
        detail);
    free(corners);
    return status;
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
    if (!status && curve->wants_closed && !gd_domain_curve_is_closed(made)) {
        gd_domain_curve_release(made);
        if (curve->kind != PROTO_DOMAIN_CURVE_POLYLINE)
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
    *out = made;
    return true;
}
