#include "subdiv/limit_grid.h"

#include <stdlib.h>

#include "base/large.h"
#include "subdiv/domain.h"
#include "subdiv/grid.h"
#include "subdiv/tiling.h"

/* --- building --------------------------------------------------------------------------------- */

static size_t positions_bytes(const struct gd_subdivision *surface, uint64_t cells)
{
    return (size_t)(surface->base.face_count * (cells + 1) * (cells + 1)) * sizeof(struct gd_vec3);
}

size_t gd_limit_grid_cost(const struct gd_subdivision *surface, uint32_t level)
{
    uint64_t cells = gd__level_cells(surface, level);
    return sizeof(struct gd_limit_grid) + positions_bytes(surface, cells) +
           2 * (size_t)((cells + 1) * (cells + 1)) * sizeof(struct gd_vec3) + (1 << 20);
}

static enum gd_status check_level(const struct gd_subdivision *surface,
                                  const struct gd_limit_mesh_options *options,
                                  struct gd_detail *detail)
{
    if (options->level > GD_LIMIT_LEVEL_MOST || options->level < gd_limit_mesh_least_level(surface))
        return gd_fail(detail, GD_INVALID_ARGUMENT, "the level is %u: levels run from %u to %d",
                       options->level, gd_limit_mesh_least_level(surface), GD_LIMIT_LEVEL_MOST);
    uint64_t triangles = surface->base.face_count *
                         gd__face_triangles(surface, gd__level_cells(surface, options->level)),
             most = options->max_faces ? options->max_faces : 1u << 28;
    if (triangles > most)
        return gd_fail(detail, GD_TOO_LARGE,
                       "that would be %llu triangles, and at most %llu are allowed: choose a "
                       "coarser level",
                       (unsigned long long)triangles, (unsigned long long)most);
    return GD_OK;
}

static enum gd_status evaluate_faces(const struct gd_limit_grid *grid, struct gd_vec3 *normals,
                                     const struct gd_control *control)
{
    uint32_t level = (uint32_t)__builtin_ctz(grid->cells), faces = grid->surface->base.face_count;
    struct gd__walker walker = {0};
    enum gd_status status =
        gd__walker_create(&walker, grid->surface, gd__grid_stages(level), control);
    struct gd__pace pace = {.control = control, .count = GD__PACE_STEPS};
    for (uint32_t face = 0; !status && face < faces; face++) {
        const struct gd__grid_room room = {grid->positions + (size_t)face * grid->stride, normals};
        pace.fraction = (double)face / faces;
        (void)gd__pace(&pace, 64);
        status = gd__grid(&walker, face, level, &room, &pace);
    }
    gd__walker_free(&walker);
    return status;
}

static struct gd_vec3 *side_position(const struct gd_limit_grid *grid, uint32_t side, uint32_t m)
{
    uint32_t arity = grid->surface->rules->arity, at[2];
    gd__side_place(arity, side % arity, grid->cells, m, at);
    return &grid->positions[(size_t)(side / arity) * grid->stride +
                            at[0] * (grid->cells + (size_t)1) + at[1]];
}

/* A vertex on the border of faces is computed in each of these faces, with rounding errors.
 * Replaces these positions by one of them. A vertex inside an edge gets the position from the side
 * with the lower number. A corner gets the position from the last side that begins there. A
 * discretization uses the same positions. */
static enum gd_status unify_borders(const struct gd_limit_grid *grid)
{
    const struct gd__net *base = &grid->surface->base;
    uint32_t sides = base->arity * base->face_count;
    struct gd_vec3 *corner = malloc(base->point_count * sizeof *corner);
    if (!corner) return GD_NO_MEMORY;
    for (uint32_t side = 0; side < sides; side++)
        corner[base->origin[side]] = *side_position(grid, side, 0);
    for (uint32_t side = 0; side < sides; side++) {
        *side_position(grid, side, 0) = corner[base->origin[side]];
        /* also true at the boundary, where the twin is GD_NONE */
        if (base->twin[side] > side) continue;
        for (uint32_t m = 1; m < grid->cells; m++)
            *side_position(grid, side, m) = *side_position(grid, base->twin[side], grid->cells - m);
    }
    free(corner);
    return GD_OK;
}

static enum gd_status fill(struct gd_limit_grid *grid, const struct gd_control *control)
{
    size_t count = (size_t)grid->surface->base.face_count * grid->stride;
    enum gd_status status =
        gd_control_afford(control, (count + grid->stride) * sizeof *grid->positions);
    if (status) return status;
    grid->positions = gd__large_array(count, sizeof *grid->positions);
    struct gd_vec3 *normals = malloc(grid->stride * sizeof *normals);
    status = grid->positions && normals ? evaluate_faces(grid, normals, control) : GD_NO_MEMORY;
    free(normals);
    return status ? status : unify_borders(grid);
}

enum gd_status gd_limit_grid_build(const struct gd_subdivision *surface,
                                   const struct gd_limit_mesh_options *options,
                                   const struct gd_control *control, struct gd_limit_grid **out,
                                   struct gd_detail *detail)
{
    enum gd_status status = check_level(surface, options, detail);
    if (status) return status;
    struct gd_limit_grid *grid = calloc(1, sizeof *grid);
    if (!grid) return GD_NO_MEMORY;
    grid->surface = gd_subdivision_retain(surface);
    grid->level = options->level;
    grid->cells = gd__level_cells(surface, options->level);
    grid->stride = (grid->cells + 1) * (grid->cells + 1);
    status = fill(grid, control);
    if (status)
        gd_limit_grid_free(grid);
    else
        *out = grid;
    return status;
}

void gd_limit_grid_free(struct gd_limit_grid *grid)
{
    if (!grid) return;
    gd_subdivision_release(grid->surface);
    free(grid->positions);
    free(grid);
}

