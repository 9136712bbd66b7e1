/* Computes properties of the whole mesh: components, boundary loops, Euler characteristic,
 * extents. */
#include <stdlib.h>

#include "base/large.h"
#include "construction/steps.h"

static enum gd_status label_vertices(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    mesh->vertex_component =
        gd__mesh_array(work, mesh->vertex_count, sizeof *mesh->vertex_component);
    if (!mesh->vertex_component) return GD_NO_MEMORY;
    GD__PACED (&work->pace, f, mesh->face_count) {
        for (int k = 0; k < 3; k++) mesh->vertex_component[work->corner[f][k]] = work->component[f];
    }
    return GD_OK;
}

static enum gd_status count_components(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    mesh->component = gd__mesh_array(work, work->component_count, sizeof *mesh->component);
    if (!mesh->component) return GD_NO_MEMORY;
    GD__PACED (&work->pace, f, mesh->face_count) {
        struct gd_component *component = &mesh->component[work->component[f]];
        component->faces++;
        component->grain += work->measure[f].shortest_edge;
    }
    GD__PACED (&work->pace, v, mesh->vertex_count)
        mesh->component[mesh->vertex_component[v]].vertices++;
    GD__PACED (&work->pace, e, mesh->edge_count)
        mesh->component[mesh->vertex_component[mesh->origin[2 * e]]].edges++;
    GD__PACED (&work->pace, c, work->component_count)
        mesh->component[c].grain /= mesh->component[c].faces;
    return GD_OK;
}

/* Returns the boundary side that starts at a boundary vertex and closes its fan. */
static uint32_t boundary_side_from(const struct gd_mesh *mesh, uint32_t vertex)
{
    return mesh->side[mesh->fan[mesh->fan_first[vertex + 1] - 1].side].left;
}

/* Measures the boundary loop that contains the side `start`, and marks its vertices. */
static struct gd_boundary walk_loop(struct gd__construction *work, uint32_t start, uint8_t *visited)
{
    const struct gd_mesh *mesh = work->mesh;
    struct gd_boundary loop = {0};
    uint32_t side = start;
    do {
        visited[mesh->origin[side]] = 1;
        loop.vertices++;
        loop.length += mesh->side[side].length;
        side = boundary_side_from(mesh, gd__side_destination(mesh, side));
    } while (side != start && gd__pace(&work->pace, 1));
    loop.length *= mesh->unit;
    return loop;
}

/* Measures the boundary loops in the order of their lowest input index. */
static void walk_loops(struct gd__construction *work, uint8_t *visited)
{
    struct gd_mesh *mesh = work->mesh;
    for (uint32_t i = 0; i < mesh->summary.index_count && gd__pace(&work->pace, 1); i++) {
        uint32_t v = mesh->vertex_of_index[i];
        if (v == GD_NONE || visited[v] || mesh->vertex_kind[v] != GD_VERTEX_BOUNDARY) continue;
        uint32_t side = boundary_side_from(mesh, v), loop = mesh->summary.boundaries++;
        mesh->boundary_side[loop] = side;
        mesh->boundary[loop] = walk_loop(work, side, visited);
        mesh->component[mesh->vertex_component[v]].boundaries++;
    }
}

static enum gd_status find_boundaries(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    uint32_t boundary_vertices = 0;
    GD__PACED (&work->pace, v, mesh->vertex_count)
        boundary_vertices += mesh->vertex_kind[v] == GD_VERTEX_BOUNDARY;
    uint32_t most_loops = boundary_vertices / 3;
    mesh->boundary = gd__mesh_array(work, most_loops, sizeof *mesh->boundary);
    mesh->boundary_side = gd__mesh_array(work, most_loops, sizeof *mesh->boundary_side);
    uint8_t *visited = gd__large_zeroed(mesh->vertex_count, sizeof *visited);
    if (mesh->boundary && mesh->boundary_side && visited) walk_loops(work, visited);
    enum gd_status status = mesh->boundary && mesh->boundary_side && visited ? GD_OK : GD_NO_MEMORY;
    free(visited);
    return status;
}

static void measure_edges(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    double least = INFINITY, most = 0, sum = 0;
    GD__PACED (&work->pace, e, mesh->edge_count) {
        double length = work->edge_length[e];
        if (length < least) least = length;
        if (length > most) most = length;
        sum += length;
    }
    mesh->summary.edge_length.min = least * mesh->unit;
    mesh->summary.edge_length.mean = sum / mesh->edge_count * mesh->unit;
    mesh->summary.edge_length.max = most * mesh->unit;
}

/* Computes the Euler characteristic chi = V - E + F, and the genus from chi = 2 - 2 genus -
 * boundaries, which holds for each orientable component. */
static void sum_up(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    struct gd_mesh_summary *s = &mesh->summary;
    GD__PACED (&work->pace, i, s->index_count)
        s->unreferenced_vertices += mesh->vertex_of_index[i] == GD_NONE;
    s->vertices = mesh->vertex_count;
    s->faces = mesh->face_count;
    s->edges = mesh->edge_count;
    s->components = work->component_count;
    s->euler_characteristic = (int64_t)s->vertices - s->edges + s->faces;
    s->genus = (2 * (int64_t)s->components - s->euler_characteristic - s->boundaries) / 2;
}

enum gd_status gd__measure(struct gd__construction *work)
{
    enum gd_status status = label_vertices(work);
    if (!status) status = count_components(work);
    if (!status) measure_edges(work);
    return status;
}

enum gd_status gd__summarise(struct gd__construction *work)
{
    enum gd_status status = find_boundaries(work);
    if (!status) sum_up(work);
    return status;
}
