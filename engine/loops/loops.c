#include "loops/loops.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/tolerance.h"

enum {
    SAMPLES_MOST = 65536,
    DEPTH_LEAST = 2, /* a curved span is halved at least this number of times */
    DEPTH_MOST = 12,
    PROJECTIONS = 12 /* Newton steps towards the nearest place */
};

/* --- spans ------------------------------------------------------------------------------------ */

/* Divides homogeneous coordinates: value, first and second derivative of (x / w, y / w). */
static void project(const double h[3][3], struct gd__span_jet *out)
{
    double w = h[0][2];
    for (int k = 0; k < 2; k++) {
        out->at[k] = h[0][k] / w;
        out->first[k] = (h[1][k] - out->at[k] * h[1][2]) / w;
        out->second[k] = (h[2][k] - 2 * out->first[k] * h[1][2] - out->at[k] * h[2][2]) / w;
    }
}

void gd__span_jet(const struct gd__span *span, double t, struct gd__span_jet *out)
{
    uint32_t d = span->degree;
    double p[GD__SPAN_DEGREE_MAX + 1][3], h[3][3] = {{0}};
    memcpy(p, span->points, (d + 1) * sizeof *p);
    /* de Casteljau's algorithm: differences of the last points give the derivatives */
    for (uint32_t level = d; level > 0; level--) {
        for (int k = 0; k < 3; k++) {
            if (level == 2) h[2][k] = d * (d - 1) * (p[2][k] - 2 * p[1][k] + p[0][k]);
            if (level == 1) h[1][k] = d * (p[1][k] - p[0][k]);
        }
        for (uint32_t i = 0; i < level; i++)
            for (int k = 0; k < 3; k++) p[i][k] += t * (p[i + 1][k] - p[i][k]);
    }
    memcpy(h[0], p[0], sizeof h[0]);
    project((const double(*)[3])h, out);
}

enum gd_status gd__loops_fail(struct gd_trim_fault *fault, uint32_t loop, uint32_t curve,
                              const char *format, ...)
{
    if (!fault) return GD_INVALID_ARGUMENT;
    char text[GD_DETAIL_TEXT];
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    fault->loop = loop;
    fault->curve = curve;
    return gd_fail(&fault->detail, GD_INVALID_ARGUMENT, "%s", text);
}

/* --- curves to spans -------------------------------------------------------------------------- */

static enum gd_status check_knots(const struct gd_trim_curve *curve, uint32_t loop, uint32_t number,
                                  struct gd_trim_fault *fault)
{
    const double *k = curve->knots;
    uint32_t total = curve->count + curve->degree + 1;
    for (uint32_t i = 0, first = 0; i < total; i++) {
        if (!isfinite(k[i]) || (i && k[i] < k[i - 1]))
            return gd__loops_fail(fault, loop, number, "knot %u is not finite or decreases", i);
        if (k[i] > k[first]) first = i;
        if (k[i] > k[curve->degree] && k[i] < k[curve->count] && i - first >= curve->degree)
            return gd__loops_fail(fault, loop, number,
                                  "knot %.17g is repeated more than %u times: the curve has a gap",
                                  k[i], curve->degree);
    }
    if (!(k[curve->degree] < k[curve->count]))
        return gd__loops_fail(fault, loop, number, "the knots leave no range of the parameter");
    return GD_OK;
}

static enum gd_status check_curve(const struct gd_trim_curve *curve, uint32_t loop, uint32_t number,
                                  struct gd_trim_fault *fault)
{
    if (curve->degree < 1 || curve->degree > GD_TRIM_DEGREE_MAX)
        return gd__loops_fail(fault, loop, number, "degree %u is not between 1 and %d",
                              curve->degree, GD_TRIM_DEGREE_MAX);
    if (curve->count < curve->degree + 1 || curve->count > GD_TRIM_POINTS_MAX)
        return gd__loops_fail(fault, loop, number, "degree %u needs %u to %d points, not %u",
                              curve->degree, curve->degree + 1, GD_TRIM_POINTS_MAX, curve->count);
    if (!curve->knots && curve->degree > 1 && curve->count != curve->degree + 1)
        return gd__loops_fail(
            fault, loop, number,
            "without knots the curve is a Bézier curve: degree %u needs %u points", curve->degree,
            curve->degree + 1);
    for (uint32_t i = 0; i < curve->count; i++) {
        double w = curve->weights ? curve->weights[i] : 1;
        if (!(fabs(curve->points[i][0]) < GD_EXTENT_MAX &&
              fabs(curve->points[i][1]) < GD_EXTENT_MAX))
            return gd__loops_fail(fault, loop, number, "point %u is not finite", i);
        if (!(w > 1 / GD_EXTENT_RATIO && w < GD_EXTENT_RATIO))
            return gd__loops_fail(fault, loop, number, "weight %u is %.17g: must be > 0", i, w);
    }
    return curve->knots ? check_knots(curve, loop, number, fault) : GD_OK;
}

