#include <math.h>
#include <stdlib.h>

#include "base/tolerance.h"
#include "gd/space_distance.h"
#include "nurbs/bspline.h"

enum { PARTS = 16, STEPS_MOST = 60 }; /* PARTS: number of bits of a span */

struct look {
    struct gd_vec3 x, first, second;
};

static struct look space_curve_at(const struct gd_space_curve *curve, double s)
{
    if (!curve->degree) return (struct look){.x = curve->points[0]};
    struct look look = {0};
    struct gd__basis basis;
    uint32_t span = gd__basis_span(curve->degree, curve->count, curve->knots, s);
    gd__basis(curve->degree, curve->knots, span, s, &basis);
    for (uint32_t i = 0; i <= curve->degree; i++) {
        struct gd_vec3 point = curve->points[span - curve->degree + i];
        look.x = gd_vec3_along(look.x, basis.value[i], point);
        look.first = gd_vec3_along(look.first, basis.first[i], point);
        look.second = gd_vec3_along(look.second, basis.second[i], point);
    }
    return look;
}

/* A curve divided into bits, each in a ball around its middle. */
struct bits {
    uint32_t count;
    struct bit {
        double low, high, radius;
        struct gd_vec3 middle;
    } * bit;
};

/* Returns a bound of the speed on a span, from the derivative's control points. It serves to bound
 * the distances of the span's points from the span's middle. */
static double speed_bound(const struct gd_space_curve *curve, uint32_t span)
{
    double most = 0;
    for (uint32_t i = span - curve->degree + 1; i <= span; i++) {
        double width = curve->knots[i + curve->degree] - curve->knots[i];
        most = fmax(most, curve->degree * gd_vec3_distance(curve->points[i], curve->points[i - 1]) /
                              width);
    }
    return most;
}

static enum gd_status make_bits(const struct gd_space_curve *curve, struct bits *out)
{
    uint32_t spans = curve->degree ? curve->count - curve->degree : 1;
    *out = (struct bits){.bit = malloc(spans * PARTS * sizeof *out->bit)};
    if (!out->bit) return GD_NO_MEMORY;
    if (!curve->degree) out->bit[out->count++] = (struct bit){.middle = curve->points[0]};
    for (uint32_t span = curve->degree; curve->degree && span < curve->count; span++) {
        double low = curve->knots[span], width = (curve->knots[span + 1] - low) / PARTS;
        if (!(width > 0)) continue;
        double radius = 0.5 * width * speed_bound(curve, span);
        for (int i = 0; i < PARTS; i++) {
            double begin = low + i * width,
                   end = i + 1 == PARTS ? curve->knots[span + 1] : begin + width;
            out->bit[out->count++] =
                (struct bit){begin, end, radius, space_curve_at(curve, 0.5 * (begin + end)).x};
        }
    }
    return GD_OK;
}

static double space_clamp(const struct bit *bit, double s)
{
    return fmin(fmax(s, bit->low), bit->high);
}

/* Returns true if s is at an end of the bit and the descent direction leads out of the bit. */
static bool space_is_held(const struct bit *bit, double s, double gradient)
{
    return (s <= bit->low && gradient >= 0) || (s >= bit->high && gradient <= 0);
}

/* Computes the step for 1/2 |a(s) - b(t)|^2 in the free parameters: Newton's step if the full
 * Hessian is positive, otherwise the Gauss-Newton step. */
static void space_step_of(const struct look *a, const struct look *b, const struct bit *p,
                          const struct bit *q, const double at[2], double step[2])
{
    struct gd_vec3 r = gd_vec3_sub(a->x, b->x);
    double g[2] = {gd_vec3_dot(r, a->first), -gd_vec3_dot(r, b->first)};
    double aa = gd_vec3_dot(a->first, a->first), bb = gd_vec3_dot(b->first, b->first);
    double ab = -gd_vec3_dot(a->first, b->first);
    double h[2] = {aa + gd_vec3_dot(r, a->second), bb - gd_vec3_dot(r, b->second)};
    bool newton = h[0] >= 0 && h[1] >= 0 && h[0] * h[1] - ab * ab > GD_TOL_PIVOT * aa * bb;
    double damp = newton ? 0 : GD_TOL_PIVOT * (aa + bb);
    if (!newton) h[0] = aa + damp, h[1] = bb + damp;
    double det = h[0] * h[1] - ab * ab;
    bool held[2] = {space_is_held(p, at[0], g[0]), space_is_held(q, at[1], g[1])},
         both = !held[0] && !held[1] && det > 0;
    for (int k = 0; k < 2; k++) {
        double alone = held[k] || !(h[k] > 0) ? 0 : -g[k] / h[k];
        step[k] = both ? (ab * g[1 - k] - h[1 - k] * g[k]) / det : alone;
    }
}

