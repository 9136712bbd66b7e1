#include "nurbs/surface.h"

#include <math.h>
#include <stdlib.h>

#include "base/tolerance.h"
#include "nurbs/bspline.h"

enum { PROBES = 17 }; /* number of places in each direction at which a new surface is checked */

int32_t gd__axis_cell(const struct gd_axis *axis, double t)
{
    double period = gd__axis_period(axis), turns = 0;
    if (axis->closed && !axis->seam) return 0;
    if (axis->closed) turns = floor((t - axis->low) / period);
    double inside = t - turns * period;
    uint32_t line = axis->line_count ? gd__interval(axis->lines, 0, axis->line_count, inside) : 0;
    int32_t within = axis->line_count && inside >= axis->lines[line] ? (int32_t)line + 1 : 0;
    return within + (int32_t)turns * gd__axis_cells(axis);
}

/* Returns the cell's number within its period, and sets *turns to the number of this period. */
static int32_t surface_reduce(const struct gd_axis *axis, int32_t index, int32_t *turns)
{
    int32_t count = gd__axis_cells(axis), within = index % count;
    if (within < 0) within += count;
    *turns = (index - within) / count;
    return within;
}

double gd__axis_line(const struct gd_axis *axis, int32_t index, bool *is_line)
{
    *is_line = false;
    if (axis->closed) {
        if (!axis->seam) return index > 0 ? INFINITY : -INFINITY;
        int32_t turns, within = surface_reduce(axis, index, &turns);
        *is_line = true;
        return (within ? axis->lines[within - 1] : axis->low) + turns * gd__axis_period(axis);
    }
    if (index <= 0) return axis->low;
    if (index > (int32_t)axis->line_count) return axis->high;
    *is_line = true;
    return axis->lines[index - 1];
}

double gd__axis_wrap(const struct gd_axis *axis, double t)
{
    if (!axis->closed) return t;
    double period = gd__axis_period(axis), wrapped = t - floor((t - axis->low) / period) * period;
    return wrapped < axis->high ? wrapped : axis->low;
}

struct gd__cell gd__surface_cell(const struct gd_parametric *surface, double u, double v)
{
    return (struct gd__cell){
        {gd__axis_cell(surface->axis[0], u), gd__axis_cell(surface->axis[1], v)}};
}

void gd__surface_jet(const struct gd_parametric *surface, struct gd__cell cell, const double at[2],
                     struct gd_jet *out)
{
    uint32_t within[2];
    double place[2];
    for (int k = 0; k < 2; k++) {
        int32_t turns;
        within[k] = (uint32_t)surface_reduce(surface->axis[k], cell.index[k], &turns);
        place[k] = at[k] - turns * gd__axis_period(surface->axis[k]);
    }
    surface->evaluator.jet(surface->evaluator.shape, within[0], within[1], place[0], place[1], out);
}

void gd__surface_at(const struct gd_parametric *surface, const double at[2], struct gd_jet *out)
{
    gd__surface_jet(surface, gd__surface_cell(surface, at[0], at[1]), at, out);
}

struct gd_vec3 gd__surface_position(const struct gd_parametric *surface, const double at[2])
{
    struct gd_jet jet;
    gd__surface_at(surface, at, &jet);
    return jet.x;
}

bool gd__surface_pole(const struct gd_parametric *surface, int axis, double t)
{
    const struct gd_axis *a = surface->axis[axis];
    double near = GD_TOL_ON_BORDER * (a->high - a->low);
    return (a->pole_low && t <= a->low + near) || (a->pole_high && t >= a->high - near);
}

/* --- construction ----------------------------------------------------------------------------- */