static void take_point(const struct gd_trim_curve *curve, uint32_t i, double out[3])
{
    double w = curve->weights ? curve->weights[i] : 1;
    out[0] = w * curve->points[i][0], out[1] = w * curve->points[i][1], out[2] = w;
}

/* Computes Bézier point j of the knot interval that begins at knots[k]: the value of the curve's
 * blossom for degree - j arguments at the interval's beginning and j arguments at its end. */
static void blossom(const struct gd_trim_curve *curve, uint32_t k, uint32_t j, double out[3])
{
    uint32_t d = curve->degree;
    double p[GD_TRIM_DEGREE_MAX + 1][3];
    for (uint32_t i = 0; i <= d; i++) take_point(curve, k - d + i, p[i]);
    for (uint32_t r = 1; r <= d; r++) {
        double t = curve->knots[r <= j ? k + 1 : k];
        for (uint32_t i = d; i >= r; i--) {
            double low = curve->knots[k - d + i], high = curve->knots[k + 1 + i - r];
            double part = (t - low) / (high - low);
            for (int c = 0; c < 3; c++) p[i][c] = (1 - part) * p[i - 1][c] + part * p[i][c];
        }
    }
    memcpy(out, p[d], sizeof p[d]);
}

/* The spans and points that were added so far. Their arrays in `loops` already have the full
 * size. */
struct intake {
    struct gd__loops *loops;
    uint32_t points;
};

static double (*add_span(struct intake *intake, uint32_t degree, uint32_t curve))[3]
{
    struct gd__loops *loops = intake->loops;
    double(*points)[3] = loops->points + intake->points;
    loops->spans[loops->span_count++] = (struct gd__span){degree, curve, degree == 1, points};
    intake->points += degree + 1;
    return points;
}

static void take_curve(struct intake *intake, const struct gd_trim_curve *curve, uint32_t number)
{
    uint32_t d = curve->degree;
    if (!curve->knots && d == 1) {
        for (uint32_t i = 0; i + 1 < curve->count; i++) {
            double(*points)[3] = add_span(intake, 1, number);
            take_point(curve, i, points[0]);
            take_point(curve, i + 1, points[1]);
        }
    } else if (!curve->knots) {
        double(*points)[3] = add_span(intake, d, number);
        for (uint32_t i = 0; i <= d; i++) take_point(curve, i, points[i]);
    } else {
        for (uint32_t k = d; k < curve->count; k++) {
            if (!(curve->knots[k] < curve->knots[k + 1])) continue;
            double(*points)[3] = add_span(intake, d, number);
            for (uint32_t j = 0; j <= d; j++) blossom(curve, k, j, points[j]);
        }
    }
}

/* Returns the scaled distance of two places. */
static double apart(const struct gd__loops *loops, const double a[2], const double b[2])
{
    return hypot((a[0] - b[0]) / loops->width[0], (a[1] - b[1]) / loops->width[1]);
}

/* Returns the scaled distance of the place `at` from a segment, and sets *part to the position of
 * the nearest place on the segment, from 0 to 1. */
static double segment_gap(const struct gd__loops *loops, const double from[2], const double to[2],
                          const double at[2], double *part)
{
    double run[2], rise[2];
    for (int k = 0; k < 2; k++) {
        run[k] = (to[k] - from[k]) / loops->width[k];
        rise[k] = (at[k] - from[k]) / loops->width[k];
    }
    double square = run[0] * run[0] + run[1] * run[1], dot = run[0] * rise[0] + run[1] * rise[1];
    *part = square > 0 ? fmin(fmax(dot / square, 0), 1) : 0;
    return hypot(rise[0] - *part * run[0], rise[1] - *part * run[1]);
}

/* Returns the greatest scaled distance of a span's control points from its first one. */
static double span_extent(const struct gd__loops *loops, const struct gd__span *span)
{
    double most = 0;
    for (uint32_t i = 1; i <= span->degree; i++) {
        const double *p = span->points[0], *q = span->points[i];
        most = fmax(most, apart(loops, (double[]){p[0] / p[2], p[1] / p[2]},
                                (double[]){q[0] / q[2], q[1] / q[2]}));
    }
    return most;
}

