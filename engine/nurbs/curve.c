#include "nurbs/curve.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/tolerance.h"
#include "nurbs/bspline.h"
#include "base/pace.h"

double gd__curve_reduce(const struct gd_domain_curve *curve, double s, double *turns)
{
    *turns = 0;
    if (s >= curve->low && s <= curve->high) return s;
    if (!curve->closed) return s < curve->low ? curve->low : curve->high;
    double period = curve->high - curve->low;
    *turns = floor((s - curve->low) / period);
    return fmin(fmax(s - *turns * period, curve->low), curve->high);
}

/* Returns t, clamped to the domain if it is outside only by rounding. */
static double unround(const struct gd_axis *axis, double t)
{
    double near = 4 * DBL_EPSILON * fmax(fabs(axis->low), fabs(axis->high));
    if (axis->closed || t < axis->low - near || t > axis->high + near) return t;
    return fmin(fmax(t, axis->low), axis->high);
}

static void nurbs_curve_evaluate(const struct gd_domain_curve *curve, uint32_t span, double s,
                                 struct gd__curve_jet *out)
{
    struct gd__basis basis;
    gd__basis(curve->degree, curve->knots, span, s, &basis);
    *out = (struct gd__curve_jet){0};
    const double(*points)[2] = (const double(*)[2])curve->points + (span - curve->degree);
    gd__basis_sum(curve->degree, basis.value, points, out->at);
    gd__basis_sum(curve->degree, basis.first, points, out->first);
    gd__basis_sum(curve->degree, basis.second, points, out->second);
    for (int k = 0; k < 2; k++) out->at[k] = unround(curve->surface->axis[k], out->at[k]);
}

static uint32_t nurbs_curve_span_of(const struct gd_domain_curve *curve, double s)
{
    return gd__basis_span(curve->degree, curve->count, curve->knots, s);
}

void gd__curve_jet(const struct gd_domain_curve *curve, double s, struct gd__curve_jet *out)
{
    if (curve->is_point) {
        *out = (struct gd__curve_jet){.at = {curve->points[0][0], curve->points[0][1]}};
        return;
    }
    double turns, within = gd__curve_reduce(curve, s, &turns);
    nurbs_curve_evaluate(curve, nurbs_curve_span_of(curve, within), within, out);
    for (int k = 0; k < 2; k++) out->at[k] += turns * curve->winding[k];
}

void gd__curve_jet_in(const struct gd_domain_curve *curve, uint32_t i, double s,
                      struct gd__curve_jet *out)
{
    nurbs_curve_evaluate(
        curve, nurbs_curve_span_of(curve, 0.5 * (curve->breaks[i] + curve->breaks[i + 1])), s, out);
}

uint32_t gd__curve_interval(const struct gd_domain_curve *curve, double s)
{
    uint32_t i = 0;
    while (i + 2 < curve->break_count && s >= curve->breaks[i + 1]) i++;
    return i;
}

double *gd__curve_places(const struct gd_domain_curve *curve, const struct gd__curve_places *wanted,
                         struct gd__arena *arena, uint32_t *count)
{
    uint32_t intervals = curve->is_point ? 0 : curve->break_count - 1, n = 0;
    uint32_t each = intervals ? (wanted->least + intervals - 1) / intervals : 0;
    if (each < wanted->each) each = wanted->each;
    if (each * intervals > wanted->most) each = wanted->most / intervals + 1;
    double *s = gd__arena_take(arena, each * intervals + (size_t)1, sizeof *s);
    *count = 0;
    if (!s) return NULL;
    for (uint32_t i = 0; i < intervals; i++)
        for (uint32_t k = 0; k < each; k++)
            s[n++] = curve->breaks[i] + (curve->breaks[i + 1] - curve->breaks[i]) * k / each;
    if (curve->is_point || wanted->with_end || !curve->closed)
        s[n++] = curve->is_point ? 0 : curve->high;
    *count = n;
    return s;
}

/* --- breaks ----------------------------------------------------------------------------------- */

/* number of steps of a polynomial piece; each step is tested for crossings of lines */
enum { LOOKS = 32 };

struct breaking {
    uint32_t capacity;
    struct gd__pace pace;
};

static enum gd_status add_break(struct gd_domain_curve *curve, struct breaking *breaking, double s)
{
    double near = GD_TOL_ADJACENT * (curve->high - curve->low);
    if (curve->break_count && s - curve->breaks[curve->break_count - 1] <= near) return GD_OK;
    return gd__array_append(&curve->breaks, &curve->break_count, &breaking->capacity, &s, sizeof s);
}

