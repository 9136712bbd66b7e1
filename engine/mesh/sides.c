/* The sides of the edges: connectivity from the half-edge kernel, frames from the corners' positions. */
#include "mesh/build.h"
#include "mesh/halfedges.h"
#include "mesh/offenders.h"

/* A face: its sides as vectors, as they run, their lengths, and twice its area. */
struct triangle {
    struct gd_vec3 edge[3];
    double length[3];
    double double_area;
};

static struct triangle measure(const struct gd_mesh *mesh, const uint32_t corner[3])
{
    struct triangle t;
    for (uint32_t k = 0; k < 3; k++) {
        t.edge[k] = gd_vec3_sub(mesh->position[corner[gd__next_corner(k)]], mesh->position[corner[k]]);
        t.length[k] = gd_vec3_length(t.edge[k]);
    }
    /* the cross product of the two shorter edges is the most accurate one */
    uint32_t longest = t.length[1] > t.length[0] ? 1 : 0;
    if (t.length[2] > t.length[longest]) longest = 2;
    t.double_area =
        gd_vec3_length(gd_vec3_cross(t.edge[gd__next_corner(longest)], t.edge[gd__previous_corner(longest)]));
    return t;
}

/* Side k of the triangle: its frame sees the apex at the end of the side before it and at the start of the side after
 * it. */
static void frame_side(const struct triangle *t, uint32_t k, struct gd_side *side)
{
    uint32_t after = gd__next_corner(k), before = gd__previous_corner(k);
    double left_scale = 1 / (t->length[k] * t->length[before]), right_scale = 1 / (t->length[k] * t->length[after]);
    side->length = t->length[k];
    side->left_length = t->length[before];
    side->right_length = t->length[after];
    side->left_x = -gd_vec3_dot(t->edge[k], t->edge[before]) * left_scale;
    side->left_y = t->double_area * left_scale;
    side->right_x = -gd_vec3_dot(t->edge[k], t->edge[after]) * right_scale;
    side->right_y = -t->double_area * right_scale;
}

/* Height over the longest edge, relative to that edge. */
static double flatness(const struct triangle *t)
{
    double longest = fmax(fmax(t->length[0], t->length[1]), t->length[2]);
    return t->double_area / (longest * longest);
}

static void make_face(struct gd__construction *work, uint32_t face, struct gd__offenders *flat)
{
    struct gd_mesh *mesh = work->mesh;
    const uint32_t *h = mesh->face_side[face];
    struct triangle t = measure(mesh, work->corner[face]);
    for (uint32_t k = 0; k < 3; k++) {
        struct gd_side *side = &mesh->side[h[k]];
        frame_side(&t, k, side);
        side->left = h[gd__previous_corner(k)] ^ 1;
        side->right = h[gd__next_corner(k)] ^ 1;
        if (mesh->side_face[h[k] ^ 1] == GD_NONE)
            mesh->side[h[k] ^ 1] = (struct gd_side){.length = side->length, .left = GD_NONE, .right = GD_NONE};
    }
    mesh->summary.area += t.double_area / 2;
    mesh->summary.degenerate_faces += flatness(&t) < GD_TOL_CAP;
    if (flatness(&t) < GD_TOL_FLAT) gd__offenders_add(flat, gd__input_polygon(mesh, face), 0, face);
}

/* Finds each face's sides among all: side k starts at corner k. */
static void collect_face_sides(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    for (uint32_t h = 0; h < 2 * mesh->edge_count; h++) {
        uint32_t face = mesh->side_face[h];
        if (face == GD_NONE) continue;
        const uint32_t *corner = work->corner[face];
        mesh->face_side[face][corner[0] == mesh->origin[h] ? 0 : corner[1] == mesh->origin[h] ? 1 : 2] = h;
    }
}

static enum gd_status take_halfedges(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    struct gd__halfedges halfedges = {0};
    enum gd_status status =
        gd__halfedges_connect((const uint32_t(*)[3])work->corner, mesh->face_count, mesh->vertex_count, work->control,
                              work->begun, work->until, &halfedges);
    if (status) return status;
    mesh->origin = halfedges.origin;
    mesh->side_face = halfedges.face;
    mesh->edge_count = halfedges.edge_count;
    mesh->bytes += 2 * (size_t)mesh->edge_count * (sizeof *mesh->origin + sizeof *mesh->side_face);
    if (halfedges.failed_faces)
        return gd_fail(work->detail, GD_INTERNAL,
                       "%u faces could not be connected although the mesh was found to be manifold",
                       halfedges.failed_faces);
    return GD_OK;
}

static enum gd_status refuse_flat_faces(const struct gd__construction *work, const struct gd__offenders *flat)
{
    const uint32_t *corner = work->corner[flat->lowest[0].witness], *index = work->mesh->index_of_vertex;
    gd_fail(work->detail, GD_DEGENERATE_FACE,
            "face %u has no area: its vertices %u, %u and %u lie on one line; remove it, or flip its longest edge",
            (unsigned)flat->lowest[0].a, index[corner[0]], index[corner[1]], index[corner[2]]);
    return gd__offenders_report(flat, GD_ELEMENT_FACE, GD_DEGENERATE_FACE, work->detail);
}

enum gd_status gd__make_sides(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    enum gd_status status = take_halfedges(work);
    if (status) return status;
    mesh->side = gd__mesh_sides(mesh, 2 * (size_t)mesh->edge_count);
    mesh->face_side = gd__mesh_array(mesh, mesh->face_count, sizeof *mesh->face_side);
    if (!mesh->side || !mesh->face_side) return GD_NO_MEMORY;
    collect_face_sides(work);
    struct gd__offenders flat = {0};
    for (uint32_t f = 0; f < mesh->face_count; f++) make_face(work, f, &flat);
    if (flat.total) return refuse_flat_faces(work, &flat);
    mesh->summary.area *= mesh->unit * mesh->unit;
    return GD_OK;
}
