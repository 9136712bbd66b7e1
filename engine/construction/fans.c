/* Lists the faces around each vertex, counter-clockwise, with their angles. */
#include <stdatomic.h>

#include "base/slices.h"
#include "construction/steps.h"

/* Returns the side where the fan of the origin of `side` starts: at the boundary if there is one,
 * otherwise `side` itself. */
static uint32_t fan_start(const struct gd_mesh *mesh, uint32_t side, struct gd__pace *pace)
{
    for (uint32_t h = side; gd__pace(pace, 1);) {
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

/* Let e be the edge opposite to the origin of a side in the side's face. Returns the apex of the
 * face on the other side of e, or GD_NONE at the boundary. */
static uint32_t corner_beyond(const struct gd_mesh *mesh, uint32_t side)
{
    uint32_t across = mesh->side[side].right;
    return gd__side_is_boundary(mesh, across) ? GD_NONE : gd__side_apex(mesh, across);
}

/* Writes the fan that begins at `start` to the entries from `first` on. Returns the end. */
static uint32_t write_fan(struct gd_mesh *mesh, uint32_t start, uint32_t first,
                          struct gd__pace *pace)
{
    uint32_t vertex = mesh->origin[start], entry = first, h = start;
    double angle = 0;
    do {
        mesh->fan[entry] = (struct gd_fan){angle, h, gd__side_destination(mesh, h)};
        mesh->beyond[entry++] = corner_beyond(mesh, h);
        angle += atan2(mesh->side[h].left_y, mesh->side[h].left_x);
        h = mesh->side[h].left; /* at the end of an open fan, this is the boundary side */
    } while (h != start && !gd__side_is_boundary(mesh, h) && gd__pace(pace, 1));
    mesh->total_angle[vertex] = angle;
    mesh->vertex_kind[vertex] = (uint8_t)fans_kind_of(angle, h != start);
    return entry;
}

struct fan_making {
    const struct gd__construction *work;
    atomic_uint saddles;    /* number of vertices */
    atomic_bool is_damaged; /* true if a fan lacks corners of its vertex */
};

static void make_fans(void *context, struct gd__pace *pace, uint32_t begin, uint32_t end)
{
    struct fan_making *making = context;
    struct gd_mesh *mesh = making->work->mesh;
    const uint32_t *sides = mesh->face_side[0];
    unsigned saddles = 0;
    for (uint32_t v = begin; v < end; v++) {
        uint32_t start = fan_start(mesh, sides[making->work->any_corner[v]], pace);
        if (write_fan(mesh, start, mesh->fan_first[v], pace) != mesh->fan_first[v + 1])
            atomic_store_explicit(&making->is_damaged, true, memory_order_relaxed);
        saddles += mesh->vertex_kind[v] == GD_VERTEX_SADDLE;
    }
    atomic_fetch_add(&making->saddles, saddles);
}

enum gd_status gd__make_fans(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    struct fan_making making = {.work = work};
    mesh->fan =
        gd__take_back(work, &work->until_fans, 3 * (size_t)mesh->face_count, sizeof *mesh->fan);
    mesh->beyond = gd__mesh_array(work, 3 * (size_t)mesh->face_count, sizeof *mesh->beyond);
    mesh->total_angle = gd__mesh_array(work, mesh->vertex_count, sizeof *mesh->total_angle);
    mesh->vertex_kind = gd__mesh_array(work, mesh->vertex_count, sizeof *mesh->vertex_kind);
    if (!mesh->fan || !mesh->beyond || !mesh->total_angle || !mesh->vertex_kind)
        return GD_NO_MEMORY;
    gd__slices_run(&work->pace, mesh->vertex_count, make_fans, &making);
    mesh->summary.saddle_vertices = making.saddles;
    return making.is_damaged
               ? gd_fail(work->detail, GD_INTERNAL, "the fans do not cover all face corners")
               : GD_OK;
}