/* Checks that each span begins where the preceding span ends, and makes the two points equal. */
static enum gd_status close_loop(struct gd__loops *loops, uint32_t number,
                                 struct gd_trim_fault *fault)
{
    const struct gd__loop *loop = &loops->loops[number];
    for (uint32_t i = 0; i < loop->span_count; i++) {
        struct gd__span *span = &loops->spans[loop->first_span + i],
                        *next = &loops->spans[loop->first_span + (i + 1) % loop->span_count];
        const double *p = span->points[span->degree];
        double *q = next->points[0], end[2] = {p[0] / p[2], p[1] / p[2]},
               begin[2] = {q[0] / q[2], q[1] / q[2]};
        if (apart(loops, end, begin) > GD_TOL_LOOP_CLOSED)
            return gd__loops_fail(fault, number, span->curve,
                                  "loop %u is not closed: curve %u ends at (%.17g, %.17g), and the "
                                  "next curve begins at (%.17g, %.17g); let them meet",
                                  number, span->curve, end[0], end[1], begin[0], begin[1]);
        for (int k = 0; k < 2; k++) q[k] = end[k] * q[2];
        if (span_extent(loops, span) <= GD_TOL_LOOP_CLOSED)
            return gd__loops_fail(fault, number, span->curve,
                                  "curve %u of loop %u has two equal neighbouring points or a part "
                                  "without length; remove it",
                                  span->curve, number);
    }
    return GD_OK;
}

static enum gd_status count_points(const struct gd_trims *trims, size_t *spans, size_t *points,
                                   struct gd_trim_fault *fault)
{
    size_t given = 0;
    if (trims->count < 1 || trims->count > GD_TRIM_LOOPS_MAX)
        return gd__loops_fail(fault, 0, 0, "a domain has 1 to %d loops, not %u", GD_TRIM_LOOPS_MAX,
                              trims->count);
    for (uint32_t i = 0; i < trims->count; i++) {
        const struct gd_trim_loop *loop = &trims->loops[i];
        if (loop->count < 1 || loop->count > GD_TRIM_CURVES_MAX)
            return gd__loops_fail(fault, i, 0, "loop %u has 1 to %d curves, not %u", i,
                                  GD_TRIM_CURVES_MAX, loop->count);
        for (uint32_t k = 0; k < loop->count; k++) {
            enum gd_status status = check_curve(&loop->curves[k], i, k, fault);
            if (status) return status;
            given += loop->curves[k].count;
            if (given > GD_TRIM_POINTS_MAX)
                return gd__loops_fail(fault, i, k, "the loops have more than %d points",
                                      GD_TRIM_POINTS_MAX);
            *spans += loop->curves[k].count;
            *points += loop->curves[k].count * ((size_t)loop->curves[k].degree + 1);
        }
    }
    return GD_OK;
}

static enum gd_status take_loops(struct gd__loops *loops, const struct gd_trims *trims,
                                 struct gd_trim_fault *fault)
{
    size_t spans = 0, points = 0;
    enum gd_status status = count_points(trims, &spans, &points, fault);
    if (status) return status;
    loops->loops = calloc(trims->count, sizeof *loops->loops);
    loops->spans = calloc(spans, sizeof *loops->spans);
    loops->points = calloc(points, sizeof *loops->points);
    if (!loops->loops || !loops->spans || !loops->points) return GD_NO_MEMORY;
    loops->bytes = sizeof *loops + trims->count * sizeof *loops->loops +
                   spans * sizeof *loops->spans + points * sizeof *loops->points;
    struct intake intake = {loops, 0};
    for (uint32_t i = 0; i < trims->count && !status; i++) {
        loops->loops[i].first_span = loops->span_count;
        for (uint32_t k = 0; k < trims->loops[i].count; k++)
            take_curve(&intake, &trims->loops[i].curves[k], k);
        loops->loops[i].span_count = loops->span_count - loops->loops[i].first_span;
        loops->count++;
        status = close_loop(loops, i, fault);
    }
    return status;
}

enum gd_status gd__loops_create(const double low[2], const double high[2],
                                const struct gd_trims *trims, struct gd__pace *pace,
                                struct gd__loops **out, struct gd_trim_fault *fault)
{
    struct gd__loops *loops = calloc(1, sizeof *loops);
    if (!loops) return GD_NO_MEMORY;
    loops->has_outer = trims->has_outer;
    for (int k = 0; k < 2; k++) loops->low[k] = low[k], loops->width[k] = high[k] - low[k];
    enum gd_status status = take_loops(loops, trims, fault);
    if (!status) status = gd__loops_check(loops, pace, fault);
    if (status)
        gd__loops_free(loops);
    else
        *out = loops;
    return status;
}