static enum gd_status check_axis(const struct gd_axis *axis, const char *name,
                                 struct gd_detail *detail)
{
    if (!(isfinite(axis->low) && isfinite(axis->high) && axis->low < axis->high))
        return gd_fail(
            detail, GD_INVALID_ARGUMENT,
            "the domain in %s is not an interval: it must begin below its end, both finite", name);
    for (uint32_t i = 0; i < axis->line_count; i++) {
        double below = i ? axis->lines[i - 1] : axis->low;
        if (!(axis->lines[i] > below && axis->lines[i] < axis->high))
            return gd_fail(detail, GD_INVALID_ARGUMENT,
                           "the lines in %s do not increase within the domain", name);
    }
    if (axis->closed && axis->line_count && !axis->seam)
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "a closed direction with lines has a seam too, in %s", name);
    return GD_OK;
}

static double probe(const struct gd_axis *axis, int i)
{
    return i == PROBES - 1 ? axis->high : axis->low + (axis->high - axis->low) * i / (PROBES - 1);
}

static bool is_in_range(double x)
{
    return x <= GD_EXTENT_SURFACE && x >= 1 / GD_EXTENT_SURFACE;
}

static enum gd_status check_extent(const struct gd_parametric *surface, struct gd_detail *detail)
{
    double size = surface->size;
    if (!is_in_range(size))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the size of the surface is %g: must be %g to %g; scale the surface", size,
                       1 / GD_EXTENT_SURFACE, GD_EXTENT_SURFACE);
    for (int k = 0; k < 2; k++) {
        double width = surface->axis[k]->high - surface->axis[k]->low;
        if (!is_in_range(width) || !is_in_range(size / width))
            return gd_fail(
                detail, GD_INVALID_ARGUMENT,
                "the width of the domain in %s is %g for a surface of size %g: the width "
                "and the quotient must be %g to %g; scale the parameters",
                k ? "v" : "u", width, size, 1 / GD_EXTENT_SURFACE, GD_EXTENT_SURFACE);
    }
    return GD_OK;
}

static enum gd_status surface_measure(struct gd_parametric *surface, struct gd_detail *detail)
{
    struct gd_vec3 min = {INFINITY, INFINITY, INFINITY}, max = {-INFINITY, -INFINITY, -INFINITY};
    for (int i = 0; i < PROBES * PROBES; i++) {
        double at[2] = {probe(surface->axis[0], i / PROBES), probe(surface->axis[1], i % PROBES)};
        struct gd_vec3 x = gd__surface_position(surface, at);
        if (!(fabs(x.x) < GD_EXTENT_MAX && fabs(x.y) < GD_EXTENT_MAX && fabs(x.z) < GD_EXTENT_MAX))
            return gd_fail(detail, GD_INVALID_ARGUMENT,
                           "the surface has no usable position at u = %.17g, v = %.17g", at[0],
                           at[1]);
        min = (struct gd_vec3){fmin(min.x, x.x), fmin(min.y, x.y), fmin(min.z, x.z)};
        max = (struct gd_vec3){fmax(max.x, x.x), fmax(max.y, x.y), fmax(max.z, x.z)};
    }
    surface->size = gd_vec3_distance(min, max);
    surface->farthest = fmax(gd_vec3_length(min), gd_vec3_length(max));
    return check_extent(surface, detail);
}

/* Returns the greatest distance between corresponding points of two borders of direction k. If
 * `from_first`, returns the greatest distance of the points of a border from its first point
 * instead. */
static double border_gap(const struct gd_parametric *surface, int k, double a, double b,
                         bool from_first)
{
    double gap = 0;
    for (int i = 0; i < PROBES; i++) {
        double p[2], q[2];
        p[k] = a, q[k] = b;
        p[1 - k] = probe(surface->axis[1 - k], i);
        q[1 - k] = from_first ? surface->axis[1 - k]->low : p[1 - k];
        gap = fmax(gap, gd_vec3_distance(gd__surface_position(surface, p),
                                         gd__surface_position(surface, q)));
    }
    return gap;
}

