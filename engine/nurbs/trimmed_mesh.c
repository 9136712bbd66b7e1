/* Tessellation of a trimmed surface: a constrained Delaunay triangulation of grid nodes and of
 * places on the loops. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "loops/triangulation.h"
#include "nurbs/tessellation.h"

/* Smallest ratio of the two widths of the lattice. */
static const double least_width = 1.0 / 16;
/* Grid nodes that are nearer to a loop than this number of grid steps are omitted. */
static const double clearance = 0.5;

enum { MARKS_A_STEP = 4 };

struct meshing {
    struct gd_tessellation *t;
    struct gd__arena arena;
    struct gd__pace pace;
    struct gd__loop_samples samples;
    bool *omitted;       /* for each grid node, true if it is near a loop */
    uint32_t *number_of; /* for each grid node, the number of its place */
    uint32_t count;      /* number of places: first the samples of loops, then the grid nodes */
    double (*uv)[2];
    struct gd__site *nodes;
    uint32_t segment_count;
    uint32_t (*segments)[2];
    struct gd__triangulation found;
};

static bool is_border(const struct gd__grid *grid, uint32_t i, uint32_t j)
{
    return i == 0 || j == 0 || i == grid->steps[0] || j == grid->steps[1];
}

/* Omits the grid nodes near a place. */
static void omit_near(struct meshing *m, const double at[2])
{
    const struct gd__grid *grid = &m->t->grid;
    double part[2];
    uint32_t step[2];
    for (int k = 0; k < 2; k++) step[k] = gd__grid_step(grid, k, at[k], &part[k]);
    for (uint32_t c = 0; c < 4; c++) {
        uint32_t i = step[0] + c / 2, j = step[1] + c % 2;
        if (hypot(part[0] - c / 2, part[1] - c % 2) < clearance)
            m->omitted[i * (grid->steps[1] + 1) + j] = true;
    }
}

/* Omits the grid nodes near the segment from a to b. */
static void omit_along(struct meshing *m, const double a[2], const double b[2])
{
    const struct gd__grid *grid = &m->t->grid;
    double run = 0;
    for (int k = 0; k < 2; k++) {
        double from, to;
        from = gd__grid_step(grid, k, a[k], &from) + from;
        to = gd__grid_step(grid, k, b[k], &to) + to;
        run = fmax(run, fabs(to - from));
    }
    uint32_t marks = (uint32_t)(MARKS_A_STEP * run) + 1;
    for (uint32_t i = 0; i <= marks && gd__pace(&m->pace, 1); i++) {
        double at[2];
        for (int k = 0; k < 2; k++) at[k] = a[k] + (b[k] - a[k]) * i / marks;
        omit_near(m, at);
    }
}

static enum gd_status omit_nodes(struct meshing *m)
{
    uint32_t nodes = gd__node_count(&m->t->grid);
    m->omitted = gd__arena_zeroed(&m->arena, nodes, sizeof *m->omitted);
    m->number_of = gd__arena_take(&m->arena, nodes, sizeof *m->number_of);
    if (m->arena.status) return m->arena.status;
    for (uint32_t i = 0; i < m->t->surface->loops->count; i++) {
        uint32_t first = m->samples.first[i], count = m->samples.first[i + 1] - first;
        for (uint32_t k = 0; k < count; k++)
            omit_along(m, m->samples.at[first + k], m->samples.at[first + (k + 1) % count]);
    }
    return m->pace.status;
}

static void add_segment(struct meshing *m, uint32_t a, uint32_t b)
{
    m->segments[m->segment_count][0] = a;
    m->segments[m->segment_count++][1] = b;
}

