/* Fits a chain to a polyline: finds the cells through which the polyline passes, and makes one
 * piece in each cell. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/tolerance.h"
#include "nurbs/uv_polyline.h"

enum { CUTS_MOST = 65536 };

/* A place where the polyline enters another cell. */
struct cut {
    double position;    /* position on the polyline */
    int axis;           /* direction of the line that the polyline crosses here */
    double line, along; /* coordinate of the line, and the other coordinate of the place */
    struct gd__cell next;
};

struct cuts {
    uint32_t count, capacity;
    struct cut *cut;
};

static enum gd_status add_cut(struct cuts *cuts, const struct cut *cut)
{
    if (cuts->count == CUTS_MOST) return GD_INTERNAL;
    return gd__array_append(&cuts->cut, &cuts->count, &cuts->capacity, cut, sizeof *cut);
}

/* --- cells ------------------------------------------------------------------------------------ */

/* The lines around a cell in one direction. Borders of the domain do not count, because no path
 * crosses them. */
struct slab {
    double low, high, slack;
};

static struct slab slab_of(const struct gd_parametric *surface, struct gd__cell cell, int k)
{
    const struct gd_axis *axis = surface->axis[k];
    bool low_is_line, high_is_line;
    double low = gd__axis_line(axis, cell.index[k], &low_is_line);
    double high = gd__axis_line(axis, cell.index[k] + 1, &high_is_line);
    double slack = isfinite(high - low) ? GD_TOL_CELL * (high - low) : 0;
    return (struct slab){low_is_line ? low : -INFINITY, high_is_line ? high : INFINITY, slack};
}

static bool is_inside(const struct gd_parametric *surface, struct gd__cell cell, const double at[2])
{
    for (int k = 0; k < 2; k++) {
        struct slab slab = slab_of(surface, cell, k);
        if (at[k] < slab.low - slab.slack || at[k] > slab.high + slab.slack) return false;
    }
    return true;
}

/* Returns the first place from `from` on that is outside the cell, or polyline->count if there is
 * none. */
static uint32_t first_outside(const struct gd_parametric *surface,
                              const struct gd__uv_polyline *polyline, struct gd__cell cell,
                              uint32_t from)
{
    while (from < polyline->count && is_inside(surface, cell, polyline->at[from])) from++;
    return from;
}

static bool exists(const struct gd_axis *axis, int32_t index)
{
    if (axis->closed) return axis->seam || index == 0;
    return index >= 0 && index <= (int32_t)axis->line_count;
}

/* Returns the cell, among those around the first place, in which the polyline stays longest. */
static struct gd__cell first_cell(const struct gd_parametric *surface,
                                  const struct gd__uv_polyline *polyline)
{
    struct gd__cell base = gd__surface_cell(surface, polyline->at[0][0], polyline->at[0][1]),
                    best = base;
    uint32_t longest = 0;
    for (int i = 0; i < 9; i++) {
        /* the cell of the place itself comes first */
        static const int32_t offsets[] = {0, -1, 1};
        struct gd__cell cell = {{base.index[0] + offsets[i / 3], base.index[1] + offsets[i % 3]}};
        if (!exists(surface->axis[0], cell.index[0]) || !exists(surface->axis[1], cell.index[1]))
            continue;
        uint32_t stay = first_outside(surface, polyline, cell, 0);
        if (stay > longest) longest = stay, best = cell;
    }
    return best;
}

/* --- crossings -------------------------------------------------------------------------------- */

/* Returns the fraction of the segment from a to b at which it leaves the slab, and sets *side.
 * Returns INFINITY if the segment stays inside. */
static double leaves(const struct slab *slab, double a, double b, int *side)
{
    double line = b > slab->high + slab->slack  ? slab->high
                  : b < slab->low - slab->slack ? slab->low
                                                : NAN;
    if (isnan(line)) return INFINITY;
    *side = line == slab->high ? 1 : -1;
    return a == b ? 0 : fmin(fmax((line - a) / (b - a), 0), 1);
}

/* Returns the cut on the segment that ends at place i, the first place outside `cell`. */
static struct cut find_cut(const struct gd_parametric *surface,
                           const struct gd__uv_polyline *polyline, struct gd__cell cell, uint32_t i)
{
    const double *a = polyline->at[i - 1], *b = polyline->at[i];
    double part[2];
    int side[2] = {0, 0};
    struct slab slab[2];
    for (int k = 0; k < 2; k++) {
        slab[k] = slab_of(surface, cell, k);
        part[k] = leaves(&slab[k], a[k], b[k], &side[k]);
    }
    int k = part[0] <= part[1] ? 0 : 1;
    struct cut cut = {.position = i - 1 + part[k], .axis = k, .next = cell};
    cut.line = side[k] > 0 ? slab[k].high : slab[k].low;
    cut.along = a[1 - k] + part[k] * (b[1 - k] - a[1 - k]);
    cut.next.index[k] += side[k];
    for (int s = -1; s <= 1; s += 2) {
        /* near a corner of four cells, the path continues directly in the opposite cell */
        double line = s > 0 ? slab[1 - k].high : slab[1 - k].low;
        uint32_t ahead = i + 2 < polyline->count ? i + 2 : polyline->count - 1;
        if (fabs(cut.along - line) <= slab[1 - k].slack &&
            s * (polyline->at[ahead][1 - k] - line) > slab[1 - k].slack)
            cut.next.index[1 - k] += s;
    }
    return cut;
}

