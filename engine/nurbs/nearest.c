#include <math.h>
#include <stdlib.h>

#include "base/tolerance.h"
#include "nurbs/grid.h"

/* LOOK: number of nodes between two checks of the control. SECTIONS and POLISH: numbers of steps of
 * golden section and of Newton's method in the search for the nearest place of a loop. */
enum {
    GRID_FACES = 2048,
    STEPS_MOST = 60,
    TURNS_MOST = 1000,
    LOOK = 512,
    SECTIONS = 40,
    POLISH = 4
};

/* Half of the squared distance, with gradient and Hessian in (u, v). */
struct target {
    double value, gradient[2], hessian[3];
};

static struct target half_square_at(const struct gd_parametric *surface, struct gd_vec3 xyz,
                                    const double at[2])
{
    struct gd_jet jet;
    gd__surface_at(surface, at, &jet);
    struct gd_vec3 r = gd_vec3_sub(jet.x, xyz);
    return (struct target){
        0.5 * gd_vec3_dot(r, r),
        {gd_vec3_dot(r, jet.u), gd_vec3_dot(r, jet.v)},
        {gd_vec3_dot(jet.u, jet.u) + gd_vec3_dot(r, jet.uu),
         gd_vec3_dot(jet.u, jet.v) + gd_vec3_dot(r, jet.uv),
         gd_vec3_dot(jet.v, jet.v) + gd_vec3_dot(r, jet.vv)},
    };
}

/* Returns true if the coordinate is on its border and the descent direction points out of the
 * domain. */
static bool nurbs_nearest_is_held(const struct gd_axis *axis, double t, double gradient)
{
    return !axis->closed &&
           ((t <= axis->low && gradient >= 0) || (t >= axis->high && gradient <= 0));
}

/* Computes Newton's step in the free coordinates, or the step of steepest descent if the Hessian is
 * not positive definite. */
static void nurbs_nearest_step_of(const struct target *t, const bool held[2], double step[2])
{
    const double *h = t->hessian, *g = t->gradient;
    double determinant = h[0] * h[2] - h[1] * h[1];
    step[0] = step[1] = 0;
    if (!held[0] && !held[1] && h[0] > 0 && determinant > GD_TOL_REGULAR * h[0] * h[2]) {
        step[0] = (h[1] * g[1] - h[2] * g[0]) / determinant;
        step[1] = (h[1] * g[0] - h[0] * g[1]) / determinant;
        return;
    }
    for (int k = 0; k < 2; k++) {
        double curve = fabs(h[2 * k]);
        if (!held[k] && curve > 0) step[k] = -g[k] / curve;
    }
}

/* Returns the fraction of the step that is tried first: 1, or less if the step winds many times
 * around a closed axis. Returns 0 if the step is not finite, as for points very far away. */
static double first_length(const struct gd_axis *const axis[2], const double step[2])
{
    double length = 1;
    if (!isfinite(step[0]) || !isfinite(step[1])) return 0;
    for (int k = 0; k < 2; k++)
        if (axis[k]->closed)
            length = fmin(length, TURNS_MOST * gd__axis_period(axis[k]) / fabs(step[k]));
    return length;
}

static void nurbs_nearest_descend(const struct gd_parametric *surface, struct gd_vec3 xyz,
                                  double at[2])
{
    struct target now = half_square_at(surface, xyz, at);
    for (int i = 0; i < STEPS_MOST; i++) {
        bool held[2];
        for (int k = 0; k < 2; k++)
            held[k] = nurbs_nearest_is_held(surface->axis[k], at[k], now.gradient[k]);
        double step[2], next[2];
        nurbs_nearest_step_of(&now, held, step);
        double length = first_length(surface->axis, step);
        if (!length) return;
        struct target then = now;
        for (int half = 0; half < STEPS_MOST; half++, length *= 0.5) {
            for (int k = 0; k < 2; k++) {
                const struct gd_axis *axis = surface->axis[k];
                next[k] = at[k] + length * step[k];
                if (!axis->closed) next[k] = fmin(fmax(next[k], axis->low), axis->high);
            }
            then = half_square_at(surface, xyz, next);
            if (then.value <= now.value) break;
        }
        if (!(then.value <= now.value) || (next[0] == at[0] && next[1] == at[1])) return;
        at[0] = next[0], at[1] = next[1];
        now = then;
    }
}