/* Adds the border of the grid as a loop, if the domain has no outer loop. */
static void add_border(struct meshing *m)
{
    const uint32_t *steps = m->t->grid.steps, columns = steps[1] + 1;
    const uint32_t *number = m->number_of;
    for (uint32_t i = 0; i < steps[0]; i++)
        for (uint32_t side = 0; side < 2; side++) {
            uint32_t j = side * steps[1];
            add_segment(m, number[i * columns + j], number[(i + 1) * columns + j]);
        }
    for (uint32_t j = 0; j < steps[1]; j++)
        for (uint32_t side = 0; side < 2; side++) {
            uint32_t i = side * steps[0];
            add_segment(m, number[i * columns + j], number[i * columns + j + 1]);
        }
}

/* Lists the places of the triangulation and its segments. */
static enum gd_status list_places(struct meshing *m)
{
    const struct gd__grid *grid = &m->t->grid;
    const struct gd__loops *loops = m->t->surface->loops;
    uint32_t nodes = gd__node_count(grid);
    size_t border = 2 * ((size_t)grid->steps[0] + grid->steps[1]), most = m->samples.count + nodes;
    m->uv = gd__arena_take(&m->arena, most, sizeof *m->uv);
    m->nodes = gd__arena_take(&m->arena, most, sizeof *m->nodes);
    m->segments = gd__arena_take(&m->arena, m->samples.count + border, sizeof *m->segments);
    if (m->arena.status) return m->arena.status;
    memcpy(m->uv, m->samples.at, m->samples.count * sizeof *m->uv);
    m->count = m->samples.count;
    for (uint32_t i = 0; i < loops->count; i++) {
        uint32_t first = m->samples.first[i], count = m->samples.first[i + 1] - first;
        for (uint32_t k = 0; k < count; k++) add_segment(m, first + k, first + (k + 1) % count);
    }
    for (uint32_t node = 0; node < nodes && gd__pace(&m->pace, 1); node++) {
        uint32_t i = node / (grid->steps[1] + 1), j = node % (grid->steps[1] + 1);
        bool is_kept = !loops->has_outer && is_border(grid, i, j);
        if (m->omitted[node] && !is_kept) continue;
        m->uv[m->count][0] = grid->at[0][i];
        m->uv[m->count][1] = grid->at[1][j];
        m->number_of[node] = m->count++;
    }
    if (!m->pace.status && !loops->has_outer) add_border(m);
    return m->pace.status;
}

static enum gd_status triangulate(struct meshing *m)
{
    const struct gd__grid *grid = &m->t->grid;
    const struct gd__loops *loops = m->t->surface->loops;
    struct gd__lattice lattice;
    double most = fmax(grid->steps[0], grid->steps[1]);
    for (int k = 0; k < 2; k++) {
        double width = fmax(grid->steps[k] / most, least_width);
        lattice.low[k] = loops->low[k];
        lattice.scale[k] = (double)GD__LATTICE_EXTENT * width / loops->width[k];
    }
    for (uint32_t i = 0; i < m->count; i++) m->nodes[i] = gd__lattice_round(&lattice, m->uv[i]);
    const struct gd__triangulation_input input = {
        m->nodes, m->count, (const uint32_t(*)[2])m->segments, m->segment_count};
    enum gd_status status = gd__loops_triangulate(&input, &m->pace, &m->found);
    return status == GD_RUNAWAY ? GD_INTERNAL : status;
}

/* Replaces a place by the representative of its point. On a seam, this is the place at the low end
 * of the closed direction. At a pole, it is the first place of the pole. */
static void represent(const struct gd_parametric *surface, double at[2])
{
    for (int k = 0; k < 2; k++) {
        const struct gd_axis *axis = surface->axis[k];
        if (axis->closed && at[k] == axis->high) at[k] = axis->low;
    }
    for (int k = 0; k < 2; k++)
        if (gd__surface_pole(surface, k, at[k])) at[1 - k] = surface->axis[1 - k]->low;
}

struct place {
    double at[2];
    uint32_t node;
};

static int by_place(const void *x, const void *y)
{
    const struct place *p = x, *q = y;
    for (int k = 0; k < 2; k++)
        if (p->at[k] != q->at[k]) return p->at[k] < q->at[k] ? -1 : 1;
    return p->node < q->node ? -1 : p->node > q->node;
}

