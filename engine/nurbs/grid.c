#include "nurbs/grid.h"

#include <math.h>

#include "nurbs/bspline.h"

enum {
    ACROSS = 9, /* number of lines on which a cell is measured */
    /* number of steps of each line; the surface is measured at the ends of the steps */
    ALONG = 8,
    LEAST_STEPS = 8 /* least number of steps in a direction */
};

/* The size of a cell in one direction, measured on several lines that run through the cell in this
 * direction. `length` is their largest length, and `bend` the largest value of |x''| width^2. */
struct cell_size {
    double low, high, length, bend;
};

static void measure_line(const struct gd_parametric *surface, int k, int32_t index, double across,
                         struct cell_size *size)
{
    double length = 0, width = size->high - size->low;
    struct gd_vec3 before = {0};
    struct gd__cell cell;
    cell.index[k] = index;
    cell.index[1 - k] = gd__axis_cell(surface->axis[1 - k], across);
    for (int i = 0; i <= ALONG; i++) {
        double at[2];
        at[k] = size->low + width * i / ALONG;
        at[1 - k] = across;
        struct gd_jet jet;
        gd__surface_jet(surface, cell, at, &jet);
        if (i) length += gd_vec3_distance(before, jet.x);
        before = jet.x;
        size->bend = fmax(size->bend, gd_vec3_length(k ? jet.vv : jet.uu) * width * width);
    }
    size->length = fmax(size->length, length);
}

static struct cell_size nurbs_grid_measure(const struct gd_parametric *surface, int k,
                                           int32_t index)
{
    const struct gd_axis *axis = surface->axis[k], *other = surface->axis[1 - k];
    bool is_line;
    struct cell_size size = {axis->low, axis->high, 0, 0};
    if (index > 0) size.low = gd__axis_line(axis, index, &is_line);
    if (index < (int32_t)axis->line_count) size.high = gd__axis_line(axis, index + 1, &is_line);
    for (int i = 0; i < ACROSS; i++)
        measure_line(surface, k, index,
                     other->low + (other->high - other->low) * (i + 0.5) / ACROSS, &size);
    return size;
}

static double total_length(const struct cell_size *sizes, uint32_t count)
{
    double sum = 0;
    for (uint32_t i = 0; i < count; i++) sum += sizes[i].length;
    return sum;
}

/* Returns the number of steps for a cell. If a cell is divided into `steps` steps, an edge of one
 * step deviates from the surface by bend / (8 steps^2). At most half of `deviation` is allowed,
 * because the deviations of both directions add up. */
static double steps_of(const struct cell_size *size, double step, double deviation, double share)
{
    double steps = fmax(ceil(size->length / step), 1);
    if (deviation > 0) steps = fmax(steps, ceil(sqrt(size->bend / (4 * deviation))));
    return fmax(steps, ceil(LEAST_STEPS * share));
}

/* The steps of one direction. If `fixed` is not 0, there is one cell, which gets this number of
 * steps. */
struct division {
    double step, deviation;
    uint32_t fixed;
};

static double parts_of(const struct division *by, const struct cell_size *size, uint32_t cells)
{
    return by->fixed ? by->fixed : steps_of(size, by->step, by->deviation, 1.0 / cells);
}

static enum gd_status nurbs_grid_divide(const struct cell_size *sizes, uint32_t cells,
                                        const struct division *by, struct gd__arena *arena,
                                        double **out, uint32_t *steps)
{
    double count = 0;
    for (uint32_t i = 0; i < cells; i++) count += parts_of(by, &sizes[i], cells);
    if (!(count <= GD_TESSELLATION_FACES_MAX)) return GD_TOO_LARGE;
    double *at = gd__arena_take(arena, (size_t)count + 1, sizeof *at);
    if (!at) return arena->status;
    uint32_t filled = 0;
    for (uint32_t i = 0; i < cells; i++) {
        double parts = parts_of(by, &sizes[i], cells);
        for (uint32_t j = 0; j < (uint32_t)parts; j++)
            at[filled++] = sizes[i].low + (sizes[i].high - sizes[i].low) * j / parts;
    }
    at[filled] = sizes[cells - 1].high;
    *out = at;
    *steps = filled;
    return GD_OK;
}

/* Returns the number of triangles of an untrimmed surface. A cell at a pole has only one. */
static double triangles_of(const struct gd_parametric *surface, const struct gd__grid *grid)
{
    double count = 2.0 * grid->steps[0] * grid->steps[1];
    for (int k = 0; k < 2; k++) {
        const struct gd_axis *axis = surface->axis[k];
        count -= (axis->pole_low + axis->pole_high) * (double)grid->steps[1 - k];
    }
    return count;
}

enum gd_status gd__grid_make(const struct gd_parametric *surface,
                             const struct gd_tessellation_options *options, struct gd__arena *arena,
                             struct gd__grid *out)
{
    static const struct gd_tessellation_options usual = {0};
    if (!options) options = &usual;
    struct gd__arena scratch = {.budget = arena->budget};
    struct cell_size *sizes[2] = {0};
    double lengths[2] = {0}, faces = options->faces ? options->faces : GD_TESSELLATION_FACES;
    uint32_t cells[2];
    enum gd_status status = GD_OK;
    for (int k = 0; k < 2; k++) {
        const struct gd_axis *axis = surface->axis[k];
        cells[k] = options->steps[0] ? 1 : axis->line_count + 1;
        sizes[k] = gd__arena_take(&scratch, cells[k], sizeof **sizes);
        status = scratch.status;
        for (uint32_t i = 0; i < cells[k] && !status; i++)
            sizes[k][i] = options->steps[0] ? (struct cell_size){axis->low, axis->high, 0, 0}
                                            : nurbs_grid_measure(surface, k, (int32_t)i);
        if (!status) lengths[k] = total_length(sizes[k], cells[k]);
    }
    double step = sqrt(2 * lengths[0] * lengths[1] / faces);
    for (int k = 0; k < 2 && !status; k++) {
        const struct division by = {step, options->deviation, options->steps[k]};
        status = nurbs_grid_divide(sizes[k], cells[k], &by, arena, &out->at[k], &out->steps[k]);
    }
    gd__arena_free(&scratch);
    if (status) return status;
    if (2.0 * out->steps[0] * out->steps[1] > GD_TESSELLATION_FACES_MAX) return GD_TOO_LARGE;
    bool is_limited = options->max_faces && !surface->loops;
    return is_limited && triangles_of(surface, out) > options->max_faces ? GD_TOO_LARGE : GD_OK;
}

uint32_t gd__grid_step(const struct gd__grid *grid, int axis, double t, double *part)
{
    const double *at = grid->at[axis];
    uint32_t low = gd__interval(at, 0, grid->steps[axis], t);
    *part = fmin(fmax((t - at[low]) / (at[low + 1] - at[low]), 0), 1);
    return low;
}