/* Returns the parameter between a and b where coordinate k enters another cell, by bisection. */
static double nurbs_curve_crossing(const struct gd_domain_curve *curve, uint32_t span, int k,
                                   double a, double b)
{
    const struct gd_axis *axis = curve->surface->axis[k];
    struct gd__curve_jet jet;
    nurbs_curve_evaluate(curve, span, a, &jet);
    int32_t cell = gd__axis_cell(axis, jet.at[k]);
    for (int i = 0; i < 100 && a < 0.5 * (a + b) && 0.5 * (a + b) < b; i++) {
        double middle = 0.5 * (a + b);
        nurbs_curve_evaluate(curve, span, middle, &jet);
        if (gd__axis_cell(axis, jet.at[k]) == cell)
            a = middle;
        else
            b = middle;
    }
    return b;
}

static bool crosses_several(const struct gd_parametric *surface, const double a[2],
                            const double b[2])
{
    for (int k = 0; k < 2; k++)
        if (abs(gd__axis_cell(surface->axis[k], a[k]) - gd__axis_cell(surface->axis[k], b[k])) > 1)
            return true;
    return false;
}

/* Appends the crossings with lines within one step of a polynomial piece, in their order. If a step
 * crosses several lines of one direction, it is halved. */
static enum gd_status break_step(struct gd_domain_curve *curve, struct breaking *breaking,
                                 uint32_t span, double a, double b)
{
    struct gd__curve_jet from, to;
    double middle = 0.5 * (a + b), at[2] = {INFINITY, INFINITY};
    if (!gd__pace(&breaking->pace, GD__STEP)) return breaking->pace.status;
    nurbs_curve_evaluate(curve, span, a, &from);
    nurbs_curve_evaluate(curve, span, b, &to);
    if (crosses_several(curve->surface, from.at, to.at) && a < middle && middle < b) {
        enum gd_status status = break_step(curve, breaking, span, a, middle);
        return status ? status : break_step(curve, breaking, span, middle, b);
    }
    for (int k = 0; k < 2; k++) {
        const struct gd_axis *axis = curve->surface->axis[k];
        if (gd__axis_cell(axis, from.at[k]) != gd__axis_cell(axis, to.at[k]))
            at[k] = nurbs_curve_crossing(curve, span, k, a, b);
    }
    enum gd_status status = GD_OK;
    if (fmin(at[0], at[1]) <= b) status = add_break(curve, breaking, fmin(at[0], at[1]));
    if (!status && fmax(at[0], at[1]) <= b) status = add_break(curve, breaking, fmax(at[0], at[1]));
    return status;
}

/* Returns true if all control points of a polynomial piece lie in one cell. The piece then lies in
 * this cell too. */
static bool is_in_one_cell(const struct gd_domain_curve *curve, uint32_t span)
{
    const double(*points)[2] = (const double(*)[2])curve->points + (span - curve->degree);
    for (int k = 0; k < 2; k++) {
        const struct gd_axis *axis = curve->surface->axis[k];
        int32_t cell = gd__axis_cell(axis, points[0][k]);
        for (uint32_t i = 1; i <= curve->degree; i++)
            if (gd__axis_cell(axis, points[i][k]) != cell) return false;
    }
    return true;
}

static enum gd_status find_breaks(struct gd_domain_curve *curve, const struct gd_control *control)
{
    struct breaking breaking = {.pace = {.control = control}};
    enum gd_status status = GD_OK;
    for (uint32_t span = curve->degree; span < curve->count && !status; span++) {
        double a = curve->knots[span], b = curve->knots[span + 1];
        if (!(a < b)) continue;
        status = add_break(curve, &breaking, a);
        for (int i = is_in_one_cell(curve, span) ? LOOKS : 0; i < LOOKS && !status; i++)
            status = break_step(curve, &breaking, span, a + (b - a) * i / LOOKS,
                                i + 1 == LOOKS ? b : a + (b - a) * (i + 1) / LOOKS);
    }
    if (!status) status = add_break(curve, &breaking, curve->high);
    if (!status && curve->break_count) curve->breaks[curve->break_count - 1] = curve->high;
    return status;
}

/* --- construction ----------------------------------------------------------------------------- */

/* Determines whether the curve is closed: its ends are the same place, or differ by whole
 * periods. */
static void find_closure(struct gd_domain_curve *curve)
{
    struct gd__curve_jet from, to;
    nurbs_curve_evaluate(curve, nurbs_curve_span_of(curve, curve->low), curve->low, &from);
    nurbs_curve_evaluate(curve, nurbs_curve_span_of(curve, curve->high), curve->high, &to);
    curve->closed = true;
    for (int k = 0; k < 2; k++) {
        const struct gd_axis *axis = curve->surface->axis[k];
        double period = gd__axis_period(axis), apart = to.at[k] - from.at[k];
        curve->winding[k] = axis->closed ? round(apart / period) * period : 0;
        if (fabs(apart - curve->winding[k]) > GD_TOL_ADJACENT * (axis->high - axis->low))
            curve->closed = false;
    }
    if (!curve->closed) curve->winding[0] = curve->winding[1] = 0;
}

