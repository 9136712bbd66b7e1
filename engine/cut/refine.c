#include "cut/refine.h"

#include "base/tolerance.h"
#include "cut/planar.h"
#include "mesh/triangle.h"
#include "mesh/union_find.h"

#define FACES_BETWEEN_CHECKS 1024

struct refining {
    const struct gd__arrangement *arrangement;
    const struct gd__seam *seam;
    struct gd__refined *refined;
    struct gd__planar planar;
    uint32_t *site_node; /* for each site of the current face, its node */
    /* for each piece of an edge, 3 * triangle + side of the first triangle that has this piece as a
       side, or GD_NONE if there is none yet */
    uint32_t *first_side;
    uint32_t site_capacity;
};

double gd__refined_share(const struct gd__refined *refined, uint32_t triangle)
{
    uint32_t face = refined->face[triangle];
    if (refined->in_face[face] == 1) return 1;
    struct gd__site site[3];
    for (int k = 0; k < 3; k++)
        site[k] = gd__node_site(refined->nodes, face, refined->node[triangle][k]);
    return (double)gd__site_area(site[0], site[1], site[2]) /
           ((double)GD__LATTICE * (double)GD__LATTICE);
}

static void positions_of(const struct gd__refined *refined, uint32_t triangle,
                         struct gd_vec3 corner[3])
{
    for (int k = 0; k < 3; k++) {
        const struct gd_point point = gd__node_point(refined->nodes, refined->node[triangle][k]);
        corner[k] = gd_point_position(refined->mesh, &point);
    }
}

/* --- joining ---------------------------------------------------------------------------------- */

/* Joins two triangles at a common side. The triangles traverse the side in opposite directions. */
static void cut_refine_join(struct gd__refined *refined, uint32_t t, uint32_t k, uint32_t other,
                            uint32_t m)
{
    gd__union_find_join(refined->region, t, other);
    gd__union_find_join(refined->vertex, 3 * t + k, 3 * other + gd__corner_after(m));
    gd__union_find_join(refined->vertex, 3 * t + gd__corner_after(k), 3 * other + m);
}

/* Side k of triangle t is `piece`. Joins t to the other triangle at this piece, unless the seam
 * separates them. */
static void join_at_piece(struct refining *refining, uint32_t t, uint32_t k, uint32_t piece)
{
    uint32_t first = refining->first_side[piece];
    if (first == GD_NONE)
        refining->first_side[piece] = 3 * t + k;
    else if (!refining->seam->is_cut[piece])
        cut_refine_join(refining->refined, t, k, first / 3, first % 3);
}

static uint32_t cut_refine_add(struct gd__refined *refined, uint32_t face, const uint32_t node[3])
{
    uint32_t t = refined->count++;
    for (int k = 0; k < 3; k++) refined->node[t][k] = node[k];
    refined->face[t] = face;
    refined->in_face[face]++;
    return t;
}

/* --- whole faces ------------------------------------------------------------------------------ */

static void keep_face(struct refining *refining, uint32_t face)
{
    const struct gd_mesh *mesh = refining->refined->mesh;
    const uint32_t *side = mesh->face_side[face];
    uint32_t t = cut_refine_add(
        refining->refined, face,
        (uint32_t[]){mesh->origin[side[0]], mesh->origin[side[1]], mesh->origin[side[2]]});
    for (uint32_t k = 0; k < 3; k++)
        join_at_piece(refining, t, k, refining->seam->first[side[k] / 2]);
}

/* --- crossed faces ---------------------------------------------------------------------------- */

