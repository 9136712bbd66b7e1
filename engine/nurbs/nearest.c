#include <math.h>
#include <stdlib.h>

#include "base/tolerance.h"
#include "nurbs/grid.h"

/* LOOK: nodes between two checks of the control */
enum { GRID_FACES = 2048, STEPS_MOST = 60, LOOK = 512 };

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

/* Computes Newton's step in the free coordinates; steepest descent if the Hessian is not
 * positive. */
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

static void nurbs_nearest_descend(const struct gd_parametric *surface, struct gd_vec3 xyz,
                                  double at[2])
{
    struct target now = half_square_at(surface, xyz, at);
    for (int i = 0; i < STEPS_MOST; i++) {
        bool held[2];
        for (int k = 0; k < 2; k++)
            held[k] = nurbs_nearest_is_held(surface->axis[k], at[k], now.gradient[k]);
        double step[2], next[2], length = 1;
        nurbs_nearest_step_of(&now, held, step);
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

/* Returns true if a grid node is not farther than its neighbours. */
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
    if (distance < best->distance)
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

enum gd_status gd_parametric_nearest(const struct gd_parametric *surface, struct gd_vec3 xyz,
                                     const struct gd_control *control,
                                     struct gd_parametric_closest *out, struct gd_detail *detail)
{
    if (!gd_vec3_is_finite(xyz))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the point has a coordinate that is not finite");
    struct gd__grid grid;
    enum gd_status status =
        gd__grid_make(surface, &(struct gd_tessellation_options){.faces = GRID_FACES}, &grid);
    if (status) return gd_fail_status(detail, status);
    size_t bytes = (grid.steps[0] + (size_t)1) * (grid.steps[1] + (size_t)1) * sizeof(double);
    struct gd_parametric_closest best = {.distance = INFINITY};
    status = gd_control_afford(control, bytes);
    double *distance = status ? NULL : malloc(bytes);
    if (!status)
        status = distance ? nurbs_nearest_search(surface, xyz, &grid, control, distance, &best)
                          : GD_NO_MEMORY;
    free(distance);
    gd__grid_free(&grid);
    if (status) return gd_fail_status(detail, status);
    *out = best;
    return GD_OK;
}