/* Returns true if a place is so many periods away from the domain that its coordinates are too
 * imprecise. */
static bool is_far(const struct gd_parametric *surface, const double at[2])
{
    for (int k = 0; k < 2; k++) {
        const struct gd_axis *axis = surface->axis[k];
        if (axis->closed &&
            fabs(at[k] - axis->low) > GD_DOMAIN_CURVE_PERIODS_MAX * gd__axis_period(axis))
            return true;
    }
    return false;
}

static enum gd_status check_places(const struct gd_parametric *surface, const double (*points)[2],
                                   uint32_t count, struct gd_detail *detail)
{
    for (uint32_t i = 0; i < count; i++) {
        if (!isfinite(points[i][0]) || !isfinite(points[i][1]))
            return gd_fail(detail, GD_INVALID_ARGUMENT,
                           "point %u of the curve has a coordinate that is not finite", i);
        if (!gd_parametric_contains(surface, points[i][0], points[i][1]))
            return gd_fail(detail, GD_INVALID_ARGUMENT,
                           "point %u of the curve, (%.17g, %.17g), lies outside the surface's "
                           "domain; move it inside",
                           i, points[i][0], points[i][1]);
        if (is_far(surface, points[i]))
            return gd_fail(detail, GD_INVALID_ARGUMENT,
                           "point %u of the curve, (%.17g, %.17g), is more than %d periods away "
                           "from the domain; move it closer",
                           i, points[i][0], points[i][1], GD_DOMAIN_CURVE_PERIODS_MAX);
    }
    return GD_OK;
}

/* Creates a curve from validated arrays. With degree 0 and one control point, it is a point. */
static enum gd_status nurbs_curve_make(const struct gd_parametric *surface, uint32_t degree,
                                       const double *knots, const double (*points)[2],
                                       uint32_t count, const struct gd_control *control,
                                       struct gd_domain_curve **out, struct gd_detail *detail)
{
    struct gd_domain_curve *curve = calloc(1, sizeof *curve);
    if (!curve) return gd_fail_status(detail, GD_NO_MEMORY);
    curve->surface = gd_parametric_retain(surface);
    curve->degree = degree;
    curve->count = count;
    curve->is_point = degree == 0;
    curve->points = malloc(count * sizeof *points);
    curve->knots = malloc((count + degree + 1) * sizeof *knots);
    enum gd_status status = curve->points && curve->knots ? GD_OK : GD_NO_MEMORY;
    if (!status) {
        memcpy(curve->points, points, count * sizeof *points);
        memcpy(curve->knots, knots, (count + degree + 1) * sizeof *knots);
        curve->low = knots[degree];
        curve->high = knots[count];
    }
    if (!status && !curve->is_point) {
        find_closure(curve);
        status = find_breaks(curve, control);
    }
    if (status) {
        gd_domain_curve_release(curve);
        return gd_fail_status(detail, status);
    }
    *out = curve;
    return GD_OK;
}

enum gd_status gd_domain_curve_point(const struct gd_parametric *surface, double u, double v,
                                     struct gd_domain_curve **out, struct gd_detail *detail)
{
    const double at[1][2] = {{u, v}};
    if (!gd_parametric_contains(surface, u, v))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the point (%.17g, %.17g) lies outside the surface's domain; move it inside",
                       u, v);
    if (is_far(surface, at[0]))
        return gd_fail(
            detail, GD_INVALID_ARGUMENT,
            "the point (%.17g, %.17g) is more than %d periods away from the domain; move it closer",
            u, v, GD_DOMAIN_CURVE_PERIODS_MAX);
    return nurbs_curve_make(surface, 0, (double[]){0, 1}, at, 1, NULL, out, detail);
}

enum gd_status gd_domain_curve_bspline(const struct gd_parametric *surface,
                                       const struct gd_domain_bspline *spline,
                                       const struct gd_control *control,
                                       struct gd_domain_curve **out, struct gd_detail *detail)
{
    uint32_t degree = spline->degree, count = spline->count;
    if (degree < 1 || degree > GD__DEGREE_MAX)
        return gd_fail(detail, GD_INVALID_ARGUMENT, "the curve's degree must be between 1 and %d",
                       GD__DEGREE_MAX);
    if (count < degree + 1 || count > GD_DOMAIN_CURVE_COUNT_MAX)
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "a curve of degree %u must have between %u and %d points", degree,
                       degree + 1, GD_DOMAIN_CURVE_COUNT_MAX);
    enum gd_status status = check_places(surface, spline->points, count, detail);
    if (!status) status = gd__knots_check(degree, count, spline->knots, detail);
    return status ? status
                  : nurbs_curve_make(surface, degree, spline->knots, spline->points, count, control,
                                     out, detail);
}

