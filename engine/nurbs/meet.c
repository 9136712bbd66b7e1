#include "nurbs/meet.h"

#include <math.h>

#include "base/tolerance.h"
#include "base/pace.h"

enum { PLACES_LEAST = 128, PLACES_MOST = 1024, STEPS_MOST = 100 };

/* Sampled places on a curve. */
struct places {
    uint32_t count;
    double *s;
    struct gd_vec3 *x;
};

static enum gd_status meet_sample(const struct gd_domain_curve *curve, struct gd__arena *arena,
                                  struct gd__pace *pace, struct places *out)
{
    static const struct gd__curve_places wanted = {4, PLACES_LEAST, PLACES_MOST, true};
    out->s = gd__curve_places(curve, &wanted, arena, &out->count);
    out->x = gd__arena_take(arena, out->count, sizeof *out->x);
    if (arena->status) return arena->status;
    for (uint32_t i = 0; i < out->count && gd__pace(pace, GD__STEP); i++) {
        struct gd__curve_jet jet;
        gd__curve_jet(curve, out->s[i], &jet);
        out->x[i] = gd__surface_position(curve->surface, jet.at);
    }
    return pace->status;
}

/* A place of a curve in the domain and in space, with derivatives by the parameter. */
struct view {
    struct gd__curve_jet c;
    struct gd_vec3 x, first;
};

static struct view view_of(const struct gd_domain_curve *curve, double s)
{
    struct view view;
    struct gd_jet jet;
    gd__curve_jet(curve, s, &view.c);
    gd__surface_at(curve->surface, view.c.at, &jet);
    view.x = jet.x;
    view.first = gd_vec3_along(gd_vec3_scale(jet.u, view.c.first[0]), view.c.first[1], jet.v);
    return view;
}

/* Returns true if both places are the same place of the surface. It is not enough that they are
 * equal in space, because the surface may intersect itself. */
static bool is_one_place(const struct gd_parametric *surface, const double a[2], const double b[2])
{
    for (int k = 0; k < 2; k++)
        if (gd__surface_pole(surface, k, a[k]) && gd__surface_pole(surface, k, b[k])) return true;
    for (int k = 0; k < 2; k++) {
        const struct gd_axis *axis = surface->axis[k];
        double period = gd__axis_period(axis), apart = a[k] - b[k];
        if (axis->closed) apart -= round(apart / period) * period;
        if (fabs(apart) > GD_TOL_ONE_PLACE * (axis->high - axis->low)) return false;
    }
    return true;
}

static double meet_clamp(const struct gd_domain_curve *curve, double s)
{
    return curve->closed ? s : fmin(fmax(s, curve->low), curve->high);
}

/* Returns the distance below which places count as equal in space. */
static double nearness(const struct gd_parametric *surface)
{
    return GD_TOL_COINCIDE * surface->size + GD_TOL_LOCATE * surface->farthest;
}

/* Applies the Gauss-Newton method to x(a(s)) - x(b(t)). It converges quadratically where the curves
 * cross. Returns true if the curves meet. */
static bool approach(const struct gd_domain_curve *a, const struct gd_domain_curve *b,
                     struct gd__pace *pace, double s[2])
{
    double near = nearness(a->surface);
    for (int i = 0; i < STEPS_MOST && gd__pace(pace, GD__STEP); i++) {
        struct view p = view_of(a, s[0]), q = view_of(b, s[1]);
        struct gd_vec3 r = gd_vec3_sub(p.x, q.x);
        if (gd_vec3_length(r) <= near) return is_one_place(a->surface, p.c.at, q.c.at);
        double aa = gd_vec3_dot(p.first, p.first), bb = gd_vec3_dot(q.first, q.first);
        double ab = gd_vec3_dot(p.first, q.first), ra = gd_vec3_dot(r, p.first),
               rb = gd_vec3_dot(r, q.first);
        double damp = GD_TOL_PIVOT * (aa + bb), determinant = (aa + damp) * (bb + damp) - ab * ab;
        if (!(determinant > 0)) return false;
        double ds = (ab * rb - ra * (bb + damp)) / determinant,
               dt = ((aa + damp) * rb - ab * ra) / determinant;
        double next[2] = {meet_clamp(a, s[0] + (a->is_point ? 0 : ds)),
                          meet_clamp(b, s[1] + (b->is_point ? 0 : dt))};
        if (next[0] == s[0] && next[1] == s[1]) return false;
        s[0] = next[0], s[1] = next[1];
    }
    return false;
}

static double meet_apart(const struct places *a, const struct places *b, uint32_t i, uint32_t j)
{
    return gd_vec3_distance(a->x[i], b->x[j]);
}

/* Returns true if the two places of a pair are not farther apart than those of the neighbouring
 * pairs, and so close that the curves may meet near them. */
static bool is_candidate(const struct places *a, const struct places *b, double near, uint32_t i,
                         uint32_t j)
{
    double here = meet_apart(a, b, i, j), step = 0;
    if (i) step = fmax(step, gd_vec3_distance(a->x[i], a->x[i - 1]));
    if (i + 1 < a->count) step = fmax(step, gd_vec3_distance(a->x[i], a->x[i + 1]));
    if (j) step = fmax(step, gd_vec3_distance(b->x[j], b->x[j - 1]));
    if (j + 1 < b->count) step = fmax(step, gd_vec3_distance(b->x[j], b->x[j + 1]));
    if (here > 2 * step + near) return false;
    if (i && meet_apart(a, b, i - 1, j) < here) return false;
    if (i + 1 < a->count && meet_apart(a, b, i + 1, j) < here) return false;
    if (j && meet_apart(a, b, i, j - 1) < here) return false;
    return !(j + 1 < b->count && meet_apart(a, b, i, j + 1) < here);
}

enum gd_status gd__curves_meetings(const struct gd_domain_curve *a, const struct gd_domain_curve *b,
                                   const struct gd_control *control, struct gd__meeting *out,
                                   uint32_t most, uint32_t *count)
{
    struct gd__arena arena = {.budget.control = control};
    struct places of_a, of_b;
    struct gd__pace pace = {.control = control};
    double near = nearness(a->surface);
    enum gd_status status = meet_sample(a, &arena, &pace, &of_a);
    if (!status) status = meet_sample(b, &arena, &pace, &of_b);
    uint32_t found = 0;
    for (uint32_t i = 0; i < of_a.count && !status && found < most; i++) {
        status = gd_control_check(control, 0);
        for (uint32_t j = 0; j < of_b.count && !status && found < most; j++) {
            if (!is_candidate(&of_a, &of_b, near, i, j)) continue;
            double at[2] = {of_a.s[i], of_b.s[j]};
            if (approach(a, b, &pace, at)) out[found++] = (struct gd__meeting){{at[0], at[1]}};
            status = pace.status;
        }
    }
    gd__arena_free(&arena);
    if (!status) *count = found;
    return status;
}
