/* Checks of trimming loops, on their sampled polylines. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/tolerance.h"
#include "loops/lattice.h"
#include "loops/loops.h"

/* Largest scaled distance between neighbouring samples of a loop. */
static const double longest = 0.02;

struct segment {
    struct gd__site a, b;
    int64_t low, high;            /* range of x */
    uint32_t loop, sample, count; /* begins at number `sample` of the loop's `count` samples */
};

static int by_low(const void *x, const void *y)
{
    const struct segment *p = x, *q = y;
    return p->low < q->low ? -1 : p->low > q->low;
}

/* Returns true if two closed segments have a point in common. */
static bool segments_touch(const struct segment *p, const struct segment *q)
{
    if (fmax(p->a.v, p->b.v) < fmin(q->a.v, q->b.v) || fmax(q->a.v, q->b.v) < fmin(p->a.v, p->b.v))
        return false;
    int a = gd__site_turn(p->a, p->b, q->a), b = gd__site_turn(p->a, p->b, q->b);
    int c = gd__site_turn(q->a, q->b, p->a), d = gd__site_turn(q->a, q->b, p->b);
    return a * b <= 0 && c * d <= 0 && (a || b || (p->high >= q->low && q->high >= p->low));
}

/* Returns true if the next segment of the loop folds back onto this one. */
static bool folds_back(const struct segment *p, const struct segment *next)
{
    if (gd__site_turn(p->a, p->b, next->b)) return false;
    __int128 dot = (__int128)(p->b.u - p->a.u) * (next->b.u - next->a.u) +
                   (__int128)(p->b.v - p->a.v) * (next->b.v - next->a.v);
    return dot < 0;
}

static bool is_conflict(const struct segment *p, const struct segment *q)
{
    if (p->loop == q->loop) {
        if ((p->sample + 1) % p->count == q->sample) return folds_back(p, q);
        if ((q->sample + 1) % q->count == p->sample) return folds_back(q, p);
    }
    return segments_touch(p, q);
}

static enum gd_status refuse_conflict(const struct gd__loops *loops, const struct segment *p,
                                      const struct segment *q, struct gd_trim_fault *fault)
{
    const struct gd__loop_samples *samples = &loops->samples;
    if (p->loop < q->loop || (p->loop == q->loop && p->sample < q->sample)) {
        const struct segment *swap = p;
        p = q, q = swap;
    }
    uint32_t i = samples->first[p->loop] + p->sample, k = samples->first[q->loop] + q->sample;
    uint32_t curve = gd__loop_curve(loops, p->loop, samples->s[i]),
             other = gd__loop_curve(loops, q->loop, samples->s[k]);
    const double *at = samples->at[i];
    if (p->loop == q->loop)
        return gd__loops_fail(fault, p->loop, curve,
                              "loop %u crosses or touches itself near (%.6g, %.6g): curves %u and "
                              "%u; move them apart",
                              p->loop, at[0], at[1], other, curve);
    return gd__loops_fail(fault, p->loop, curve,
                          "curve %u of loop %u crosses or touches curve %u of loop %u near (%.6g, "
                          "%.6g); move the loops apart",
                          curve, p->loop, other, q->loop, at[0], at[1]);
}

/* Compares each segment with all segments whose ranges of x overlap its own. */
static enum gd_status check_segments(const struct gd__loops *loops, const struct segment *segments,
                                     struct gd__pace *pace, struct gd_trim_fault *fault)
{
    uint32_t count = loops->samples.count;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = i + 1; k < count && segments[k].low <= segments[i].high; k++) {
            if (!gd__pace(pace, 1)) return pace->status;
            if (is_conflict(&segments[i], &segments[k]))
                return refuse_conflict(loops, &segments[i], &segments[k], fault);
        }
    return GD_OK;
}

static enum gd_status check_crossings(const struct gd__loops *loops, struct gd__pace *pace,
                                      struct gd_trim_fault *fault)
{
    const struct gd__loop_samples *samples = &loops->samples;
    struct gd__lattice lattice;
    for (int k = 0; k < 2; k++) {
        lattice.low[k] = loops->low[k];
        lattice.scale[k] = (double)GD__LATTICE_EXTENT / loops->width[k];
    }
    struct segment *segments = malloc((samples->count + (size_t)1) * sizeof *segments);
    if (!segments) return GD_NO_MEMORY;
    for (uint32_t i = 0; i < loops->count; i++) {
        uint32_t first = samples->first[i], count = samples->first[i + 1] - first;
        for (uint32_t k = 0; k < count; k++) {
            struct segment s = {.loop = i, .sample = k, .count = count};
            s.a = gd__lattice_round(&lattice, samples->at[first + k]);
            s.b = gd__lattice_round(&lattice, samples->at[first + (k + 1) % count]);
            s.low = s.a.u < s.b.u ? s.a.u : s.b.u;
            s.high = s.a.u < s.b.u ? s.b.u : s.a.u;
            segments[first + k] = s;
        }
    }
    qsort(segments, samples->count, sizeof *segments, by_low);
    enum gd_status status = check_segments(loops, segments, pace, fault);
    free(segments);
    return status;
}