static enum gd_status check_borders(const struct gd_parametric *surface, int k,
                                    struct gd_detail *detail)
{
    const struct gd_axis *a = surface->axis[k];
    double near = 2 * GD_TOL_CLOSED * surface->size + GD_TOL_LOCATE * surface->farthest;
    if (a->closed && border_gap(surface, k, a->low, a->high, false) > near)
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "direction %c is called closed, but its borders differ", "uv"[k]);
    if ((a->pole_low && border_gap(surface, k, a->low, a->low, true) > near) ||
        (a->pole_high && border_gap(surface, k, a->high, a->high, true) > near))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "a border in %c is declared a pole, but is not a single point", "uv"[k]);
    if (a->closed && (a->pole_low || a->pole_high))
        return gd_fail(detail, GD_INVALID_ARGUMENT, "direction %c is closed and can't have poles",
                       "uv"[k]);
    return GD_OK;
}

enum gd_status gd_parametric_create(const struct gd_evaluator *evaluator,
                                    struct gd_parametric **out, struct gd_detail *detail)
{
    struct gd_parametric *surface = calloc(1, sizeof *surface);
    if (!surface) {
        if (evaluator->destroy) evaluator->destroy(evaluator->shape);
        return gd_fail_status(detail, GD_NO_MEMORY);
    }
    surface->evaluator = *evaluator;
    surface->axis[0] = &surface->evaluator.u;
    surface->axis[1] = &surface->evaluator.v;
    surface->bytes = sizeof *surface + evaluator->bytes;
    atomic_init(&surface->references, 1);
    enum gd_status status = check_axis(surface->axis[0], "u", detail);
    if (!status) status = check_axis(surface->axis[1], "v", detail);
    if (!status) status = surface_measure(surface, detail);
    if (!status) status = check_borders(surface, 0, detail);
    if (!status) status = check_borders(surface, 1, detail);
    if (status)
        gd_parametric_release(surface);
    else
        *out = surface;
    return status;
}

struct gd_parametric *gd_parametric_retain(const struct gd_parametric *surface)
{
    gd__references_add(&surface->references);
    return (struct gd_parametric *)surface;
}

void gd_parametric_release(const struct gd_parametric *surface)
{
    if (!surface || !gd__references_drop(&surface->references)) return;
    struct gd_parametric *shared = (struct gd_parametric *)surface;
    if (shared->evaluator.destroy) shared->evaluator.destroy(shared->evaluator.shape);
    gd__loops_free(shared->loops);
    gd_parametric_release(shared->base);
    free(shared);
}

size_t gd_parametric_memsize(const struct gd_parametric *surface)
{
    return surface->bytes;
}

const struct gd_axis *gd_parametric_axis_u(const struct gd_parametric *surface)
{
    return surface->axis[0];
}

const struct gd_axis *gd_parametric_axis_v(const struct gd_parametric *surface)
{
    return surface->axis[1];
}

double gd_parametric_size(const struct gd_parametric *surface)
{
    return surface->size;
}

/* --- trimmed surfaces ------------------------------------------------------------------------- */

/* Creates a surface with the evaluator of `surface`. If there is an outer loop, no direction is
 * closed, because the domain ends at this loop. */
static enum gd_status share_evaluator(const struct gd_parametric *surface, bool has_outer,
                                      struct gd_parametric **out, struct gd_detail *detail)
{
    struct gd_evaluator evaluator = surface->evaluator;
    evaluator.destroy = NULL;
    evaluator.bytes = surface->bytes;
    if (has_outer) {
        evaluator.u.closed = evaluator.u.seam = false;
        evaluator.v.closed = evaluator.v.seam = false;
    }
    enum gd_status status = gd_parametric_create(&evaluator, out, detail);
    if (!status) (*out)->base = gd_parametric_retain(surface);
    return status;
}