size_t gd_limit_grid_memsize(const struct gd_limit_grid *grid)
{
    return sizeof *grid + positions_bytes(grid->surface, grid->cells);
}

uint32_t gd_limit_grid_level(const struct gd_limit_grid *grid)
{
    return grid->level;
}

/* --- edges ------------------------------------------------------------------------------------ */

/* Returns the position of a vertex along side k of a face, as a number of cells, or -1 if the
 * vertex is not on that side. */
static int32_t along_side(const struct gd_limit_grid *grid, uint32_t k, const int32_t at[2])
{
    uint32_t arity = grid->surface->rules->arity;
    double cells = grid->cells, s = at[0] / cells, t = at[1] / cells; /* exact */
    return gd__line_at(arity, k, s, t) == 0 ? (int32_t)(cells * gd__along_side(arity, k, s, t))
                                            : -1;
}

bool gd__grid_settle(const struct gd_limit_grid *grid, struct gd__grid_edge *edge)
{
    const struct gd__net *base = &grid->surface->base;
    uint32_t arity = base->arity, at[2];
    for (uint32_t k = 0; k < arity; k++) {
        int32_t from = along_side(grid, k, edge->p), to = along_side(grid, k, edge->q);
        if (from < 1 || to != from - 1) continue;
        uint32_t twin = base->twin[arity * edge->face + k];
        if (twin == GD_NONE) return false;
        edge->face = twin / arity;
        gd__side_place(arity, twin % arity, grid->cells, grid->cells - (uint32_t)from, at);
        edge->p[0] = (int32_t)at[0], edge->p[1] = (int32_t)at[1];
        gd__side_place(arity, twin % arity, grid->cells, grid->cells - (uint32_t)to, at);
        edge->q[0] = (int32_t)at[0], edge->q[1] = (int32_t)at[1];
        return true;
    }
    return true;
}

/* --- triangles -------------------------------------------------------------------------------- */

static double square_between(const struct gd_limit_grid *grid, uint32_t face, const int32_t p[2],
                             const int32_t q[2])
{
    struct gd_vec3 d =
        gd_vec3_sub(gd__grid_position(grid, face, p), gd__grid_position(grid, face, q));
    return d.x * d.x + d.y * d.y + d.z * d.z;
}

/* Returns true if the quad cell (i, j) is divided along the diagonal from (i, j) to (i + 1, j + 1).
 * As in gd__tile, a cell is divided along its shorter diagonal. */
static bool is_cut_from_a(const struct gd_limit_grid *grid, uint32_t face, int32_t i, int32_t j)
{
    const int32_t a[2] = {i, j}, b[2] = {i + 1, j}, c[2] = {i + 1, j + 1}, d[2] = {i, j + 1};
    return square_between(grid, face, a, c) <= square_between(grid, face, b, d);
}

/* Computes the apex of the triangle at a side of a quad cell. The cell's corners a, b, c, d have
 * the numbers 0 to 3, and the side begins at corner `from`. The cell's diagonal, a-c or b-d, begins
 * at one end of the side. Its other end is the apex. */
static void apex_over_side(const struct gd_limit_grid *grid, uint32_t face, const int32_t cell[2],
                           int from, int32_t apex[2])
{
    bool even = is_cut_from_a(grid, face, cell[0], cell[1]);
    int on_diagonal = (from % 2 == 0) == even ? from : from + 1;
    for (int k = 0; k < 2; k++) apex[k] = cell[k] + gd__cell_corners[(on_diagonal + 2) % 4][k];
}

static void apex_in_quads(const struct gd_limit_grid *grid, const struct gd__grid_edge *edge,
                          int32_t apex[2])
{
    int32_t x = edge->q[0] - edge->p[0], y = edge->q[1] - edge->p[1];
    const int32_t *p = edge->p, *q = edge->q;
    if (x && y) { /* a diagonal: the apex is the cell's corner to its left */
        apex[0] = x == y ? p[0] : q[0];
        apex[1] = x == y ? q[1] : p[1];
        return;
    }
    int from = x > 0 ? 0 : y > 0 ? 1 : x < 0 ? 2 : 3;
    const int32_t cells[4][2] = {{p[0], p[1]}, {p[0] - 1, p[1]}, {q[0], q[1] - 1}, {q[0], q[1]}};
    apex_over_side(grid, edge->face, cells[from], from, apex);
}

void gd__grid_apex(const struct gd_limit_grid *grid, const struct gd__grid_edge *edge,
                   int32_t apex[2])
{
    if (grid->surface->rules->arity == 4) {
        apex_in_quads(grid, edge, apex);
        return;
    }
    /* a rotation by 60 degrees maps (1, 0) to (0, 1), and (0, 1) to (-1, 1) */
    int32_t x = edge->q[0] - edge->p[0], y = edge->q[1] - edge->p[1];
    apex[0] = edge->p[0] - y;
    apex[1] = edge->p[1] + x + y;
}

void gd__grid_triangle(const struct gd_limit_grid *grid, const struct gd__face_place *place,
                       int32_t corners[3][2], double weights[3])
{
    uint32_t arity = grid->surface->rules->arity;
    struct gd__grid_cell cell = gd__grid_cell_of(arity, grid->cells, place->s, place->t);
    int32_t i = (int32_t)cell.i, j = (int32_t)cell.j;
    bool from_a = arity == 4 && is_cut_from_a(grid, place->face, i, j);
    const uint8_t *half = gd__half_corners[gd__grid_cell_split(&cell, from_a, weights)];
    for (int k = 0; k < 3; k++) {
        corners[k][0] = i + gd__cell_corners[half[k]][0];
        corners[k][1] = j + gd__cell_corners[half[k]][1];
    }
}