void gd__loops_free(struct gd__loops *loops)
{
    if (!loops) return;
    gd__loop_samples_free(&loops->samples);
    free(loops->loops);
    free(loops->spans);
    free(loops->points);
    free(loops);
}

/* --- places ----------------------------------------------------------------------------------- */

static const struct gd__span *span_at(const struct gd__loops *loops, uint32_t loop, double *s,
                                      bool before)
{
    uint32_t count = loops->loops[loop].span_count;
    double within = *s - floor(*s / count) * count;
    uint32_t i = (uint32_t)fmin(within, count - 1.0);
    *s = within - i;
    if (before && *s <= 0) {
        i = i ? i - 1 : count - 1;
        *s = 1;
    }
    return &loops->spans[loops->loops[loop].first_span + i];
}

void gd__loop_jet(const struct gd__loops *loops, uint32_t loop, double s, bool before,
                  struct gd__span_jet *out)
{
    const struct gd__span *span = span_at(loops, loop, &s, before);
    gd__span_jet(span, s, out);
}

uint32_t gd__loop_curve(const struct gd__loops *loops, uint32_t loop, double s)
{
    return span_at(loops, loop, &s, false)->curve;
}

/* --- samples ---------------------------------------------------------------------------------- */

void gd__loop_samples_free(struct gd__loop_samples *samples)
{
    free(samples->at);
    free(samples->s);
    free(samples->first);
    *samples = (struct gd__loop_samples){0};
}

static enum gd_status add_sample(struct gd__loop_samples *out, const double at[2], double s)
{
    if (out->count >= SAMPLES_MOST) return GD_TOO_LARGE;
    enum gd_status status =
        gd__array_extend(&out->at, &out->capacity, out->count + 1ULL, sizeof *out->at, NULL);
    if (status) return status;
    memcpy(out->at[out->count], at, sizeof *out->at);
    return gd__array_append(&out->s, &out->count, &out->s_capacity, &s, sizeof s);
}

struct sampling {
    const struct gd__loops *loops;
    const struct gd__span *span;
    double longest, base; /* base: place of the span's beginning on its loop */
    struct gd__pace *pace;
    struct gd__loop_samples *out;
};

/* Adds the samples of [low, high) of a span. Halves this interval while it bends or is too long. */
static enum gd_status sample_part(const struct sampling *by, double low, double high, int depth)
{
    struct gd__span_jet a, b;
    if (!gd__pace(by->pace, 64)) return by->pace->status;
    gd__span_jet(by->span, low, &a);
    gd__span_jet(by->span, high, &b);
    bool is_fine = depth >= (by->span->is_straight ? 0 : DEPTH_LEAST) &&
                   apart(by->loops, a.at, b.at) <= by->longest;
    for (int i = 1; i < 4 && is_fine && !by->span->is_straight; i++) {
        struct gd__span_jet c;
        double part;
        gd__span_jet(by->span, low + 0.25 * i * (high - low), &c);
        is_fine = segment_gap(by->loops, a.at, b.at, c.at, &part) <= 0.5 * GD__LOOPS_SAG;
    }
    if (is_fine || depth == DEPTH_MOST) return add_sample(by->out, a.at, by->base + low);
    double middle = 0.5 * (low + high);
    enum gd_status status = sample_part(by, low, middle, depth + 1);
    return status ? status : sample_part(by, middle, high, depth + 1);
}

enum gd_status gd__loops_sample(const struct gd__loops *loops, double longest,
                                struct gd__pace *pace, struct gd__loop_samples *out)
{
    struct gd__loop_samples samples = {.first = calloc(loops->count + 1, sizeof *samples.first)};
    enum gd_status status = samples.first ? GD_OK : GD_NO_MEMORY;
    for (uint32_t i = 0; i < loops->count && !status; i++) {
        const struct gd__loop *loop = &loops->loops[i];
        for (uint32_t k = 0; k < loop->span_count && !status; k++)
            status = sample_part(&(struct sampling){loops, &loops->spans[loop->first_span + k],
                                                    longest, k, pace, &samples},
                                 0, 1, 0);
        samples.first[i + 1] = samples.count;
    }
    if (status)
        gd__loop_samples_free(&samples);
    else
        *out = samples;
    return status;
}

/* --- depth ------------------------------------------------------------------------------------ */