/* Returns true if no neighbour of a grid node is nearer to the point. */
static bool is_lowest(const struct gd_parametric *surface, const struct gd__grid *grid,
                      const double *distance, uint32_t i, uint32_t j)
{
    uint32_t at[2] = {i, j}, columns = grid->steps[1] + 1;
    for (int k = 0; k < 2; k++) {
        for (int side = 0; side < 2; side++) {
            uint32_t to[2] = {at[0], at[1]};
            if (side ? at[k] < grid->steps[k] : at[k] > 0)
                to[k] += side ? 1 : UINT32_MAX;
            else if (surface->axis[k]->closed)
                to[k] = side ? 1 : grid->steps[k] - 1;
            if (distance[to[0] * columns + to[1]] < distance[i * columns + j]) return false;
        }
    }
    return true;
}

static void nurbs_nearest_improve(const struct gd_parametric *surface, struct gd_vec3 xyz,
                                  const struct gd__grid *grid, uint32_t i, uint32_t j,
                                  struct gd_parametric_closest *best)
{
    double at[2] = {grid->at[0][i], grid->at[1][j]};
    nurbs_nearest_descend(surface, xyz, at);
    for (int k = 0; k < 2; k++) at[k] = gd__axis_wrap(surface->axis[k], at[k]);
    struct gd_vec3 x = gd__surface_position(surface, at);
    double distance = gd_vec3_distance(x, xyz);
    if (distance < best->distance && gd_parametric_contains(surface, at[0], at[1]))
        *best = (struct gd_parametric_closest){at[0], at[1], x, distance};
}

/* Computes the distances of all grid nodes, and applies Newton's method from each local minimum. */
static enum gd_status nurbs_nearest_search(const struct gd_parametric *surface, struct gd_vec3 xyz,
                                           const struct gd__grid *grid,
                                           const struct gd_control *control, double *distance,
                                           struct gd_parametric_closest *best)
{
    uint32_t columns = grid->steps[1] + 1, nodes = (grid->steps[0] + 1) * columns;
    enum gd_status status = GD_OK;
    for (uint32_t node = 0; node < nodes && !status; node++) {
        double at[2] = {grid->at[0][node / columns], grid->at[1][node % columns]};
        distance[node] = gd_vec3_distance(gd__surface_position(surface, at), xyz);
        if (node % LOOK == 0) status = gd_control_check(control, 0.5 * node / nodes);
    }
    for (uint32_t node = 0; node < nodes && !status; node++) {
        if (node % LOOK == 0) status = gd_control_check(control, 0.5 + 0.5 * node / nodes);
        if (is_lowest(surface, grid, distance, node / columns, node % columns))
            nurbs_nearest_improve(surface, xyz, grid, node / columns, node % columns, best);
    }
    return status;
}

/* --- the loops of a trimmed surface ----------------------------------------------------------- */

static void loop_place(const struct gd_parametric *surface, uint32_t loop, double s,
                       struct gd_vec3 xyz, struct gd_parametric_closest *out)
{
    struct gd__span_jet jet;
    gd__loop_jet(surface->loops, loop, s, false, &jet);
    out->u = jet.at[0], out->v = jet.at[1];
    out->xyz = gd__surface_position(surface, jet.at);
    out->distance = gd_vec3_distance(out->xyz, xyz);
}

/* Returns Newton's step along a loop towards the place nearest to xyz, or 0 if the step does not
 * lead to a minimum. */
static double loop_step(const struct gd_parametric *surface, uint32_t loop, double s,
                        struct gd_vec3 xyz)
{
    struct gd__span_jet jet;
    gd__loop_jet(surface->loops, loop, s, false, &jet);
    struct target t = half_square_at(surface, xyz, jet.at);
    double slope = t.gradient[0] * jet.first[0] + t.gradient[1] * jet.first[1];
    double curve = t.gradient[0] * jet.second[0] + t.gradient[1] * jet.second[1] +
                   t.hessian[0] * jet.first[0] * jet.first[0] +
                   2 * t.hessian[1] * jet.first[0] * jet.first[1] +
                   t.hessian[2] * jet.first[1] * jet.first[1];
    return curve > 0 ? -slope / curve : 0;
}

