/* Lists the faces around each vertex, counter-clockwise, with their angles. */
#include "construction/steps.h"

/* Returns the next outgoing side counter-clockwise around the vertex; at the end of an open fan the
 * boundary side. */
static uint32_t next_in_fan(const struct gd_mesh *mesh, uint32_t side)
{
    return mesh->side[side].left;
}

/* Returns the side where the fan of the origin of `side` starts: at the boundary if there is one,
 * otherwise `side` itself. */
static uint32_t fan_start(struct gd__construction *work, uint32_t side)
{
    const struct gd_mesh *mesh = work->mesh;
    for (uint32_t h = side; gd__pace(&work->pace, 1);) {
        if (gd__side_is_boundary(mesh, h ^ 1)) return h;
        h = gd__side_next(mesh, h ^ 1);
        if (h == side) break;
    }
    return side;
}

static enum gd_vertex_kind fans_kind_of(double total_angle, bool open)
{
    if (open) return GD_VERTEX_BOUNDARY;
    return total_angle > 2 * M_PI + GD_TOL_SADDLE ? GD_VERTEX_SADDLE : GD_VERTEX_CONVEX;
}

/* Returns the corner behind the edge that is opposite to the origin of a side in its face. */
static uint32_t corner_beyond(const struct gd_mesh *mesh, uint32_t side)
{
    uint32_t across = mesh->side[side].right;
    return gd__side_is_boundary(mesh, across) ? GD_NONE : gd__side_apex(mesh, across);
}

/* Writes the fan that begins at `start` to the entries from `first` on. Returns the end. */
static uint32_t write_fan(struct gd__construction *work, uint32_t start, uint32_t first)
{
    struct gd_mesh *mesh = work->mesh;
    uint32_t vertex = mesh->origin[start], entry = first, h = start;
    double angle = 0;
    do {
        mesh->fan[entry] = (struct gd_fan){angle, h, gd__side_destination(mesh, h)};
        mesh->beyond[entry] = corner_beyond(mesh, h);
        mesh->side_fan[h] = entry++;
        angle += atan2(mesh->side[h].left_y, mesh->side[h].left_x);
        h = next_in_fan(mesh, h);
    } while (h != start && !gd__side_is_boundary(mesh, h) && gd__pace(&work->pace, 1));
    mesh->total_angle[vertex] = angle;
    mesh->vertex_kind[vertex] = (uint8_t)fans_kind_of(angle, h != start);
    mesh->summary.saddle_vertices += mesh->vertex_kind[vertex] == GD_VERTEX_SADDLE;
    return entry;
}

/* Stores in fan_first, for each vertex, an outgoing side that has a face. The fans are then written
 * in the order of the vertices. */
static void find_any_side(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    GD__PACED (&work->pace, done, mesh->face_count) {
        uint32_t f = mesh->face_count - 1 - done;
        for (int k = 0; k < 3; k++) mesh->fan_first[work->corner[f][k]] = mesh->face_side[f][k];
    }
}

enum gd_status gd__make_fans(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    mesh->fan_first = gd__mesh_array(mesh, (size_t)mesh->vertex_count + 1, sizeof *mesh->fan_first);
    mesh->fan = gd__mesh_array(mesh, 3 * (size_t)mesh->face_count, sizeof *mesh->fan);
    mesh->beyond = gd__mesh_array(mesh, 3 * (size_t)mesh->face_count, sizeof *mesh->beyond);
    mesh->side_fan = gd__mesh_array(mesh, 2 * (size_t)mesh->edge_count, sizeof *mesh->side_fan);
    mesh->total_angle = gd__mesh_array(mesh, mesh->vertex_count, sizeof *mesh->total_angle);
    mesh->vertex_kind = gd__mesh_array(mesh, mesh->vertex_count, sizeof *mesh->vertex_kind);
    if (!mesh->fan_first || !mesh->fan || !mesh->beyond || !mesh->side_fan || !mesh->total_angle ||
        !mesh->vertex_kind)
        return GD_NO_MEMORY;
    find_any_side(work);
    uint32_t entry = 0;
    GD__PACED (&work->pace, v, mesh->vertex_count) {
        uint32_t start = fan_start(work, mesh->fan_first[v]);
        mesh->fan_first[v] = entry;
        entry = write_fan(work, start, entry);
    }
    mesh->fan_first[mesh->vertex_count] = entry;
    if (entry != 3 * mesh->face_count)
        return gd_fail(work->detail, GD_INTERNAL, "the fans do not cover all face corners");
    return GD_OK;
}