/* Checks that loop i lies in the rectangle. A hole without an outer loop must not touch the border
 * of the rectangle. */
static enum gd_status check_rectangle(const struct gd__loops *loops, uint32_t i,
                                      struct gd_trim_fault *fault)
{
    const struct gd__loop_samples *samples = &loops->samples;
    double margin = loops->has_outer ? -GD_TOL_LOOP_CLOSED : GD__LOOPS_SAG;
    for (uint32_t k = samples->first[i]; k < samples->first[i + 1]; k++) {
        const double *at = samples->at[k];
        for (int c = 0; c < 2; c++) {
            double part = (at[c] - loops->low[c]) / loops->width[c];
            if (part >= margin && part <= 1 - margin) continue;
            return gd__loops_fail(fault, i, gd__loop_curve(loops, i, samples->s[k]),
                                  "loop %u leaves the domain at (%.17g, %.17g)%s", i, at[0], at[1],
                                  loops->has_outer
                                      ? ""
                                      : ", or touches its border; a hole without an outer loop "
                                        "lies inside");
        }
    }
    return GD_OK;
}

/* Returns twice the scaled area inside the polyline of a loop; negative if it runs clockwise. */
static double loop_area(const struct gd__loops *loops, uint32_t i)
{
    const struct gd__loop_samples *samples = &loops->samples;
    uint32_t first = samples->first[i], count = samples->first[i + 1] - first;
    const double *o = samples->at[first];
    double area = 0;
    for (uint32_t k = 1; k + 1 < count; k++) {
        const double *a = samples->at[first + k], *b = samples->at[first + k + 1];
        area += (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
    }
    return area / (loops->width[0] * loops->width[1]);
}

static enum gd_status check_nesting(const struct gd__loops *loops, struct gd__pace *pace,
                                    struct gd_trim_fault *fault)
{
    const struct gd__loop_samples *samples = &loops->samples;
    for (uint32_t i = 0; i < loops->count; i++) {
        if (fabs(loop_area(loops, i)) <= GD__LOOPS_SAG * GD__LOOPS_SAG)
            return gd__loops_fail(fault, i, 0, "loop %u encloses no area; remove it", i);
        for (uint32_t k = 0; k < loops->count; k++) {
            if (!gd__pace(pace, samples->count)) return pace->status;
            bool is_hole = i >= loops->has_outer, is_outer = loops->has_outer && k == 0;
            if (i == k || !is_hole) continue;
            bool inside = gd__loop_surrounds(loops, k, samples->at[samples->first[i]]);
            if (is_outer && !inside)
                return gd__loops_fail(fault, i, 0, "hole %u lies outside the outer loop; remove it",
                                      i);
            if (!is_outer && inside)
                return gd__loops_fail(fault, i, 0, "hole %u lies inside hole %u; remove it", i, k);
        }
    }
    return GD_OK;
}

static void reverse_loop(struct gd__loops *loops, const struct gd__loop *loop)
{
    struct gd__span *spans = loops->spans + loop->first_span;
    for (uint32_t i = 0; i < loop->span_count / 2; i++) {
        struct gd__span swap = spans[i];
        spans[i] = spans[loop->span_count - 1 - i];
        spans[loop->span_count - 1 - i] = swap;
    }
    for (uint32_t i = 0; i < loop->span_count; i++) {
        double(*points)[3] = spans[i].points, swap[3];
        for (uint32_t k = 0; 2 * k < spans[i].degree; k++) {
            memcpy(swap, points[k], sizeof swap);
            memcpy(points[k], points[spans[i].degree - k], sizeof swap);
            memcpy(points[spans[i].degree - k], swap, sizeof swap);
        }
    }
}

enum gd_status gd__loops_check(struct gd__loops *loops, struct gd__pace *pace,
                               struct gd_trim_fault *fault)
{
    enum gd_status status = gd__loops_sample(loops, longest, pace, &loops->samples);
    if (status == GD_TOO_LARGE)
        return gd__loops_fail(fault, 0, 0, "the loops are too detailed: simplify them");
    for (uint32_t i = 0; i < loops->count && !status; i++)
        status = check_rectangle(loops, i, fault);
    if (!status) status = check_crossings(loops, pace, fault);
    if (!status) status = check_nesting(loops, pace, fault);
    if (status) return status;
    for (uint32_t i = 0; i < loops->count; i++)
        if ((loop_area(loops, i) > 0) != (loops->has_outer && i == 0))
            reverse_loop(loops, &loops->loops[i]);
    gd__loop_samples_free(&loops->samples);
    status = gd__loops_sample(loops, longest, pace, &loops->samples);
    if (!status) loops->bytes += loops->samples.count * 3 * sizeof(double);
    return status;
}
