/* Builds the sides of the edges. Computes their numbers from the faces' neighbours, and their
 * frames from the positions of the corners. */
#include <math.h>
#include <stdatomic.h>

#include "base/slices.h"
#include "construction/steps.h"
#include "construction/offenders.h"
#include "mesh/triangle.h"

static struct gd__triangle sides_measure(const struct gd_mesh *mesh, const uint32_t corner[3])
{
    struct gd_vec3 a = mesh->position[corner[0]], b = mesh->position[corner[1]],
                   c = mesh->position[corner[2]];
    return gd__triangle_measure(gd_vec3_sub(b, a), gd_vec3_sub(c, b), gd_vec3_sub(a, c));
}

/* Computes the frame of side k of the triangle. The apex is the start of side k - 1 and the end of
 * side k + 1. */
static void frame_side(const struct gd__triangle *t, uint32_t k, struct gd_side *side)
{
    uint32_t after = gd__next_corner(k), before = gd__previous_corner(k);
    double left_scale = 1 / (t->length[k] * t->length[before]),
           right_scale = 1 / (t->length[k] * t->length[after]);
    side->length = t->length[k];
    side->left_length = t->length[before];
    side->right_length = t->length[after];
    side->left_x = -gd_vec3_dot(t->edge[k], t->edge[before]) * left_scale;
    side->left_y = t->double_area * left_scale;
    side->right_x = -gd_vec3_dot(t->edge[k], t->edge[after]) * right_scale;
    side->right_y = -t->double_area * right_scale;
}

/* Computes the sides of a face, and stores the face's measures. Each side is written by one face
 * only. */
static struct gd__triangle make_face(struct gd__construction *work, uint32_t face)
{
    struct gd_mesh *mesh = work->mesh;
    const uint32_t *h = mesh->face_side[face];
    struct gd__triangle t = sides_measure(mesh, work->corner[face]);
    double shortest = HUGE_VAL;
    for (uint32_t k = 0; k < 3; k++) {
        struct gd_side *side = &mesh->side[h[k]];
        frame_side(&t, k, side);
        side->left = h[gd__previous_corner(k)] ^ 1;
        side->right = h[gd__next_corner(k)] ^ 1;
        if (mesh->side_face[h[k] ^ 1] == GD_NONE)
            mesh->side[h[k] ^ 1] =
                (struct gd_side){.length = side->length, .left = GD_NONE, .right = GD_NONE};
        if (h[k] % 2 == 0) work->edge_length[h[k] / 2] = side->length;
        if (side->length < shortest) shortest = side->length;
    }
    work->measure[face] = (struct gd__face_measure){t.double_area, shortest};
    return t;
}

struct face_making {
    struct gd__construction *work;
    atomic_uint degenerate, flat; /* numbers of faces */
};

static void make_faces(void *context, struct gd__pace *pace, uint32_t begin, uint32_t end)
{
    struct face_making *making = context;
    unsigned degenerate = 0, flat = 0;
    (void)pace;
    for (uint32_t f = begin; f < end; f++) {
        struct gd__triangle t = make_face(making->work, f);
        degenerate += gd__triangle_flatness(&t) < GD_TOL_CAP;
        flat += gd__triangle_flatness(&t) < GD_TOL_FLAT;
    }
    atomic_fetch_add(&making->degenerate, degenerate);
    atomic_fetch_add(&making->flat, flat);
}

/* Counts the edges. The lower-numbered face of edge e has side 2e. The other face, if there is one,
 * has side 2e + 1. */
static uint32_t count_edges(struct gd__construction *work)
{
    uint32_t count = 0;
    /* this is also true at the boundary, where the neighbour is GD_NONE */
    GD__PACED (&work->pace, s, 3 * work->mesh->face_count) count += work->neighbour[s] > s;
    return count;
}

