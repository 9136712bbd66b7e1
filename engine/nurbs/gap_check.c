/* Tests whether a geodesic stays in a trimmed domain. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/tolerance.h"
#include "nurbs/taut.h"

/* A place of the chain: its piece, span and parameter. */
struct spot {
    const struct gd__piece *piece;
    uint32_t span;
    double t;
};

struct check {
    const struct gd__chain *chain;
    struct gd__uv_polyline samples;
    double worst; /* smallest depth so far */
    struct spot worst_spot;
    double worst_position; /* index of its sample, plus the fraction of the step */
    struct gd__loop_place place;
};

/* Returns the spot after a fraction of the step from a sample to the next one. */
static struct spot spot_of(const struct gd__chain *chain, uint32_t sample, double part)
{
    const struct gd__piece *piece = chain->pieces;
    uint32_t span = sample / GD__SAMPLES_A_SPAN;
    double steps = sample % GD__SAMPLES_A_SPAN + part;
    while (span >= piece->spans && piece + 1 < chain->pieces + chain->piece_count)
        span -= piece++->spans;
    if (span == piece->spans) span--, steps = GD__SAMPLES_A_SPAN; /* the chain's end */
    const double *knot = piece->knots + chain->degree + span;
    struct spot spot = {piece, span, knot[0] + (knot[1] - knot[0]) * steps / GD__SAMPLES_A_SPAN};
    return spot;
}

/* Computes the depth after a fraction of the step from a sample to the next one. */
static void probe(struct check *check, uint32_t sample, double part)
{
    struct gd__loop_place place;
    struct gd__curve_jet c;
    const struct spot spot = spot_of(check->chain, sample, part);
    gd__piece_at(check->chain, spot.piece, spot.span, spot.t, &c);
    double depth = gd__surface_depth(check->chain->surface, c.at, &place);
    if (depth >= check->worst) return;
    check->worst = depth;
    check->worst_spot = spot;
    check->worst_position = sample + part;
    check->place = place;
}

/* Returns the fraction of the segment (a, b) at which it crosses (p, q), or -1 if it does not. Sets
 * *other to the fraction of (p, q). */
static double crossing_of(const double a[2], const double b[2], const double p[2],
                          const double q[2], double *other)
{
    double u[2] = {b[0] - a[0], b[1] - a[1]}, v[2] = {q[0] - p[0], q[1] - p[1]},
           w[2] = {p[0] - a[0], p[1] - a[1]};
    double area = u[0] * v[1] - u[1] * v[0];
    if (area == 0) return -1;
    double t = (w[0] * v[1] - w[1] * v[0]) / area;
    *other = (w[0] * u[1] - w[1] * u[0]) / area;
    return t >= 0 && t <= 1 && *other >= 0 && *other <= 1 ? t : -1;
}

static int by_number(const void *x, const void *y)
{
    const double *p = x, *q = y;
    return *p < *q ? -1 : *p > *q;
}

/* If the chord between two samples crosses loops, computes the depth halfway between each two
 * consecutive crossings. So a hole that is narrower than the chord is found. */
static enum gd_status probe_chord(struct check *check, uint32_t sample)
{
    enum { CROSSINGS_MOST = 64 };
    const struct gd_parametric *surface = check->chain->surface;
    const struct gd__loop_samples *samples = &surface->loops->samples;
    const double(*at)[2] = (const double(*)[2])check->samples.at + sample;
    double crossings[CROSSINGS_MOST + 2] = {0, 1}, a[2], b[2];
    uint32_t count = 2;
    for (int k = 0; k < 2; k++) {
        a[k] = gd__axis_wrap(surface->axis[k], at[0][k]);
        b[k] = a[k] + at[1][k] - at[0][k];
    }
    for (uint32_t i = 0; i < surface->loops->count; i++) {
        uint32_t first = samples->first[i], n = samples->first[i + 1] - first;
        for (uint32_t k = 0; k < n && count < CROSSINGS_MOST; k++) {
            double other, t = crossing_of(a, b, samples->at[first + k],
                                          samples->at[first + (k + 1) % n], &other);
            if (t >= 0) crossings[count++] = t;
        }
        if (!gd__pace(check->chain->pace, n)) return check->chain->pace->status;
    }
    if (count == 2) return GD_OK;
    qsort(crossings, count, sizeof *crossings, by_number);
    for (uint32_t i = 0; i + 1 < count; i++)
        probe(check, sample, 0.5 * (crossings[i] + crossings[i + 1]));
    return GD_OK;
}

