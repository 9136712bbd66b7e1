#include "nurbs/tessellation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void gd__tessellation_take_nodes(struct gd_tessellation *t, size_t nodes)
{
    t->vertex_of = gd__arena_take(&t->arena, nodes, sizeof *t->vertex_of);
    t->node_of = gd__arena_take(&t->arena, nodes, sizeof *t->node_of);
    t->polygons.positions = gd__arena_take(&t->arena, nodes, sizeof *t->polygons.positions);
}

void gd__tessellation_take_faces(struct gd_tessellation *t, size_t faces)
{
    t->polygons.corners = gd__arena_take(&t->arena, 3 * faces, sizeof *t->polygons.corners);
    t->corners = gd__arena_take(&t->arena, faces, sizeof *t->corners);
}

/* --- nodes to vertices ------------------------------------------------------------------------ */

/* Returns the first node among all nodes at the same point. */
static uint32_t representative(const struct gd_parametric *surface, const struct gd__grid *grid,
                               uint32_t node)
{
    uint32_t columns = grid->steps[1] + 1, at[2] = {node / columns, node % columns};
    for (int k = 0; k < 2; k++)
        if (surface->axis[k]->closed && at[k] == grid->steps[k]) at[k] = 0;
    for (int k = 0; k < 2; k++) {
        const struct gd_axis *axis = surface->axis[k];
        if ((axis->pole_low && at[k] == 0) || (axis->pole_high && at[k] == grid->steps[k]))
            at[1 - k] = 0;
    }
    return at[0] * columns + at[1];
}

static enum gd_status make_vertices(struct gd_tessellation *t, const struct gd_control *control)
{
    uint32_t nodes = gd__node_count(&t->grid);
    gd__tessellation_take_nodes(t, nodes);
    enum gd_status status = t->arena.status;
    if (status) return status;
    for (uint32_t node = 0; node < nodes; node++) {
        uint32_t first = representative(t->surface, &t->grid, node);
        if (first != node) {
            t->vertex_of[node] = t->vertex_of[first];
            continue;
        }
        if (node % 1024 == 0 && (status = gd_control_check(control, 0.3 * node / nodes)))
            return status;
        double at[2];
        gd__node_parameters(t, node, at);
        struct gd_vec3 x = gd__surface_position(t->surface, at);
        uint32_t vertex = t->polygons.position_count++;
        memcpy(t->polygons.positions[vertex], (double[3]){x.x, x.y, x.z},
               sizeof *t->polygons.positions);
        t->vertex_of[node] = vertex;
        t->node_of[vertex] = node;
    }
    return GD_OK;
}

/* --- cells to faces --------------------------------------------------------------------------- */

static double tessellation_apart(const struct gd_tessellation *t, uint32_t a, uint32_t b)
{
    const double *p = t->polygons.positions[t->vertex_of[a]],
                 *q = t->polygons.positions[t->vertex_of[b]];
    return sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) +
                (p[2] - q[2]) * (p[2] - q[2]));
}

/* Adds a face between three nodes, unless two of them are the same vertex, as at a pole. */
static void add_face(struct gd_tessellation *t, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t nodes[3] = {a, b, c},
             *corner = t->polygons.corners + 3 * (size_t)t->polygons.polygon_count;
    for (int i = 0; i < 3; i++) corner[i] = t->vertex_of[nodes[i]];
    if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) return;
    memcpy(t->corners[t->polygons.polygon_count++], nodes, sizeof nodes);
}

/* Adds the two triangles of a cell, divided along its shorter diagonal. At a pole, adds only one
 * triangle. */
static void fill_cell(struct gd_tessellation *t, uint32_t i, uint32_t j)
{
    uint32_t columns = t->grid.steps[1] + 1, a = i * columns + j, b = a + columns, c = b + 1,
             d = a + 1;
    if (tessellation_apart(t, a, c) <= tessellation_apart(t, b, d)) {
        add_face(t, a, b, c);
        add_face(t, a, c, d);
    } else {
        add_face(t, a, b, d);
        add_face(t, b, c, d);
    }
}

static enum gd_status make_faces(struct gd_tessellation *t, const struct gd_control *control)
{
    uint32_t cells = t->grid.steps[0] * t->grid.steps[1];
    gd__tessellation_take_faces(t, 2 * (size_t)cells);
    t->first_face = gd__arena_take(&t->arena, cells + (size_t)1, sizeof *t->first_face);
    enum gd_status status = t->arena.status;
    if (status) return status;
    for (uint32_t cell = 0; cell < cells; cell++) {
        if (cell % 4096 == 0 && (status = gd_control_check(control, 0.3))) return status;
        t->first_face[cell] = t->polygons.polygon_count;
        fill_cell(t, cell / t->grid.steps[1], cell % t->grid.steps[1]);
    }
    t->first_face[cells] = t->polygons.polygon_count;
    return GD_OK;
}

enum gd_status gd_tessellation_build(const struct gd_parametric *surface,
                                     const struct gd_tessellation_options *options,
                                     const struct gd_control *control, struct gd_tessellation **out,
                                     struct gd_detail *detail)
{
    if (options && (options->steps[0] || options->steps[1]) &&
        (options->steps[0] < GD_TESSELLATION_STEPS_LEAST ||
         options->steps[1] < GD_TESSELLATION_STEPS_LEAST))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "a tessellation has at least %d steps in each direction",
                       GD_TESSELLATION_STEPS_LEAST);
    if (options && (options->faces > GD_TESSELLATION_FACES_MAX || !(options->deviation >= 0)))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "a tessellation has at most %d faces and a deviation that is not negative",
                       GD_TESSELLATION_FACES_MAX);
    struct gd_tessellation *t = calloc(1, sizeof *t);
    if (!t) return gd_fail_status(detail, GD_NO_MEMORY);
    t->surface = gd_parametric_retain(surface);
    t->arena.budget.control = control;
    enum gd_status status = gd__grid_make(surface, options, &t->arena, &t->grid);
    if (!status && surface->loops) {
        status = gd__tessellation_trim(t, control);
    } else if (!status) {
        status = make_vertices(t, control);
        if (!status) status = make_faces(t, control);
    }
    if (status)
        gd_fail_status(detail, status);
    else
        status = gd_mesh_build(&t->polygons, NULL, control, &t->mesh, detail);
    t->arena.budget.control = NULL;
    if (status)
        gd_tessellation_release(t);
    else
        *out = t;
    return status;
}

void gd_tessellation_release(const struct gd_tessellation *tessellation)
{
    struct gd_tessellation *own = (struct gd_tessellation *)tessellation;
    if (!own) return;
    gd_parametric_release(own->surface);
    gd_mesh_release(own->mesh);
    gd__arena_free(&own->arena);
    free(own);
}

size_t gd_tessellation_memsize(const struct gd_tessellation *t)
{
    return sizeof *t + gd_mesh_memsize(t->mesh) + t->arena.budget.held;
}

const struct gd_parametric *gd_tessellation_surface(const struct gd_tessellation *tessellation)
{
    return tessellation->surface;
}

const struct gd_mesh *gd_tessellation_mesh(const struct gd_tessellation *tessellation)
{
    return tessellation->mesh;
}

const struct gd_polygons *gd_tessellation_polygons(const struct gd_tessellation *tessellation)
{
    return &tessellation->polygons;
}
