#include "nurbs/nurbs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/tolerance.h"
#include "nurbs/surface.h"

/* --- one direction ---------------------------------------------------------------------------- */

static void take_knots(struct gd__knots *out, struct gd__arena *arena, uint32_t degree,
                       uint32_t count, const double *knots, bool is_short)
{
    uint32_t total = count + degree + 1;
    *out = (struct gd__knots){.degree = degree, .count = count};
    out->knots = gd__arena_take(arena, total, sizeof *out->knots);
    out->lines = gd__arena_take(arena, count, sizeof *out->lines);
    out->spans = gd__arena_take(arena, count, sizeof *out->spans);
    if (arena->status) return;
    memcpy(out->knots + is_short, knots, (total - 2 * is_short) * sizeof *knots);
    if (is_short) {
        out->knots[0] = out->knots[1];
        out->knots[total - 1] = out->knots[total - 2];
    }
    uint32_t cells = 0;
    for (uint32_t i = degree; i < count; i++) {
        if (!(out->knots[i] < out->knots[i + 1])) continue;
        if (cells) out->lines[cells - 1] = out->knots[i];
        out->spans[cells++] = i;
    }
    out->line_count = cells - 1;
}

void gd__nurbs_destroy(void *shape)
{
    struct gd__nurbs *nurbs = shape;
    if (!nurbs) return;
    gd__arena_free(&nurbs->arena);
    free(nurbs);
}

/* --- control points --------------------------------------------------------------------------- */