/* Finds the places of the loop between which the path is outside the domain: its last crossing
 * before the worst place, and the first one after it. */
static void find_crossings(const struct check *check, struct gd__leaving *out)
{
    const struct gd_parametric *surface = check->chain->surface;
    const struct gd__loops *loops = surface->loops;
    const struct gd__loop_samples *samples = &loops->samples;
    uint32_t loop = out->place.loop, first = samples->first[loop],
             n = samples->first[loop + 1] - first;
    double at[2] = {-1, INFINITY};
    for (uint32_t i = 0; i + 1 < check->samples.count; i++) {
        double ends[2][2];
        for (int k = 0; k < 4; k++)
            ends[k / 2][k % 2] = check->samples.at[i + (uint32_t)k / 2][k % 2] - out->shift[k % 2];
        for (uint32_t k = 0; k < n; k++) {
            double part, t = crossing_of(ends[0], ends[1], samples->at[first + k],
                                         samples->at[first + (k + 1) % n], &part);
            int side = i + t > check->worst_position;
            if (t < 0 || (side ? i + t >= at[1] : i + t < at[0])) continue;
            double from = samples->s[first + k],
                   to = k + 1 < n ? samples->s[first + k + 1] : loops->loops[loop].span_count;
            at[side] = i + t;
            out->s[side] = from + part * (to - from);
        }
        if (!gd__pace(check->chain->pace, n)) return;
    }
    out->has_crossings = true;
    for (int side = 0; side < 2; side++) {
        struct gd__loop_place place;
        if (isfinite(at[side]) && at[side] >= 0) continue;
        /* rounding may hide a crossing at an end of the gap */
        double depth = gd__surface_depth(
            surface, check->samples.at[side ? check->samples.count - 1 : 0], &place);
        if (fabs(depth) > GD_TOL_TRIMMED || place.loop != loop) out->has_crossings = false;
        out->s[side] = place.s;
    }
}

static void leaving_of(struct check *check, struct gd__leaving *out)
{
    const struct spot *worst = &check->worst_spot;
    struct gd__curve_jet c;
    struct gd_jet x;
    gd__piece_at(check->chain, worst->piece, worst->span, worst->t, &c);
    gd__piece_jet(check->chain, worst->piece, c.at, &x);
    *out = (struct gd__leaving){.place = check->place,
                                .at = {c.at[0], c.at[1]},
                                .velocity = gd__velocity(&x, c.first),
                                .sample = (uint32_t)check->worst_position,
                                .is_sample = fmod(check->worst_position, 1) == 0};
    for (int k = 0; k < 2; k++) {
        double period = gd__axis_period(check->chain->surface->axis[k]);
        if (period > 0) out->shift[k] = round((out->at[k] - out->place.at[k]) / period) * period;
    }
    find_crossings(check, out);
    out->samples = check->samples;
    check->samples = (struct gd__uv_polyline){0};
}

enum gd_status gd__gap_check(const struct gd__chain *chain, bool *inside, struct gd__leaving *out)
{
    struct check check = {.chain = chain, .worst = INFINITY};
    enum gd_status status = gd__uv_polyline_sample(chain, &check.samples);
    uint64_t cost = chain->surface->loops->samples.count / 4 + 1;
    for (uint32_t i = 0; i < check.samples.count && !status; i++) {
        probe(&check, i, 0);
        if (i + 1 < check.samples.count) status = probe_chord(&check, i);
        if (!status) status = gd__pace_step(chain->pace, cost);
    }
    *inside = check.worst >= -GD_TOL_LEAVES;
    if (!status && !*inside) leaving_of(&check, out);
    gd__uv_polyline_free(&check.samples);
    return status;
}