enum gd_status gd_domain_curve_polyline(const struct gd_parametric *surface,
                                        const struct gd_domain_polyline *polyline,
                                        const struct gd_control *control,
                                        struct gd_domain_curve **out, struct gd_detail *detail)
{
    const double(*corners)[2] = polyline->corners;
    uint32_t count = polyline->count;
    if (count < 2 || count > GD_DOMAIN_CURVE_COUNT_MAX)
        return gd_fail(detail, GD_INVALID_ARGUMENT, "a polyline must have between 2 and %d corners",
                       GD_DOMAIN_CURVE_COUNT_MAX);
    enum gd_status status = check_places(surface, corners, count, detail);
    if (status) return status;
    for (uint32_t i = 1; i < count; i++)
        if (corners[i][0] == corners[i - 1][0] && corners[i][1] == corners[i - 1][1])
            return gd_fail(detail, GD_INVALID_ARGUMENT,
                           "corners %u and %u of the polyline are equal; leave one of them out",
                           i - 1, i);
    double *knots = malloc((count + 2) * sizeof *knots);
    if (!knots) return gd_fail_status(detail, GD_NO_MEMORY);
    for (uint32_t i = 0; i < count; i++) knots[i + 1] = i;
    knots[0] = 0;
    knots[count + 1] = count - 1;
    status = nurbs_curve_make(surface, 1, knots, corners, count, control, out, detail);
    free(knots);
    return status;
}

enum gd_status gd_domain_curve_iso(const struct gd_parametric *surface, enum gd_iso fixed,
                                   double at, struct gd_domain_curve **out,
                                   struct gd_detail *detail)
{
    int k = fixed == GD_ISO_U ? 0 : 1;
    const struct gd_axis *along = surface->axis[1 - k];
    double ends[2][2];
    for (int i = 0; i < 2; i++) {
        ends[i][k] = at;
        ends[i][1 - k] = i ? along->high : along->low;
    }
    if (gd__surface_pole(surface, k, at))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the line %c = %.17g is a pole, which is a single point of the surface; "
                       "choose another line",
                       "uv"[k], at);
    return gd_domain_curve_bspline(
        surface,
        &(struct gd_domain_bspline){1, (double[]){along->low, along->low, along->high, along->high},
                                    (const double(*)[2])ends, 2},
        NULL, out, detail);
}

void gd_domain_curve_release(const struct gd_domain_curve *curve)
{
    if (!curve) return;
    gd_parametric_release(curve->surface);
    free(curve->knots);
    free(curve->points);
    free(curve->breaks);
    free((void *)curve);
}

const struct gd_parametric *gd_domain_curve_surface(const struct gd_domain_curve *curve)
{
    return curve->surface;
}

bool gd_domain_curve_is_point(const struct gd_domain_curve *curve)
{
    return curve->is_point;
}

bool gd_domain_curve_is_closed(const struct gd_domain_curve *curve)
{
    return curve->closed;
}

void gd_domain_curve_range(const struct gd_domain_curve *curve, double *low, double *high)
{
    *low = curve->low;
    *high = curve->high;
}

void gd_domain_curve_at(const struct gd_domain_curve *curve, double s, double uv[2])
{
    struct gd__curve_jet jet;
    gd__curve_jet(curve, s, &jet);
    uv[0] = jet.at[0];
    uv[1] = jet.at[1];
}

enum gd_status gd_domain_curve_inside(const struct gd_domain_curve *curve,
                                      const struct gd_control *control, bool *inside, double uv[2])
{
    static const struct gd__curve_places wanted = {8, 256, 4096, true};
    *inside = true;
    if (!curve->surface->loops) return GD_OK;
    struct gd__pace pace = {.control = control};
    uint64_t cost = curve->surface->loops->samples.count / 4 + 1;
    struct gd__arena arena = {.budget.control = control};
    uint32_t count;
    const double *places = gd__curve_places(curve, &wanted, &arena, &count);
    for (uint32_t i = 0; i < count && *inside && gd__pace(&pace, cost); i++) {
        gd_domain_curve_at(curve, places[i], uv);
        *inside = gd_parametric_contains(curve->surface, uv[0], uv[1]);
    }
    gd__arena_free(&arena);
    return arena.status ? arena.status : pace.status;
}