static void number_sides(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    uint32_t edge = 0;
    GD__PACED (&work->pace, s, 3 * mesh->face_count) {
        uint32_t face = s / 3, k = s % 3, across = work->neighbour[s];
        uint32_t side = across > s ? 2 * edge++ : mesh->face_side[across / 3][across % 3] ^ 1;
        mesh->face_side[face][k] = side;
        mesh->origin[side] = work->corner[face][k];
        mesh->side_face[side] = face;
        if (across != GD_NONE) continue;
        mesh->origin[side ^ 1] = work->corner[face][gd__next_corner(k)];
        mesh->side_face[side ^ 1] = GD_NONE;
    }
}

/* Returns the input index of a corner. */
static uint32_t named(const struct gd_mesh *mesh, uint32_t vertex)
{
    return gd_mesh_original(mesh, (struct gd_vertex){mesh->index_of_vertex[vertex]}).index;
}

static void find_flat_faces(struct gd__construction *work, struct gd__offenders *flat)
{
    GD__PACED (&work->pace, f, work->mesh->face_count) {
        struct gd__triangle t = sides_measure(work->mesh, work->corner[f]);
        if (gd__triangle_flatness(&t) < GD_TOL_FLAT)
            gd__offenders_add(flat, gd__input_polygon(work->mesh, f), 0, f);
    }
}

static enum gd_status refuse_flat_faces(const struct gd__construction *work,
                                        const struct gd__offenders *flat)
{
    const struct gd_mesh *mesh = work->mesh;
    const uint32_t *corner = work->corner[flat->lowest[0].witness];
    gd_fail(work->detail, GD_DEGENERATE_FACE,
            "face %u has no area: its vertices %u, %u and %u lie on one line; %s",
            (unsigned)flat->lowest[0].a, named(mesh, corner[0]), named(mesh, corner[1]),
            named(mesh, corner[2]),
            work->options.repair_split
                ? "repair found no way to mend it, welding near vertices (weld=) may be one"
                : "remove it, or flip its longest edge");
    return gd__offenders_report(flat, GD_ELEMENT_FACE, GD_DEGENERATE_FACE, work->detail);
}

/* Allocates the array, or takes over that of the triangles of the input, which no later step
 * reads. */
static void allocate_face_sides(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    struct gd_polygons *consumed = work->consumed;
    if (!consumed || work->triangle[0] != consumed->corners) {
        mesh->face_side = gd__mesh_array(work, mesh->face_count, sizeof *mesh->face_side);
        return;
    }
    mesh->face_side = work->triangle;
    mesh->bytes += mesh->face_count * sizeof *mesh->face_side;
    work->triangle = NULL;
    consumed->corners = NULL;
}

enum gd_status gd__make_sides(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    mesh->edge_count = count_edges(work);
    size_t sides = 2 * (size_t)mesh->edge_count;
    struct gd__loan *loan = &work->until_fans;
    mesh->origin = gd__mesh_array(work, sides, sizeof *mesh->origin);
    mesh->side_face = gd__mesh_array(work, sides, sizeof *mesh->side_face);
    allocate_face_sides(work);
    work->measure = gd__scratch_array(work, loan, mesh->face_count, sizeof *work->measure);
    work->edge_length = gd__scratch_array(work, loan, mesh->edge_count, sizeof *work->edge_length);
    if (!mesh->origin || !mesh->side_face || !mesh->face_side || !work->measure ||
        !work->edge_length)
        return GD_NO_MEMORY;
    number_sides(work);
    mesh->side = gd__take_back(work, &work->until_sides, sides, sizeof *mesh->side);
    if (!mesh->side) return GD_NO_MEMORY;
    struct face_making making = {.work = work};
    gd__slices_run(&work->pace, mesh->face_count, make_faces, &making);
    struct gd__offenders flat = {0};
    if (making.flat) find_flat_faces(work, &flat);
    if (flat.total) return refuse_flat_faces(work, &flat);
    mesh->summary.degenerate_faces = making.degenerate;
    /* the order of the sum must not depend on the threads */
    GD__PACED (&work->pace, f, mesh->face_count)
        mesh->summary.area += work->measure[f].double_area / 2;
    mesh->summary.area *= mesh->unit * mesh->unit;
    return GD_OK;
}
