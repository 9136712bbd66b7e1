#include <math.h>
#include <stdlib.h>

#include "base/tolerance.h"
#include "gd/space_distance.h"
#include "nurbs/bspline.h"

enum { PARTS = 16, STEPS_MOST = 60 }; /* of a span at which it is looked at */

struct look {
    struct gd_vec3 x, first, second;
};

static struct look look_at(const struct gd_space_curve *curve, double s)
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

/* Pieces of a curve, each within a ball about its middle. */
struct bits {
    uint32_t count;
    struct bit {
        double low, high, radius;
        struct gd_vec3 middle;
    } * bit;
};

/* The derivative's control points bound the speed on a span: so far from the middle no point of the
 * bit lies. */
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
                (struct bit){begin, end, radius, look_at(curve, 0.5 * (begin + end)).x};
        }
    }
    return GD_OK;
}

static double clamp(const struct bit *bit, double s)
{
    return fmin(fmax(s, bit->low), bit->high);
}

/* At an end of the bit, and downhill is beyond it? */
static bool is_held(const struct bit *bit, double s, double gradient)
{
    return (s <= bit->low && gradient >= 0) || (s >= bit->high && gradient <= 0);
}

/* The step of 1/2 |a(s) - b(t)|^2: Newton where its Hessian, bends of the curves included, is
 * positive, else Gauss-Newton; among what is not held. */
static void step_of(const struct look *a, const struct look *b, const struct bit *p,
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
    bool held[2] = {is_held(p, at[0], g[0]), is_held(q, at[1], g[1])},
         both = !held[0] && !held[1] && det > 0;
    for (int k = 0; k < 2; k++) {
        double alone = held[k] || !(h[k] > 0) ? 0 : -g[k] / h[k];
        step[k] = both ? (ab * g[1 - k] - h[1 - k] * g[k]) / det : alone;
    }
}

/* Downhill within one pair of bits. */
static void descend(const struct gd_space_curve *from, const struct gd_space_curve *to,
                    const struct bit *p, const struct bit *q, struct gd_space_foot *best)
{
    double s = 0.5 * (p->low + p->high), t = 0.5 * (q->low + q->high);
    struct look a = look_at(from, s), b = look_at(to, t);
    double distance = gd_vec3_distance(a.x, b.x);
    for (int i = 0; i < STEPS_MOST; i++) {
        double step[2], next = INFINITY, part = 1, u = s, v = t;
        step_of(&a, &b, p, q, (double[]){s, t}, step);
        for (int k = 0; k < STEPS_MOST && !(next <= distance); k++, part *= 0.5) {
            u = clamp(p, s + part * step[0]), v = clamp(q, t + part * step[1]);
            a = look_at(from, u), b = look_at(to, v);
            next = gd_vec3_distance(a.x, b.x);
        }
        if (!(next <= distance) || (u == s && v == t)) break;
        s = u, t = v;
        distance = next;
    }
    if (distance < best->distance)
        *best = (struct gd_space_foot){distance, s, t, look_at(from, s).x, look_at(to, t).x};
}

/* Bits are tried in order; those that can't beat the best so far, which the bits' middles begin,
 * are passed over. */
static void search(const struct gd_space_curve *from, const struct gd_space_curve *to,
                   const struct bits *a, const struct bits *b, struct gd_space_foot *best)
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
                descend(from, to, &a->bit[i], &b->bit[j], best);
        }
    }
}

static enum gd_status check(const struct gd_space_curve *curve, struct gd_detail *detail)
{
    if (curve->degree > GD__DEGREE_MAX || curve->count < curve->degree + 1 ||
        curve->count > GD_SPACE_CURVE_COUNT_MAX || (!curve->degree && curve->count != 1))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "a curve has a degree of at most %d and between degree + 1 and %d points; a "
                       "point is degree 0",
                       GD__DEGREE_MAX, GD_SPACE_CURVE_COUNT_MAX);
    for (uint32_t i = 0; i < curve->count; i++)
        if (!(isfinite(curve->points[i].x) && isfinite(curve->points[i].y) &&
              isfinite(curve->points[i].z)))
            return gd_fail(detail, GD_INVALID_ARGUMENT, "point %u of the curve is not finite", i);
    for (uint32_t i = 0; curve->degree && i < curve->count + curve->degree + 1; i++)
        if (!isfinite(curve->knots[i]) || (i && curve->knots[i] < curve->knots[i - 1]))
            return gd_fail(detail, GD_INVALID_ARGUMENT,
                           "knot %u of the curve is not finite or decreases", i);
    for (uint32_t i = curve->degree + 1; curve->degree && i + curve->degree < curve->count; i++)
        if (curve->knots[i] == curve->knots[i + curve->degree])
            return gd_fail(detail, GD_INVALID_ARGUMENT,
                           "knot %u of the curve is repeated more than %u times", i, curve->degree);
    if (curve->degree && !(curve->knots[curve->degree] < curve->knots[curve->count]))
        return gd_fail(detail, GD_INVALID_ARGUMENT, "the curve's knots leave it no domain");
    return GD_OK;
}

enum gd_status gd_space_distance(const struct gd_space_curve *from, const struct gd_space_curve *to,
                                 struct gd_space_foot *out, struct gd_detail *detail)
{
    enum gd_status status = check(from, detail);
    if (!status) status = check(to, detail);
    if (status) return status;
    struct bits a = {0}, b = {0};
    struct gd_space_foot best = {.distance = INFINITY};
    status = make_bits(from, &a);
    if (!status) status = make_bits(to, &b);
    if (!status) search(from, to, &a, &b, &best);
    free(a.bit);
    free(b.bit);
    if (status) return gd_fail(detail, status, "%s", gd_status_sentence(status));
    *out = best;
    return GD_OK;
}