/* Copies the face's nodes to the sites of the triangulation. */
static enum gd_status gather_sites(struct refining *refining, uint32_t face)
{
    const struct gd__nodes *nodes = &refining->arrangement->nodes;
    uint32_t count = 0, node;
    struct gd__node_walk walk = {0};
    enum gd_status status = GD_OK;
    while ((node = gd__nodes_walk(nodes, face, &walk)) != GD_NONE) {
        status = gd__arena_append(nodes->arena, &refining->site_node, &count,
                                  &refining->site_capacity, &node, sizeof node);
        if (status) return status;
    }
    status = gd__planar_begin(&refining->planar, count);
    for (uint32_t s = 0; s < count && !status; s++) {
        refining->planar.plane.sites[s] = gd__node_site(nodes, face, refining->site_node[s]);
        refining->planar.places[s] =
            gd__site_local(nodes->mesh, face, refining->planar.plane.sites[s]);
    }
    return status;
}

static uint32_t site_of(const struct refining *refining, uint32_t node)
{
    uint32_t s = 0;
    while (refining->site_node[s] != node) s++;
    return s;
}

static enum gd_status draw_segments(struct refining *refining, uint32_t face)
{
    const struct gd__segment *segments = refining->arrangement->segments;
    enum gd_status status = GD_OK;
    for (uint32_t s = refining->arrangement->of_face[face]; s != GD_NONE && !status;
         s = segments[s].next) {
        if (!refining->seam->is_cutting[s]) continue;
        status = gd__plane_fix(&refining->planar.plane, site_of(refining, segments[s].a),
                               site_of(refining, segments[s].b));
    }
    return status;
}

static bool is_flat(const struct gd__refined *refined, uint32_t t)
{
    struct gd_vec3 corner[3], edge[3];
    positions_of(refined, t, corner);
    for (int k = 0; k < 3; k++)
        edge[k] =
            gd_vec3_scale(gd_vec3_sub(corner[(k + 1) % 3], corner[k]), 1 / refined->mesh->unit);
    const struct gd__triangle triangle = gd__triangle_measure(edge[0], edge[1], edge[2]);
    return !(gd__triangle_flatness(&triangle) >= GD_TOL_FLAT);
}

/* Returns the piece of an edge that is side k of a triangle at the face's border. */
static uint32_t cut_refine_piece_of(const struct refining *refining, uint32_t face, uint32_t t,
                                    uint32_t k)
{
    const struct gd__refined *refined = refining->refined;
    uint32_t a = refined->node[t][k], b = refined->node[t][gd__corner_after(k)];
    uint32_t sides =
        gd__node_sides(refined->nodes, face, a) & gd__node_sides(refined->nodes, face, b);
    uint32_t edge = refined->mesh->face_side[face][sides & 1 ? 0 : sides & 2 ? 1 : 2] / 2;
    return gd__seam_piece(refining->seam, edge, a, b);
}

/* Joins triangle i of the face to neighbours with lower numbers, and to neighbours across the
 * face's border. */
static void join_in_face(struct refining *refining, uint32_t face, uint32_t i)
{
    const struct gd__plane_triangle *triangles = refining->planar.plane.triangles;
    uint32_t first = refining->refined->of_face[face];
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t other = triangles[i].across[k];
        if (other == GD_NONE) {
            join_at_piece(refining, first + i, k,
                          cut_refine_piece_of(refining, face, first + i, k));
        } else if (other < i && !triangles[i].is_fixed[k]) {
            uint32_t m = 0;
            while (triangles[other].across[m] != i) m++;
            cut_refine_join(refining->refined, first + i, k, first + other, m);
        }
    }
}

static enum gd_status cut_refine_triangulate(struct refining *refining, uint32_t face)
{
    enum gd_status status = gather_sites(refining, face);
    if (!status) status = gd__planar_triangulate(&refining->planar);
    if (!status) status = draw_segments(refining, face);
    if (!status) gd__plane_improve(&refining->planar.plane);
    return status;
}

/* Returns true if the triangles tile the face: their exact areas sum to the face's area. */
static bool is_whole(const struct gd__plane *plane)
{
    __int128 area = 0;
    for (uint32_t i = 0; i < plane->triangle_count; i++) {
        const uint32_t *corner = plane->triangles[i].corner;
        __int128 part = gd__site_area(plane->sites[corner[0]], plane->sites[corner[1]],
                                      plane->sites[corner[2]]);
        if (part <= 0) return false;
        area += part;
    }
    return area == (__int128)GD__LATTICE * GD__LATTICE;
}