bool gd__loop_surrounds(const struct gd__loops *loops, uint32_t i, const double at[2])
{
    const struct gd__loop_samples *samples = &loops->samples;
    uint32_t first = samples->first[i], count = samples->first[i + 1] - first;
    bool inside = false;
    for (uint32_t k = 0; k < count; k++) {
        const double *a = samples->at[first + k], *b = samples->at[first + (k + 1) % count];
        if ((a[1] > at[1]) == (b[1] > at[1])) continue;
        double u = a[0] + (at[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
        if (at[0] < u) inside = !inside;
    }
    return inside;
}

/* Moves the place on its span towards the place nearest to `at`, by Newton's method with bounds. */
static void approach(const struct gd__loops *loops, const double at[2],
                     struct gd__loop_place *place)
{
    double base = floor(place->s);
    if (place->s == base && place->s > 0 && place->is_corner) base = place->s - 1;
    double t = place->s - base;
    const struct gd__span *span =
        &loops->spans[loops->loops[place->loop].first_span + (uint32_t)base];
    for (int i = 0; i < PROJECTIONS; i++) {
        struct gd__span_jet c;
        double slope = 0, curve = 0, speed = 0;
        gd__span_jet(span, t, &c);
        for (int k = 0; k < 2; k++) {
            double square = loops->width[k] * loops->width[k];
            slope += (c.at[k] - at[k]) * c.first[k] / square;
            speed += c.first[k] * c.first[k] / square;
            curve += (c.at[k] - at[k]) * c.second[k] / square;
        }
        if (!(speed > 0)) break;
        double bend = speed + curve > 0.5 * speed ? speed + curve : speed;
        double next = fmin(fmax(t - slope / bend, 0), 1);
        bool is_still = fabs(next - t) < GD_TOL_LOOP_PLACE;
        t = next;
        if (is_still) break;
    }
    struct gd__span_jet c;
    gd__span_jet(span, t, &c);
    double distance = apart(loops, c.at, at);
    if (distance > place->distance) return;
    place->s = base + t;
    memcpy(place->at, c.at, sizeof c.at);
    place->distance = distance;
}

/* Finds the nearest place of the sampled polyline. */
static void nearest_sample(const struct gd__loops *loops, const double at[2],
                           struct gd__loop_place *out)
{
    const struct gd__loop_samples *samples = &loops->samples;
    double best = INFINITY;
    for (uint32_t i = 0; i < loops->count; i++) {
        uint32_t first = samples->first[i], count = samples->first[i + 1] - first;
        for (uint32_t k = 0; k < count; k++) {
            const double *a = samples->at[first + k], *b = samples->at[first + (k + 1) % count];
            double part, distance = segment_gap(loops, a, b, at, &part);
            if (distance >= best) continue;
            best = distance;
            double from = samples->s[first + k];
            double to = k + 1 < count ? samples->s[first + k + 1] : loops->loops[i].span_count;
            *out = (struct gd__loop_place){.loop = i, .s = from + part * (to - from)};
        }
    }
}

double gd__loops_depth(const struct gd__loops *loops, const double at[2],
                       struct gd__loop_place *out)
{
    struct gd__loop_place place;
    struct gd__span_jet c;
    nearest_sample(loops, at, &place);
    gd__loop_jet(loops, place.loop, place.s, false, &c);
    memcpy(place.at, c.at, sizeof c.at);
    place.distance = apart(loops, c.at, at);
    /* if two spans meet at the nearest sample, the nearest place may be on either span */
    if (place.s >= loops->loops[place.loop].span_count) place.s = 0;
    bool at_end = place.s == floor(place.s);
    approach(loops, at, &place);
    if (at_end && place.s == floor(place.s)) {
        struct gd__loop_place other = place;
        if (other.s <= 0) other.s = loops->loops[place.loop].span_count;
        other.is_corner = true;
        approach(loops, at, &other);
        if (other.distance < place.distance) place = other;
    }
    double off = fabs(place.s - round(place.s));
    place.is_corner = off < GD_TOL_LOOP_PLACE;
    bool inside = !loops->has_outer || gd__loop_surrounds(loops, 0, at);
    for (uint32_t i = loops->has_outer; i < loops->count && inside; i++)
        inside = !gd__loop_surrounds(loops, i, at);
    if (!place.is_corner && place.distance <= 2 * GD__LOOPS_SAG) {
        gd__loop_jet(loops, place.loop, place.s, false, &c);
        inside = c.first[0] * (at[1] - place.at[1]) - c.first[1] * (at[0] - place.at[0]) >= 0;
    }
    *out = place;
    return inside ? place.distance : -place.distance;
}