enum gd_status gd_parametric_trim(const struct gd_parametric *surface, const struct gd_trims *trims,
                                  const struct gd_control *control, struct gd_parametric **out,
                                  struct gd_trim_fault *fault)
{
    struct gd_trim_fault unused;
    if (!fault) fault = &unused;
    *fault = (struct gd_trim_fault){0};
    if (surface->loops) return gd__loops_fail(fault, 0, 0, "the surface is trimmed already");
    const double low[2] = {surface->axis[0]->low, surface->axis[1]->low},
                 high[2] = {surface->axis[0]->high, surface->axis[1]->high};
    struct gd__pace pace = {.control = control};
    struct gd__loops *loops;
    struct gd_parametric *trimmed;
    enum gd_status status = gd__loops_create(low, high, trims, &pace, &loops, fault);
    if (!status) {
        status = share_evaluator(surface, trims->has_outer, &trimmed, &fault->detail);
        if (status) gd__loops_free(loops);
    }
    if (status) return fault->detail.text[0] ? status : gd_fail_status(&fault->detail, status);
    trimmed->loops = loops;
    trimmed->bytes += loops->bytes;
    *out = trimmed;
    return GD_OK;
}

uint32_t gd_parametric_loops(const struct gd_parametric *surface, bool *has_outer)
{
    *has_outer = surface->loops && surface->loops->has_outer;
    return surface->loops ? surface->loops->count : 0;
}

static bool axis_contains(const struct gd_axis *axis, double t)
{
    return isfinite(t) && (axis->closed || (t >= axis->low && t <= axis->high));
}

static bool is_in_rectangle(const struct gd_parametric *surface, double u, double v)
{
    return axis_contains(surface->axis[0], u) && axis_contains(surface->axis[1], v);
}

bool gd_parametric_contains(const struct gd_parametric *surface, double u, double v)
{
    struct gd__loop_place place;
    if (!is_in_rectangle(surface, u, v)) return false;
    return !surface->loops ||
           gd__surface_depth(surface, (double[]){u, v}, &place) >= -GD_TOL_TRIMMED;
}

double gd__surface_depth(const struct gd_parametric *surface, const double at[2],
                         struct gd__loop_place *out)
{
    const double place[2] = {gd__axis_wrap(surface->axis[0], at[0]),
                             gd__axis_wrap(surface->axis[1], at[1])};
    return gd__loops_depth(surface->loops, place, out);
}

enum gd_status gd_parametric_evaluate(const struct gd_parametric *surface, double u, double v,
                                      struct gd_jet *out)
{
    if (!is_in_rectangle(surface, u, v)) return GD_INVALID_ARGUMENT;
    double at[2] = {gd__axis_wrap(surface->axis[0], u), gd__axis_wrap(surface->axis[1], v)};
    gd__surface_at(surface, at, out);
    /* along a pole the surface is constant: rounding must not give a direction to its derivative */
    if (gd__surface_pole(surface, 0, at[0])) out->v = out->vv = (struct gd_vec3){0, 0, 0};
    if (gd__surface_pole(surface, 1, at[1])) out->u = out->uu = (struct gd_vec3){0, 0, 0};
    return GD_OK;
}

struct gd_curvature gd_jet_curvature(const struct gd_jet *jet)
{
    struct gd_vec3 normal = gd_vec3_cross(jet->u, jet->v);
    double area = gd_vec3_length(normal), e = gd_vec3_dot(jet->u, jet->u),
           f = gd_vec3_dot(jet->u, jet->v);
    double g = gd_vec3_dot(jet->v, jet->v);
    if (!(area > GD_TOL_REGULAR * (e + g))) return (struct gd_curvature){0};
    normal = gd_vec3_scale(normal, 1 / area);
    double l = gd_vec3_dot(jet->uu, normal), m = gd_vec3_dot(jet->uv, normal),
           n = gd_vec3_dot(jet->vv, normal);
    double square = area * area;
    return (struct gd_curvature){
        .normal = normal,
        .gaussian = (l * n - m * m) / square,
        .mean = (e * n - 2 * f * m + g * l) / (2 * square),
        .regular = true,
    };
}