static enum gd_status split_face(struct refining *refining, uint32_t face)
{
    enum gd_status status = cut_refine_triangulate(refining, face);
    if (status) return status;
    if (!is_whole(&refining->planar.plane)) return GD_INTERNAL;
    bool has_flat = false;
    for (uint32_t i = 0; i < refining->planar.plane.triangle_count; i++) {
        const uint32_t *corner = refining->planar.plane.triangles[i].corner;
        uint32_t node[3];
        for (int k = 0; k < 3; k++) node[k] = refining->site_node[corner[k]];
        has_flat |= is_flat(refining->refined, cut_refine_add(refining->refined, face, node));
    }
    for (uint32_t i = 0; i < refining->planar.plane.triangle_count; i++)
        join_in_face(refining, face, i);
    return has_flat ? GD_RUNAWAY : GD_OK;
}

/* --- all faces -------------------------------------------------------------------------------- */

/* Returns an upper bound on the number of triangles. A node on an edge adds one triangle to each of
 * the edge's faces. A node inside a face adds two triangles. */
static size_t triangle_count(const struct gd__nodes *nodes)
{
    return nodes->mesh->face_count + 2 * (size_t)nodes->count;
}

static enum gd_status cut_refine_prepare(struct refining *refining, struct gd__arena *arena)
{
    const struct gd__nodes *nodes = &refining->arrangement->nodes;
    struct gd__refined *refined = refining->refined;
    size_t triangles = triangle_count(nodes), faces = nodes->mesh->face_count,
           pieces = (size_t)nodes->mesh->edge_count + nodes->count;
    if (3 * triangles > UINT32_MAX) return GD_TOO_LARGE;
    *refined = (struct gd__refined){.mesh = nodes->mesh, .nodes = nodes};
    refined->node = gd__arena_take(arena, triangles, sizeof *refined->node);
    refined->face = gd__arena_take(arena, triangles, sizeof *refined->face);
    refined->region = gd__arena_take(arena, triangles, sizeof *refined->region);
    refined->vertex = gd__arena_take(arena, 3 * triangles, sizeof *refined->vertex);
    refined->of_face = gd__arena_take(arena, faces, sizeof *refined->of_face);
    refined->in_face = gd__arena_zeroed(arena, faces, sizeof *refined->in_face);
    refining->first_side = gd__cut_numbers(arena, pieces);
    if (arena->status) return arena->status;
    gd__union_find_init(refined->region, (uint32_t)triangles);
    gd__union_find_init(refined->vertex, (uint32_t)(3 * triangles));
    return GD_OK;
}

static enum gd_status refine_faces(struct refining *refining, uint32_t *flat_face)
{
    const struct gd_mesh *mesh = refining->refined->mesh;
    uint32_t indices = mesh->summary.face_index_count;
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < indices && !status; i++) {
        uint32_t face = mesh->face_of_index[i];
        if (face == GD_NONE) continue;
        refining->refined->of_face[face] = refining->refined->count;
        if (gd__is_crossed(refining->arrangement, face)) {
            status = split_face(refining, face);
            *flat_face = face;
        } else {
            keep_face(refining, face);
        }
        if (!status && (i + 1) % FACES_BETWEEN_CHECKS == 0)
            status = gd_control_check(refining->planar.budget->control, (double)i / indices);
    }
    return status;
}

enum gd_status gd__refine(const struct gd__arrangement *arrangement, const struct gd__seam *seam,
                          struct gd__arena *arena, struct gd__refined *out, uint32_t *flat_face)
{
    struct refining refining = {.arrangement = arrangement, .seam = seam, .refined = out};
    refining.planar.budget = &arena->budget;
    enum gd_status status = cut_refine_prepare(&refining, arena);
    if (!status) status = refine_faces(&refining, flat_face);
    gd__planar_free(&refining.planar);
    return status;
}