/* Creates one vertex for all nodes that are the same point of the surface. */
static enum gd_status make_vertices(struct meshing *m)
{
    struct gd_tessellation *t = m->t;
    struct place *places = gd__arena_take(&m->arena, t->node_count, sizeof *places);
    if (!places) return m->arena.status;
    for (uint32_t i = 0; i < t->node_count; i++) {
        memcpy(places[i].at, t->node_uv[i], sizeof places[i].at);
        represent(t->surface, places[i].at);
        places[i].node = i;
    }
    qsort(places, t->node_count, sizeof *places, by_place);
    for (uint32_t i = 0; i < t->node_count && gd__pace(&m->pace, GD__STEP / 4); i++) {
        const double *at = places[i].at;
        if (i == 0 || memcmp(at, places[i - 1].at, sizeof places[i].at) != 0) {
            struct gd_vec3 x = gd__surface_position(t->surface, at);
            uint32_t vertex = t->polygons.position_count++;
            memcpy(t->polygons.positions[vertex], (double[3]){x.x, x.y, x.z},
                   sizeof *t->polygons.positions);
            t->node_of[vertex] = places[i].node;
        }
        t->vertex_of[places[i].node] = t->polygons.position_count - 1;
    }
    return m->pace.status;
}

static void make_faces(struct gd_tessellation *t, const struct gd__triangulation *found)
{
    for (uint32_t f = 0; f < found->count; f++) {
        const uint32_t *nodes = found->triangles[f];
        uint32_t *corner = t->polygons.corners + 3 * (size_t)t->polygons.polygon_count;
        for (int k = 0; k < 3; k++) corner[k] = t->vertex_of[nodes[k]];
        if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) continue;
        memcpy(t->corners[t->polygons.polygon_count++], nodes, 3 * sizeof *nodes);
    }
}

/* Creates a node for each place that is a corner of a triangle, and renumbers these places. */
static enum gd_status take_nodes(struct meshing *m)
{
    struct gd_tessellation *t = m->t;
    uint32_t *number = gd__arena_take(&m->arena, m->count, sizeof *number);
    gd__tessellation_take_nodes(t, m->count);
    gd__tessellation_take_faces(t, m->found.count);
    t->node_uv = gd__arena_take(&t->arena, m->count, sizeof *t->node_uv);
    if (!number || t->arena.status) return number ? t->arena.status : m->arena.status;
    memset(number, 0xff, m->count * sizeof *number);
    for (uint32_t f = 0; f < m->found.count && gd__pace(&m->pace, 1); f++)
        for (int k = 0; k < 3; k++) {
            uint32_t *corner = &m->found.triangles[f][k];
            if (number[*corner] == UINT32_MAX) {
                memcpy(t->node_uv[t->node_count], m->uv[*corner], sizeof *t->node_uv);
                number[*corner] = t->node_count++;
            }
            *corner = number[*corner];
        }
    return m->pace.status;
}

enum gd_status gd__tessellation_trim(struct gd_tessellation *t, const struct gd_control *control)
{
    struct meshing m = {
        .t = t, .arena.budget.control = control, .pace = {.control = control, .fraction = 0.2}};
    const struct gd__grid *grid = &t->grid;
    double longest = fmin(1.0 / grid->steps[0], 1.0 / grid->steps[1]);
    enum gd_status status = gd__loops_sample(t->surface->loops, longest, &m.pace, &m.samples);
    if (!status) status = omit_nodes(&m);
    if (!status) status = list_places(&m);
    if (!status) status = triangulate(&m);
    if (!status) status = take_nodes(&m);
    if (!status) status = make_vertices(&m);
    if (!status) make_faces(t, &m.found);
    if (!status && !t->polygons.polygon_count) status = GD_INTERNAL;
    gd__loop_samples_free(&m.samples);
    free(m.found.triangles);
    gd__arena_free(&m.arena);
    return status;
}
