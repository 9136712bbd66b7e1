#include "nurbs/classes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/tolerance.h"

enum { STEPS = 64, BISECTIONS = 60 };

/* Height of an arc over the straight line, as a fraction of the domain's width. */
static const double arc_height = 0.2;

/* --- by winding numbers ----------------------------------------------------------------------- */

static double width_of(const struct gd_axis *axis)
{
    return axis->high - axis->low;
}

/* Computes the place at the fraction t of an arc over the line from a to b. */
static void arc_place(const struct gd_parametric *surface, const double a[2], const double b[2],
                      double height, double t, double at[2])
{
    double run[2], length = 0;
    for (int k = 0; k < 2; k++) run[k] = (b[k] - a[k]) / width_of(surface->axis[k]);
    length = hypot(run[0], run[1]);
    double rise = length > 0 ? height * sin(M_PI * t) / length : 0;
    for (int k = 0; k < 2; k++) {
        const struct gd_axis *axis = surface->axis[k];
        at[k] = a[k] + t * (b[k] - a[k]) + rise * (k ? run[0] : -run[1]) * width_of(axis);
        if (!axis->closed) at[k] = fmin(fmax(at[k], axis->low), axis->high);
    }
}

enum gd_status gd__class_seed(const struct gd_domain_curve *const ends[2],
                              const struct gd__class *in, uint32_t shape, struct gd__path_seed *out)
{
    const struct gd_parametric *surface = ends[0]->surface;
    double a[2], b[2], height = shape == 0 ? 0 : shape == 1 ? arc_height : -arc_height;
    gd_domain_curve_at(ends[0], in->s[0], a);
    gd_domain_curve_at(ends[1], in->s[1], b);
    for (int k = 0; k < 2; k++) b[k] += in->turns[k] * gd__axis_period(surface->axis[k]);
    struct gd__path_seed seed = {.s = {in->s[0], in->s[1]}};
    enum gd_status status = GD_OK;
    for (int i = 0; i <= STEPS && !status; i++) {
        double at[2];
        arc_place(surface, a, b, height, (double)i / STEPS, at);
        status = gd__uv_polyline_add(&seed.polyline, at);
    }
    if (status) {
        gd__uv_polyline_free(&seed.polyline);
        return status;
    }
    gd__uv_polyline_measure(surface, &seed.polyline);
    seed.length = seed.polyline.arc[seed.polyline.count - 1];
    *out = seed;
    return GD_OK;
}

/* --- along a curve ---------------------------------------------------------------------------- */

static double distance_at(const struct gd_domain_curve *curve, double s, struct gd_vec3 x)
{
    double at[2];
    gd_domain_curve_at(curve, s, at);
    return gd_vec3_distance(gd__surface_position(curve->surface, at), x);
}

/* Returns the parameter in [low, high] nearest to x, by golden section. */
static double narrow(const struct gd_domain_curve *curve, double low, double high, struct gd_vec3 x)
{
    const double golden = 0.5 * (sqrt(5) - 1);
    for (int i = 0; i < BISECTIONS; i++) {
        double a = high - golden * (high - low), b = low + golden * (high - low);
        if (distance_at(curve, a, x) < distance_at(curve, b, x))
            high = b;
        else
            low = a;
    }
    return 0.5 * (low + high);
}

/* Finds the place of the curve `end` that is nearest to a place of the surface. Sets *s to the
 * parameter of this place, and *apart to the distance of the two places in space. */
static enum gd_status find_nearest(const struct gd_domain_curve *end, const double at[2],
                                   struct gd__pace *pace, double *s, double *apart)
{
    static const struct gd__curve_places wanted = {4, 512, 8192, true};
    struct gd_vec3 x = gd__surface_position(end->surface, at);
    struct gd__arena arena = {.budget.control = pace->control};
    uint32_t count, best = 0;
    const double *places = gd__curve_places(end, &wanted, &arena, &count);
    *apart = INFINITY;
    if (!places) return arena.status;
    for (uint32_t i = 0; i < count && gd__pace(pace, GD__STEP); i++) {
        double distance = distance_at(end, places[i], x);
        if (distance < *apart) *apart = distance, best = i;
    }
    *s = places[best];
    if (count > 1)
        *s =
            narrow(end, places[best ? best - 1 : 0], places[best + 1 < count ? best + 1 : best], x);
    gd__arena_free(&arena);
    if (distance_at(end, *s, x) < *apart) *apart = distance_at(end, *s, x);
    return pace->status;
}

static enum gd_status follow_curve(const struct gd_domain_curve *initial, struct gd__pace *pace,
                                   struct gd__uv_polyline *out)
{
    static const struct gd__curve_places wanted = {8, 2 * STEPS, 8192, true};
    struct gd__arena arena = {.budget.control = pace->control};
    uint32_t count;
    const double *places = gd__curve_places(initial, &wanted, &arena, &count);
    enum gd_status status = arena.status;
    for (uint32_t i = 0; i < count && !status && gd__pace(pace, GD__STEP); i++) {
        struct gd__curve_jet jet;
        /* gd_domain_curve_at cannot be used, because it wraps the end of a closed curve to its
           beginning */
        gd__curve_jet(initial, places[i], &jet);
        status = gd__uv_polyline_add(out, jet.at);
    }
    gd__arena_free(&arena);
    return status ? status : pace->status;
}

enum gd_status gd__initial_seed(const struct gd_domain_curve *const ends[2],
                                const struct gd_domain_curve *initial, struct gd__pace *pace,
                                struct gd__path_seed *out, struct gd_detail *detail)
{
    const struct gd_parametric *surface = ends[0]->surface;
    struct gd__path_seed seed = {0};
    if (initial->is_point)
        return gd_fail(detail, GD_INVALID_ARGUMENT, "the initial curve is a point");
    enum gd_status status = follow_curve(initial, pace, &seed.polyline);
    for (int k = 0; k < 2 && !status; k++) {
        double apart;
        status = find_nearest(ends[k], seed.polyline.at[k ? seed.polyline.count - 1 : 0], pace,
                              &seed.s[k], &apart);
        if (!status && apart > GD_TOL_INITIAL * surface->size)
            status = gd_fail(detail, GD_INVALID_ARGUMENT,
                             "the initial curve %s %g from the %s end of the path; it connects "
                             "both ends",
                             k ? "ends" : "begins", apart, k ? "second" : "first");
    }
    if (!status) status = gd__path_seed_attach(ends, &seed);
    if (status) {
        gd__uv_polyline_free(&seed.polyline);
        return status == GD_INVALID_ARGUMENT ? status : gd_fail_status(detail, status);
    }
    seed.length = seed.polyline.arc[seed.polyline.count - 1];
    *out = seed;
    return GD_OK;
}
