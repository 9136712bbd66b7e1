/* Tests whether a geodesic stays in a trimmed domain. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/tolerance.h"
#include "nurbs/taut.h"

enum { PARTS = 4 }; /* number of samples of a span */

/* A sample of the chain: its piece, span and parameter. */
struct sample {
    uint32_t piece, span;
    double t, at[2];
};

struct check {
    const struct gd__chain *chain;
    struct sample *samples;
    uint32_t count;
    double worst; /* smallest depth so far */
    struct sample worst_sample;
    uint32_t worst_index;
    struct gd__loop_place place;
};

static void sample_at(const struct check *check, struct sample *sample)
{
    const struct gd__piece *piece = &check->chain->pieces[sample->piece];
    struct gd__curve_jet c;
    gd__piece_at(check->chain, piece, sample->span, sample->t, &c);
    memcpy(sample->at, c.at, sizeof c.at);
}

static enum gd_status list_samples(struct check *check)
{
    const struct gd__chain *chain = check->chain;
    size_t most = PARTS * (size_t)gd__chain_spans(chain) + 1;
    check->samples = malloc(most * sizeof *check->samples);
    if (!check->samples) return GD_NO_MEMORY;
    for (uint32_t i = 0; i < chain->piece_count; i++) {
        const struct gd__piece *piece = &chain->pieces[i];
        for (uint32_t span = 0; span < piece->spans; span++) {
            const double *knot = piece->knots + chain->degree + span;
            bool is_last = i + 1 == chain->piece_count && span + 1 == piece->spans;
            for (int k = 0; k < PARTS + is_last && gd__pace(chain->pace, GD__STEP / 8); k++) {
                struct sample *sample = &check->samples[check->count++];
                *sample = (struct sample){i, span, knot[0] + (knot[1] - knot[0]) * k / PARTS, {0}};
                sample_at(check, sample);
            }
        }
    }
    return chain->pace->status;
}

static void probe(struct check *check, const struct sample *sample, uint32_t index)
{
    struct gd__loop_place place;
    double depth = gd__surface_depth(check->chain->surface, sample->at, &place);
    if (depth >= check->worst) return;
    check->worst = depth;
    check->worst_sample = *sample;
    check->worst_index = index;
    check->place = place;
}

/* Returns the fraction of the segment (a, b) at which it crosses (p, q), or -1 if it does not. */
static double crossing_of(const double a[2], const double b[2], const double p[2],
                          const double q[2])
{
    double u[2] = {b[0] - a[0], b[1] - a[1]}, v[2] = {q[0] - p[0], q[1] - p[1]},
           w[2] = {p[0] - a[0], p[1] - a[1]};
    double area = u[0] * v[1] - u[1] * v[0];
    if (area == 0) return -1;
    double t = (w[0] * v[1] - w[1] * v[0]) / area, s = (w[0] * u[1] - w[1] * u[0]) / area;
    return t >= 0 && t <= 1 && s >= 0 && s <= 1 ? t : -1;
}

static int by_number(const void *x, const void *y)
{
    const double *p = x, *q = y;
    return *p < *q ? -1 : *p > *q;
}

/* Tests the chord between two samples at the middles between its crossings with loops. So a hole
 * that is narrower than the chord is found. */
static enum gd_status probe_chord(struct check *check, uint32_t index)
{
    enum { CROSSINGS_MOST = 64 };
    const struct gd_parametric *surface = check->chain->surface;
    const struct gd__loop_samples *samples = &surface->loops->samples;
    const struct sample *from = &check->samples[index], *to = from + 1;
    double crossings[CROSSINGS_MOST + 2] = {0, 1}, a[2], b[2];
    uint32_t count = 2;
    for (int k = 0; k < 2; k++) {
        a[k] = gd__axis_wrap(surface->axis[k], from->at[k]);
        b[k] = a[k] + to->at[k] - from->at[k];
    }
    for (uint32_t i = 0; i < surface->loops->count; i++) {
        uint32_t first = samples->first[i], n = samples->first[i + 1] - first;
        for (uint32_t k = 0; k < n && count < CROSSINGS_MOST; k++) {
            double t = crossing_of(a, b, samples->at[first + k], samples->at[first + (k + 1) % n]);
            if (t >= 0) crossings[count++] = t;
        }
        if (!gd__pace(check->chain->pace, n)) return check->chain->pace->status;
    }
    if (count == 2) return GD_OK;
    qsort(crossings, count, sizeof *crossings, by_number);
    bool is_same_piece = from->piece == to->piece;
    double end = is_same_piece ? to->t : 1;
    for (uint32_t i = 0; i + 1 < count; i++) {
        struct sample middle = *from;
        middle.t += 0.5 * (crossings[i] + crossings[i + 1]) * (end - from->t);
        sample_at(check, &middle);
        probe(check, &middle, index);
    }
    return GD_OK;
}

static enum gd_status leaving_of(const struct check *check, struct gd__leaving *out)
{
    const struct gd__chain *chain = check->chain;
    const struct sample *worst = &check->worst_sample;
    const struct gd__piece *piece = &chain->pieces[worst->piece];
    struct gd__curve_jet c;
    struct gd_jet x;
    gd__piece_at(chain, piece, worst->span, worst->t, &c);
    gd__piece_jet(chain, piece, c.at, &x);
    struct gd__leaving leaving = {.place = check->place,
                                  .at = {c.at[0], c.at[1]},
                                  .velocity = gd__velocity(&x, c.first),
                                  .sample = check->worst_index};
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < check->count && !status; i++)
        status = gd__uv_polyline_add(&leaving.samples, check->samples[i].at);
    if (status)
        gd__uv_polyline_free(&leaving.samples);
    else
        *out = leaving;
    return status;
}

enum gd_status gd__gap_check(const struct gd__chain *chain, bool *inside, struct gd__leaving *out)
{
    struct check check = {.chain = chain, .worst = INFINITY};
    enum gd_status status = list_samples(&check);
    uint64_t cost = chain->surface->loops->samples.count / 4 + 1;
    for (uint32_t i = 0; i < check.count && !status; i++) {
        probe(&check, &check.samples[i], i);
        if (i + 1 < check.count) status = probe_chord(&check, i);
        if (!status) status = gd__pace_step(chain->pace, cost);
    }
    *inside = check.worst >= -GD_TOL_LEAVES;
    if (!status && !*inside) status = leaving_of(&check, out);
    free(check.samples);
    return status;
}