/* Finds the nearest place of a loop between two parameters, by golden section and Newton's
 * method. */
static void loop_improve(const struct gd_parametric *surface, uint32_t loop, const double ends[2],
                         struct gd_vec3 xyz, struct gd_parametric_closest *best)
{
    const double golden = 0.5 * (sqrt(5) - 1);
    double low = ends[0], high = ends[1];
    struct gd_parametric_closest a, b;
    for (int i = 0; i < SECTIONS; i++) {
        double p = high - golden * (high - low), q = low + golden * (high - low);
        loop_place(surface, loop, p, xyz, &a);
        loop_place(surface, loop, q, xyz, &b);
        if (a.distance < b.distance)
            high = q;
        else
            low = p;
    }
    double s = 0.5 * (low + high);
    for (int i = 0; i < POLISH; i++) {
        double next = fmin(fmax(s + loop_step(surface, loop, s, xyz), ends[0]), ends[1]);
        loop_place(surface, loop, s, xyz, &a);
        loop_place(surface, loop, next, xyz, &b);
        if (b.distance <= a.distance) s = next;
    }
    loop_place(surface, loop, s, xyz, &a);
    if (a.distance < best->distance) *best = a;
}

/* Finds the nearest place of all loops. Starts a search at each sample that is nearer than its
 * neighbours. */
static enum gd_status nearest_on_loops(const struct gd_parametric *surface, struct gd_vec3 xyz,
                                       const struct gd_control *control,
                                       struct gd_parametric_closest *best)
{
    const struct gd__loop_samples *samples = &surface->loops->samples;
    struct gd__pace pace = {.control = control, .fraction = 0.9};
    for (uint32_t i = 0; i < surface->loops->count; i++) {
        uint32_t first = samples->first[i], count = samples->first[i + 1] - first;
        double spans = surface->loops->loops[i].span_count;
        for (uint32_t k = 0; k < count && gd__pace(&pace, GD__STEP); k++) {
            uint32_t before = (k + count - 1) % count, after = (k + 1) % count;
            struct gd_parametric_closest here, a, b;
            loop_place(surface, i, samples->s[first + k], xyz, &here);
            loop_place(surface, i, samples->s[first + before], xyz, &a);
            loop_place(surface, i, samples->s[first + after], xyz, &b);
            if (a.distance < here.distance || b.distance < here.distance) continue;
            double s = samples->s[first + k],
                   low = samples->s[first + before] - (before > k ? spans : 0),
                   high = samples->s[first + after] + (after < k ? spans : 0);
            loop_improve(surface, i, (double[]){low, s}, xyz, best);
            loop_improve(surface, i, (double[]){s, high}, xyz, best);
            if (here.distance < best->distance) *best = here;
        }
    }
    return pace.status;
}

enum gd_status gd_parametric_nearest(const struct gd_parametric *surface, struct gd_vec3 xyz,
                                     const struct gd_control *control,
                                     struct gd_parametric_closest *out, struct gd_detail *detail)
{
    if (!gd_vec3_is_finite(xyz))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the point has a coordinate that is not finite");
    const struct gd_tessellation_options options = {.faces = GRID_FACES};
    struct gd__arena arena = {.budget.control = control};
    struct gd__grid grid;
    struct gd_parametric_closest best = {.distance = INFINITY};
    double *distance = NULL;
    enum gd_status status = gd__grid_make(surface, &options, &arena, &grid);
    if (!status)
        distance = gd__arena_take(&arena, (grid.steps[0] + (size_t)1) * (grid.steps[1] + (size_t)1),
                                  sizeof *distance);
    if (!status) status = arena.status;
    if (!status) status = nurbs_nearest_search(surface, xyz, &grid, control, distance, &best);
    if (!status && surface->loops) status = nearest_on_loops(surface, xyz, control, &best);
    gd__arena_free(&arena);
    if (status) return gd_fail_status(detail, status);
    if (!isfinite(best.distance))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the point is so far away that the square of its distance overflows");
    *out = best;
    return GD_OK;
}