static void take_points(struct gd__nurbs *nurbs, const struct gd_nurbs_data *data)
{
    bool multiplied = data->convention == GD_NURBS_VERB || data->convention == GD_NURBS_RHINO;
    size_t count = (size_t)data->count_u * data->count_v;
    nurbs->control = gd__arena_take(&nurbs->arena, count, sizeof *nurbs->control);
    if (!nurbs->control) return;
    for (size_t i = 0; i < count; i++) {
        double weight = data->weights ? data->weights[i] : 1;
        for (int c = 0; c < 3; c++) {
            nurbs->control[i][c] = data->points[i][c] / (multiplied ? weight : 1);
            nurbs->centre[c] += nurbs->control[i][c] / (double)count;
        }
        nurbs->control[i][3] = weight;
    }
    for (size_t i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            nurbs->control[i][c] = (nurbs->control[i][c] - nurbs->centre[c]) * nurbs->control[i][3];
}

/* --- closed directions and poles -------------------------------------------------------------- */

static void axis_of(const struct gd__knots *knots, struct gd_axis *out)
{
    *out = (struct gd_axis){.low = knots->knots[knots->degree],
                            .high = knots->knots[knots->count],
                            .line_count = knots->line_count,
                            .lines = knots->lines};
}

static struct gd_vec3 nurbs_position(const struct gd__nurbs *nurbs, bool u_is_border, bool upper,
                                     double along)
{
    const struct gd__knots *border = u_is_border ? &nurbs->u : &nurbs->v;
    const struct gd__knots *other = u_is_border ? &nurbs->v : &nurbs->u;
    uint32_t border_cell = upper ? border->line_count : 0, cell = 0;
    double at = border->knots[upper ? border->count : border->degree];
    while (cell < other->line_count && along >= other->lines[cell]) cell++;
    struct gd_jet jet;
    if (u_is_border)
        gd__nurbs_jet(nurbs, border_cell, cell, at, along, &jet);
    else
        gd__nurbs_jet(nurbs, cell, border_cell, along, at, &jet);
    return jet.x;
}

static double nurbs_extent(const struct gd__nurbs *nurbs)
{
    double most = 0;
    for (size_t i = 0; i < (size_t)nurbs->u.count * nurbs->v.count; i++)
        for (int c = 0; c < 3; c++)
            most = fmax(most, fabs(nurbs->control[i][c] / nurbs->control[i][3]));
    return most;
}

/* Finds out whether a direction is closed, and whether its borders are poles. Compares both borders
 * at so many places of each cell that two different rational curves of the borders' degree cannot
 * agree at all of these places. */
static void recognise(const struct gd__nurbs *nurbs, bool u_is_border, double size,
                      struct gd_axis *axis)
{
    const struct gd__knots *other = u_is_border ? &nurbs->v : &nurbs->u;
    bool closed = true, pole_low = true, pole_high = true;
    double far = fmax(fmax(fabs(nurbs->centre[0]), fabs(nurbs->centre[1])), fabs(nurbs->centre[2]));
    double near = GD_TOL_CLOSED * size + GD_TOL_LOCATE * far;
    struct gd_vec3 first_low = {0}, first_high = {0};
    for (uint32_t cell = 0; cell <= other->line_count; cell++) {
        const double *span = &other->knots[other->spans[cell]];
        uint32_t places = 2 * other->degree + 1;
        for (uint32_t i = 0; i < places; i++) {
            double along = span[0] + (span[1] - span[0]) * i / places;
            struct gd_vec3 low = nurbs_position(nurbs, u_is_border, false, along);
            struct gd_vec3 high = nurbs_position(nurbs, u_is_border, true, along);
            if (!cell && !i) first_low = low, first_high = high;
            closed = closed && gd_vec3_distance(low, high) <= near;
            pole_low = pole_low && gd_vec3_distance(low, first_low) <= near;
            pole_high = pole_high && gd_vec3_distance(high, first_high) <= near;
        }
    }
    axis->pole_low = pole_low;
    axis->pole_high = pole_high;
    axis->closed = axis->seam = closed && !pole_low && !pole_high;
}

enum gd_status gd_nurbs_create(const struct gd_nurbs_data *data, struct gd_parametric **out,
                               struct gd_detail *detail)
{
    if (gd_nurbs_inspect(data, detail)) return GD_INVALID_ARGUMENT;
    bool rhino = data->convention == GD_NURBS_RHINO;
    struct gd__nurbs *nurbs = calloc(1, sizeof *nurbs);
    if (!nurbs) return gd_fail_status(detail, GD_NO_MEMORY);
    take_knots(&nurbs->u, &nurbs->arena, data->degree_u, data->count_u, data->knots_u, rhino);
    take_knots(&nurbs->v, &nurbs->arena, data->degree_v, data->count_v, data->knots_v, rhino);
    take_points(nurbs, data);
    if (nurbs->arena.status) {
        gd__nurbs_destroy(nurbs);
        return gd_fail_status(detail, GD_NO_MEMORY);
    }
    struct gd_evaluator evaluator = {.jet = gd__nurbs_jet,
                                     .destroy = gd__nurbs_destroy,
                                     .shape = nurbs,
                                     .bytes = sizeof *nurbs + nurbs->arena.budget.held};
    axis_of(&nurbs->u, &evaluator.u);
    axis_of(&nurbs->v, &evaluator.v);
    double size = nurbs_extent(nurbs);
    recognise(nurbs, true, size, &evaluator.u);
    recognise(nurbs, false, size, &evaluator.v);
    return gd_parametric_create(&evaluator, out, detail);
}

/* --- the control net -------------------------------------------------------------------------- */

bool gd_nurbs_counts(const struct gd_parametric *surface, uint32_t counts[2])
{
    if (surface->evaluator.jet != gd__nurbs_jet) return false;
    const struct gd__nurbs *nurbs = surface->evaluator.shape;
    counts[0] = nurbs->u.count;
    counts[1] = nurbs->v.count;
    return true;
}

struct gd_vec3 gd_nurbs_control_point(const struct gd_parametric *surface, uint32_t i, uint32_t j)
{
    const struct gd__nurbs *nurbs = surface->evaluator.shape;
    const double *at = nurbs->control[(size_t)i * nurbs->v.count + j];
    return (struct gd_vec3){at[0] / at[3] + nurbs->centre[0], at[1] / at[3] + nurbs->centre[1],
                            at[2] / at[3] + nurbs->centre[2]};
}
