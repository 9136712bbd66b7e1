/* Finds vertices within a tolerance of each other by a spatial hash.
 *
 * DESIGN. Space is divided into cubic cells with sides of twice the tolerance. Along each axis, all
 * points within the tolerance of a point are in its cell or in the neighbouring cell on the nearer
 * side. So they are in at most 8 cells. The table holds only vertices that represent themselves.
 * Any two of these are more than the tolerance apart. So for any input a cell holds at most a few
 * dozen of them, and each vertex costs bounded work. No file can make the table's chains long,
 * because the hash differs from run to run. If the tolerance is 0, each position is a cell.
 *
 * Cell numbers are doubles. Where cell numbers exceed 2^53, two different coordinates are farther
 * apart than the tolerance. So rounding can give two neighbouring cells the same number only if the
 * points in them have equal coordinates. */
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/large.h"
#include "repair/repair.h"

struct cell_table {
    struct gd__construction *work;
    double tolerance;
    uint32_t *head; /* for each slot, the newest vertex of a cell; GD_NONE if free */
    uint32_t *next; /* for each vertex, the next older vertex of its cell */
    uint64_t mask, seed;
};

/* Returns the number of the cell that contains a coordinate; never -0. */
static double repair_weld_cell_of(const struct cell_table *table, double x)
{
    return (table->tolerance > 0 ? floor(x / (2 * table->tolerance)) : x) + 0.0;
}

static struct gd_vec3 cell_at(const struct cell_table *table, struct gd_vec3 p)
{
    return (struct gd_vec3){repair_weld_cell_of(table, p.x), repair_weld_cell_of(table, p.y),
                            repair_weld_cell_of(table, p.z)};
}

static uint64_t repair_weld_hash(const struct cell_table *table, struct gd_vec3 cell)
{
    double coordinates[3] = {cell.x, cell.y, cell.z};
    uint64_t h = table->seed, bits;
    for (int k = 0; k < 3; k++) {
        memcpy(&bits, &coordinates[k], sizeof bits);
        h = gd__hash(h + bits);
    }
    return h;
}

/* Returns the slot of a cell, or the free slot where it belongs. */
static uint32_t *find_slot(const struct cell_table *table, struct gd_vec3 cell)
{
    for (uint64_t i = repair_weld_hash(table, cell);; i++) {
        uint32_t *head = &table->head[i & table->mask];
        if (*head == GD_NONE) return head;
        struct gd_vec3 other = cell_at(table, gd__input_position(table->work, *head));
        if (other.x == cell.x && other.y == cell.y && other.z == cell.z) return head;
    }
}

static bool are_near(const struct cell_table *table, struct gd_vec3 p, struct gd_vec3 q)
{
    struct gd_vec3 d = gd_vec3_sub(p, q);
    if (table->tolerance == 0) return d.x == 0 && d.y == 0 && d.z == 0;
    d = (struct gd_vec3){d.x / table->tolerance, d.y / table->tolerance, d.z / table->tolerance};
    return gd_vec3_dot(d, d) <= 1;
}

static uint32_t lowest_near_in_cell(const struct cell_table *table, struct gd_vec3 cell,
                                    struct gd_vec3 p)
{
    uint32_t lowest = GD_NONE;
    for (uint32_t v = *find_slot(table, cell); v != GD_NONE; v = table->next[v]) {
        if (v < lowest && are_near(table, p, gd__input_position(table->work, v))) lowest = v;
    }
    return lowest;
}

/* Finds the cells to search along one axis. Returns their number, one or two. */
static int cells_along(const struct cell_table *table, double x, double cells[2])
{
    cells[0] = repair_weld_cell_of(table, x);
    if (table->tolerance == 0) return 1;
    cells[1] = (x / (2 * table->tolerance) - cells[0] < 0.5 ? cells[0] - 1 : cells[0] + 1) + 0.0;
    return cells[1] != cells[0] ? 2 : 1;
}

static uint32_t lowest_near(const struct cell_table *table, struct gd_vec3 p)
{
    double x[2], y[2], z[2];
    int nx = cells_along(table, p.x, x), ny = cells_along(table, p.y, y),
        nz = cells_along(table, p.z, z);
    uint32_t lowest = GD_NONE;
    for (int i = 0; i < nx * ny * nz; i++) {
        struct gd_vec3 cell = {x[i % nx], y[i / nx % ny], z[i / nx / ny]};
        uint32_t near = lowest_near_in_cell(table, cell, p);
        if (near < lowest) lowest = near;
    }
    return lowest;
}

static void weld_vertex(struct cell_table *table, uint32_t vertex)
{
    struct gd__construction *work = table->work;
    struct gd_vec3 p = gd__input_position(work, vertex);
    uint32_t near = lowest_near(table, p);
    if (near == GD_NONE) {
        uint32_t *head = find_slot(table, cell_at(table, p));
        table->next[vertex] = *head;
        *head = vertex;
        return;
    }
    struct gd_mesh_repair *repair = work->mesh->repair;
    work->representative[vertex] = near;
    gd_mended_add(&repair->vertices_welded, vertex, near);
    repair->largest_shift =
        fmax(repair->largest_shift, gd_vec3_distance(p, gd__input_position(work, near)));
}

#define STEPS_A_VERTEX 8

static enum gd_status weld_all(struct cell_table *table, const uint8_t *used)
{
    struct gd__pace *pace = &table->work->pace;
    uint32_t vertices = table->work->input->position_count;
    for (uint32_t i = 0; i < vertices && gd__pace(pace, STEPS_A_VERTEX); i++) {
        if (used[i]) weld_vertex(table, i);
    }
    return pace->status;
}

/* Checks that cell numbers stay in range. */
static enum gd_status check_tolerance(struct gd__construction *work)
{
    double tolerance = work->options.weld_tolerance, farthest = 0;
    GD__PACED (&work->pace, i, work->input->position_count) {
        struct gd_vec3 p = gd__input_position(work, i);
        farthest = fmax(farthest, fmax(fmax(fabs(p.x), fabs(p.y)), fabs(p.z)));
    }
    if (tolerance == 0 || farthest / tolerance <= GD_EXTENT_MAX) return GD_OK;
    return gd_fail(work->detail, GD_INVALID_ARGUMENT,
                   "the weld tolerance is %g where coordinates reach %g: it welds only equal "
                   "positions, as 0 does; use a larger one, or 0",
                   tolerance, farthest);
}

enum gd_status gd__weld_vertices(struct gd__construction *work)
{
    uint32_t vertices = work->input->position_count;
    uint64_t slots = 16;
    while (slots < 2 * (uint64_t)vertices) slots *= 2;
    enum gd_status status = check_tolerance(work);
    if (status) return status;
    uint8_t *used = gd__large_zeroed(vertices, sizeof *used);
    struct cell_table table = {work,
                               work->options.weld_tolerance,
                               gd__large_array(slots, sizeof *table.head),
                               gd__large_array(vertices, sizeof *table.next),
                               slots - 1,
                               gd_now_ns() ^ (uintptr_t)used};
    status = GD_NO_MEMORY;
    if (used && table.head && table.next) {
        gd__pace_fill(&work->pace, table.head, slots * sizeof *table.head);
        GD__PACED (&work->pace, c, gd_polygons_corner_count(work->input))
            used[work->input->corners[c]] = 1;
        status = weld_all(&table, used);
    }
    free(used);
    free(table.head);
    free(table.next);
    return status;
}