/* Descends within one pair of bits. */
static void space_descend(const struct gd_space_curve *from, const struct gd_space_curve *to,
                          const struct bit *p, const struct bit *q, struct gd_space_closest *best)
{
    double s = 0.5 * (p->low + p->high), t = 0.5 * (q->low + q->high);
    struct look a = space_curve_at(from, s), b = space_curve_at(to, t);
    double distance = gd_vec3_distance(a.x, b.x);
    for (int i = 0; i < STEPS_MOST; i++) {
        double step[2], next = INFINITY, part = 1, u = s, v = t;
        space_step_of(&a, &b, p, q, (double[]){s, t}, step);
        for (int k = 0; k < STEPS_MOST && !(next <= distance); k++, part *= 0.5) {
            u = space_clamp(p, s + part * step[0]), v = space_clamp(q, t + part * step[1]);
            a = space_curve_at(from, u), b = space_curve_at(to, v);
            next = gd_vec3_distance(a.x, b.x);
        }
        if (!(next <= distance) || (u == s && v == t)) break;
        s = u, t = v;
        distance = next;
    }
    if (distance < best->distance)
        *best = (struct gd_space_closest){distance, s, t, space_curve_at(from, s).x,
                                          space_curve_at(to, t).x};
}

/* Descends in all pairs of bits in order. Skips pairs whose lower bound exceeds the best distance.
 * The middles of the bits give the first bound. */
static void space_search(const struct gd_space_curve *from, const struct gd_space_curve *to,
                         const struct bits *a, const struct bits *b, struct gd_space_closest *best)
{
    double bound = INFINITY;
    for (uint32_t i = 0; i < a->count; i++)
        for (uint32_t j = 0; j < b->count; j++)
            bound = fmin(bound, gd_vec3_distance(a->bit[i].middle, b->bit[j].middle));
    for (uint32_t i = 0; i < a->count; i++) {
        for (uint32_t j = 0; j < b->count; j++) {
            double least = gd_vec3_distance(a->bit[i].middle, b->bit[j].middle) - a->bit[i].radius -
                           b->bit[j].radius;
            if (least <= fmin(bound, best->distance))
                space_descend(from, to, &a->bit[i], &b->bit[j], best);
        }
    }
}

static enum gd_status space_check(const struct gd_space_curve *curve, struct gd_detail *detail)
{
    if (curve->degree > GD__DEGREE_MAX || curve->count < curve->degree + 1 ||
        curve->count > GD_SPACE_CURVE_COUNT_MAX || (!curve->degree && curve->count != 1))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "a curve has a degree of at most %d and between degree + 1 and %d points; a "
                       "point is degree 0",
                       GD__DEGREE_MAX, GD_SPACE_CURVE_COUNT_MAX);
    for (uint32_t i = 0; i < curve->count; i++)
        if (!gd_vec3_is_finite(curve->points[i]))
            return gd_fail(detail, GD_INVALID_ARGUMENT, "point %u of the curve is not finite", i);
    return curve->degree ? gd__knots_check(curve->degree, curve->count, curve->knots, detail)
                         : GD_OK;
}

enum gd_status gd_space_distance(const struct gd_space_curve *from, const struct gd_space_curve *to,
                                 struct gd_space_closest *out, struct gd_detail *detail)
{
    enum gd_status status = space_check(from, detail);
    if (!status) status = space_check(to, detail);
    if (status) return status;
    struct bits a = {0}, b = {0};
    struct gd_space_closest best = {.distance = INFINITY};
    status = make_bits(from, &a);
    if (!status) status = make_bits(to, &b);
    if (!status) space_search(from, to, &a, &b, &best);
    free(a.bit);
    free(b.bit);
    if (status) return gd_fail_status(detail, status);
    *out = best;
    return GD_OK;
}