static enum gd_status find_cuts(const struct gd_parametric *surface,
                                const struct gd__uv_polyline *polyline, struct gd__cell *cell,
                                struct cuts *out)
{
    *cell = first_cell(surface, polyline);
    struct gd__cell now = *cell;
    enum gd_status status = GD_OK;
    uint32_t i = first_outside(surface, polyline, now, 1);
    while (i < polyline->count && !status) {
        struct cut cut = find_cut(surface, polyline, now, i);
        now = cut.next;
        status = add_cut(out, &cut);
        i = first_outside(surface, polyline, now, i);
    }
    return status;
}

/* --- pieces ----------------------------------------------------------------------------------- */

/* Returns the arc length at a position of the polyline. */
static double run_at(const struct gd__uv_polyline *polyline, double position)
{
    uint32_t i = position < polyline->count - 1 ? (uint32_t)position : polyline->count - 2;
    return polyline->arc[i] + (position - i) * (polyline->arc[i + 1] - polyline->arc[i]);
}

/* Sets the control points to the polyline's places at the Greville abscissae. So straight parts of
 * the polyline stay straight. */
static void fit_fill(const struct gd__chain *chain, struct gd__piece *piece,
                     const struct gd__uv_polyline *polyline, double from, double to)
{
    uint32_t first = (uint32_t)from < polyline->count - 1 ? (uint32_t)from : polyline->count - 2;
    double run[2] = {run_at(polyline, from), run_at(polyline, to)};
    for (uint32_t i = 0; i < gd__piece_points(chain, piece); i++) {
        double t = 0;
        for (uint32_t k = 1; k <= chain->degree; k++) t += piece->knots[i + k] / chain->degree;
        double position = gd__uv_polyline_position(polyline, run[0] + t * (run[1] - run[0]), first);
        gd__uv_polyline_at(polyline, fmin(fmax(position, from), to), piece->points[i]);
    }
}

static uint32_t *share_spans(const struct gd__uv_polyline *polyline, const struct cuts *cuts,
                             uint32_t total)
{
    uint32_t *spans = malloc((cuts->count + 1) * sizeof *spans);
    if (!spans) return NULL;
    double all = polyline->arc[polyline->count - 1], before = 0;
    for (uint32_t i = 0; i <= cuts->count; i++) {
        double run = i < cuts->count ? run_at(polyline, cuts->cut[i].position) : all;
        double share = all > 0 ? ceil(total * (run - before) / all - 0.25) : 1;
        spans[i] = share > 1 ? (uint32_t)share : 1;
        before = run;
    }
    return spans;
}

/* Returns a joint that slides on the line of a cut. */
static struct gd__joint fit_joint_of(const struct gd_parametric *surface, const struct cut *cut)
{
    double at[2];
    at[cut->axis] = cut->line;
    at[1 - cut->axis] = cut->along;
    return gd__joint_on_line(surface, cut->axis, at);
}

static struct gd__chain *assemble(const struct gd_parametric *surface,
                                  const struct gd__uv_polyline *polyline, const struct gd__fit *fit,
                                  struct gd__pace *pace, struct gd__cell cell,
                                  const struct cuts *cuts, const uint32_t *spans)
{
    struct gd__chain *chain = gd__chain_create(surface, pace, fit->degree, cuts->count + 1, spans);
    if (!chain) return NULL;
    double from = 0;
    chain->joints[0] = fit->from;
    for (uint32_t i = 0; i <= cuts->count; i++) {
        bool last = i == cuts->count;
        double to = last ? polyline->count - 1 : cuts->cut[i].position;
        chain->pieces[i].cell = cell;
        chain->pieces[i].whole = fit->whole;
        fit_fill(chain, &chain->pieces[i], polyline, from, to);
        chain->joints[i + 1] = last ? fit->to : fit_joint_of(surface, &cuts->cut[i]);
        if (!last) cell = cuts->cut[i].next;
        from = to;
    }
    gd__chain_prepare(chain);
    gd__chain_attach(chain);
    return chain;
}

enum gd_status gd__chain_fit(const struct gd_parametric *surface,
                             const struct gd__uv_polyline *polyline, const struct gd__fit *fit,
                             struct gd__pace *pace, struct gd__chain **out)
{
    struct cuts cuts = {0};
    struct gd__cell cell = gd__surface_cell(surface, polyline->at[0][0], polyline->at[0][1]);
    enum gd_status status = fit->whole ? GD_OK : find_cuts(surface, polyline, &cell, &cuts);
    uint32_t *spans = status ? NULL : share_spans(polyline, &cuts, fit->spans);
    if (!status && !spans) status = GD_NO_MEMORY;
    if (!status)
        status =
            gd_control_afford(pace->control, gd__chain_bytes(fit->degree, cuts.count + 1, spans));
    if (!status) {
        struct gd__chain *chain = assemble(surface, polyline, fit, pace, cell, &cuts, spans);
        if (chain)
            *out = chain;
        else
            status = GD_NO_MEMORY;
    }
    free(cuts.cut);
    free(spans);
    return status;
}

bool gd__chain_is_proper(const struct gd__chain *chain)
{
    for (uint32_t i = 0; i < chain->piece_count; i++) {
        const struct gd__piece *piece = &chain->pieces[i];
        if (piece->whole) continue;
        for (uint32_t span = 0; span < piece->spans && gd__pace(chain->pace, GD__STEP); span++) {
            const double *knot = piece->knots + chain->degree + span;
            for (int k = 0; k <= 4; k++) {
                struct gd__curve_jet c;
                gd__piece_at(chain, piece, span, knot[0] + (knot[1] - knot[0]) * k / 4, &c);
                if (!is_inside(chain->surface, piece->cell, c.at)) return false;
            }
        }
    }
    return true;
}
