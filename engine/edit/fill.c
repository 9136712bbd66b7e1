/* Holes: computes a triangulation of least area for each hole (Barequet and Sharir, 1995), which
 * patch.cc refines and smooths. */
#include <stdlib.h>

#include "base/pace.h"
#include "base/share.h"
#include "base/tolerance.h"
#include "edit/edited.h"
#include "edit/patch.h"
#include "gd/locate.h"
#include "mesh/topology.h"
#include "mesh/triangle.h"

struct hole {
    const struct gd_mesh *mesh;
    uint32_t *vertex; /* internal numbers, in the order of the sides without a face */
    uint32_t count;
    /* count x count: least cost of the part of the loop from i to j, closed by the chord */
    double *cost;
    uint16_t *apex;
    struct gd__patch patch;
};

struct filling {
    const struct gd_mesh *mesh;
    const struct gd_fill_options *options;
    /* two parts for each loop (its triangulation, its refinement), and one for the result */
    struct gd__share share;
    struct gd_control part;
    struct gd__pace pace; /* of `part` */
    struct hole *holes;
    uint32_t count;
    uint32_t new_vertices, new_faces;
};

static void hole_free(struct hole *hole)
{
    free(hole->vertex);
    free(hole->cost);
    free(hole->apex);
    free(hole->patch.positions);
    free(hole->patch.corners);
}

static struct gd_vec3 place(const struct hole *hole, uint32_t i)
{
    return hole->mesh->position[hole->vertex[i]];
}

/* --- the loop --------------------------------------------------------------------------------- */

static enum gd_status hole_read(const struct gd_mesh *mesh, uint32_t loop, struct hole *hole)
{
    uint32_t count = mesh->boundary[loop].vertices, side = mesh->boundary_side[loop];
    if (!gd__side_is_boundary(mesh, side)) side ^= 1;
    *hole = (struct hole){.mesh = mesh, .vertex = malloc(count * sizeof *hole->vertex)};
    if (!hole->vertex) return GD_NO_MEMORY;
    for (; hole->count < count; side = gd__edit_side(mesh, side).next)
        hole->vertex[hole->count++] = mesh->origin[side];
    return GD_OK;
}

/* Returns true if an edge joins two vertices of the loop. It cannot be a chord of the hole then. */
static bool is_taken(const void *user, uint32_t i, uint32_t j)
{
    const struct hole *hole = user;
    return gd__side_between(hole->mesh, hole->vertex[i], hole->vertex[j]) != GD_NONE ||
           gd__side_between(hole->mesh, hole->vertex[j], hole->vertex[i]) != GD_NONE;
}

/* --- least area ------------------------------------------------------------------------------- */

/* Returns the area of a triangle; INFINITY if the triangle is too flat. */
static double area(const struct hole *hole, uint32_t i, uint32_t k, uint32_t j)
{
    struct gd_vec3 a = place(hole, i), b = place(hole, k), c = place(hole, j);
    struct gd__triangle t =
        gd__triangle_measure(gd_vec3_sub(b, a), gd_vec3_sub(c, b), gd_vec3_sub(a, c));
    return gd__triangle_flatness(&t) < GD_TOL_EDIT_PATCH ? INFINITY : t.double_area / 2;
}

static void span_solve(struct hole *hole, uint32_t i, uint32_t j)
{
    const size_t n = hole->count;
    double best = INFINITY;
    uint32_t apex = 0;
    for (uint32_t k = i + 1; k < j; k++) {
        double rest = hole->cost[i * n + k] + hole->cost[k * n + j];
        if (rest >= best) continue;
        double cost = rest + area(hole, i, k, j);
        if (cost < best) best = cost, apex = k;
    }
    hole->cost[i * n + j] = best;
    hole->apex[i * n + j] = (uint16_t)apex;
}

static void corners_write(struct hole *hole, uint32_t i, uint32_t j)
{
    while (j - i > 1) {
        uint32_t apex = hole->apex[i * (size_t)hole->count + j];
        uint32_t *corner = &hole->patch.corners[3 * hole->patch.face_count++];
        corner[0] = i, corner[1] = apex, corner[2] = j;
        /* the shorter part by recursion, so the depth is at most the logarithm of the count */
        if (apex - i < j - apex) {
            corners_write(hole, i, apex);
            i = apex;
        } else {
            corners_write(hole, apex, j);
            j = apex;
        }
    }
}

static enum gd_status hole_triangulate(struct hole *hole, struct gd__pace *pace,
                                       struct gd_detail *detail)
{
    const uint32_t n = hole->count;
    hole->cost = calloc((size_t)n * n, sizeof *hole->cost);
    hole->apex = calloc((size_t)n * n, sizeof *hole->apex);
    hole->patch.corners = malloc(3 * (size_t)n * sizeof *hole->patch.corners);
    if (!hole->cost || !hole->apex || !hole->patch.corners) return GD_NO_MEMORY;
    for (uint32_t length = 2; length < n; length++) {
        for (uint32_t i = 0; i + length < n && gd__pace(pace, length); i++) {
            bool is_chord = length < n - 1;
            if (is_chord && is_taken(hole, i, i + length))
                hole->cost[i * (size_t)n + i + length] = INFINITY;
            else
                span_solve(hole, i, i + length);
        }
    }
    if (pace->status) return pace->status;
    if (isinf(hole->cost[n - 1])) {
        gd_fail(detail, GD_NOT_TRIANGULABLE,
                "a hole of %u edges can't be filled by triangles that are not flat", n);
        for (uint32_t i = 0; i < n; i++)
            gd_detail_add(detail, GD_ELEMENT_VERTEX, hole->mesh->index_of_vertex[hole->vertex[i]],
                          0);
        return GD_NOT_TRIANGULABLE;
    }
    corners_write(hole, 0, n - 1);
    return GD_OK;
}

/* --- one hole --------------------------------------------------------------------------------- */

static enum gd_status hole_fill(struct hole *hole, struct filling *filling,
                                struct gd_detail *detail)
{
    struct gd__patch *patch = &hole->patch;
    enum gd_status status = hole_triangulate(hole, &filling->pace, detail);
    filling->share.done++;
    if (status) return status;
    patch->positions = malloc(hole->count * sizeof *patch->positions);
    if (!patch->positions) return GD_NO_MEMORY;
    patch->position_count = patch->loop_count = hole->count;
    for (uint32_t i = 0; i < hole->count; i++) {
        struct gd_vec3 p = gd__edit_place(hole->mesh, hole->vertex[i]);
        memcpy(patch->positions[i], &p, sizeof p);
    }
    free(hole->cost);
    free(hole->apex);
    hole->cost = NULL;
    hole->apex = NULL;
    return gd__patch_refine(patch, is_taken, hole, &filling->part);
}

/* Returns true if the loop is the border of a single face. A patch would duplicate that face. */
static bool is_lone_face(const struct gd_mesh *mesh, uint32_t loop)
{
    uint32_t side = mesh->boundary_side[loop];
    if (!gd__side_is_boundary(mesh, side)) side ^= 1;
    return mesh->boundary[loop].vertices == 3 &&
           mesh->side_face[side ^ 1] == mesh->side_face[gd__edit_side(mesh, side).next ^ 1];
}

static enum gd_status fill_one(struct filling *filling, uint32_t loop, struct gd_detail *detail)
{
    struct hole *hole = &filling->holes[filling->count++];
    enum gd_status status = hole_read(filling->mesh, loop, hole);
    if (!status) status = hole_fill(hole, filling, detail);
    filling->new_vertices += hole->patch.position_count - hole->patch.loop_count;
    filling->new_faces += hole->patch.face_count;
    if (status == GD_NOT_TRIANGULABLE) hole_free(&filling->holes[--filling->count]);
    return status;
}

/* Fills all holes that the options select. GD_NOT_TRIANGULABLE if no hole was filled and at least
 * one cannot be triangulated. */
static enum gd_status fill_all(struct filling *filling, struct gd_detail *detail)
{
    const struct gd_mesh *mesh = filling->mesh;
    enum gd_status status = GD_OK, refusal = GD_OK;
    filling->holes = calloc(mesh->summary.boundaries + 1, sizeof *filling->holes);
    if (!filling->holes) return GD_NO_MEMORY;
    for (uint32_t loop = 0; !status && loop < mesh->summary.boundaries; loop++) {
        filling->share.done = 2 * loop;
        if (mesh->boundary[loop].vertices > filling->options->max_edges || is_lone_face(mesh, loop))
            continue;
        status = fill_one(filling, loop, detail);
        if (status == GD_NOT_TRIANGULABLE) {
            refusal = status;
            status = GD_OK;
        }
    }
    return !status && !filling->count ? refusal : status;
}

/* --- the result ------------------------------------------------------------------------------- */

/* Writes the position of a new vertex, in the mesh's unit, and its origin. */
static enum gd_status put_new(const struct gd_mesh *mesh, const double in_box[3], uint32_t at,
                              struct gd_edited *out)
{
    double size = gd__edit_box_size(mesh);
    struct gd_vec3 low = mesh->summary.min;
    struct gd_vec3 p = {low.x + size * in_box[0], low.y + size * in_box[1],
                        low.z + size * in_box[2]};
    struct gd_point nearest;
    enum gd_status status = gd_locate_nearest(mesh, p, -1, &nearest, NULL);
    if (status) return status;
    memcpy(out->polygons.positions[at], &p, sizeof p);
    out->origins[at] = gd__origin_of(mesh, &nearest);
    return GD_OK;
}

/* The result while it is being written. */
struct writing {
    struct gd__pace *pace;
    uint32_t *number; /* per internal vertex: its number in the result */
    uint32_t vertices, faces;
    struct gd_edited made;
};

static enum gd_status write_patch(struct writing *writing, const struct hole *hole)
{
    const struct gd__patch *patch = &hole->patch;
    const uint32_t first = writing->vertices - patch->loop_count;
    uint32_t *corners = &writing->made.polygons.corners[3 * writing->faces];
    enum gd_status status = GD_OK;
    for (uint32_t i = patch->loop_count; !status && i < patch->position_count; i++) {
        status = put_new(hole->mesh, patch->positions[i], first + i, &writing->made);
        if (!status && !gd__pace(writing->pace, 40)) status = writing->pace->status;
    }
    for (uint32_t i = 0; i < 3 * patch->face_count; i++) {
        uint32_t corner = patch->corners[i];
        corners[i] =
            corner < patch->loop_count ? writing->number[hole->vertex[corner]] : first + corner;
    }
    writing->vertices = first + patch->position_count;
    writing->faces += patch->face_count;
    return status;
}

static enum gd_status write(struct filling *filling, struct gd_edited *out)
{
    const struct gd_mesh *mesh = filling->mesh;
    struct writing writing = {.pace = &filling->pace,
                              .number = malloc(mesh->vertex_count * sizeof *writing.number)};
    enum gd_status status =
        writing.number
            ? gd__edited_allocate(&writing.made, mesh->vertex_count + filling->new_vertices,
                                  mesh->face_count + filling->new_faces)
            : GD_NO_MEMORY;
    if (!status) {
        gd__edited_copy(&writing.made, mesh, writing.number, &filling->pace);
        writing.vertices = mesh->vertex_count;
        writing.faces = mesh->face_count;
        status = filling->pace.status;
    }
    for (uint32_t i = 0; !status && i < filling->count; i++)
        status = write_patch(&writing, &filling->holes[i]);
    free(writing.number);
    if (status)
        gd_edited_free(&writing.made);
    else
        *out = writing.made;
    return status;
}

enum gd_status gd_fill(const struct gd_mesh *mesh, const struct gd_fill_options *options,
                       const struct gd_control *control, struct gd_edited *out,
                       struct gd_detail *detail)
{
    struct filling filling = {
        .mesh = mesh,
        .options = options,
        .share = {.control = control, .total = 2 * mesh->summary.boundaries + 1}};
    const size_t largest = options->max_edges;
    if (options->max_edges < 3 || options->max_edges > GD_FILL_EDGES_MOST)
        return gd_fail(detail, GD_INVALID_ARGUMENT, "max_edges = %u is not 3 to %d",
                       options->max_edges, GD_FILL_EDGES_MOST);
    enum gd_status status =
        gd_control_afford(control, gd_edit_cost(mesh->face_count) + 10 * largest * largest);
    filling.part = gd__share_control(&filling.share, 0);
    filling.pace.control = &filling.part;
    if (!status) status = fill_all(&filling, detail);
    filling.share.done = filling.share.total - 1;
    if (!status) status = write(&filling, out);
    for (uint32_t i = 0; i < filling.count; i++) hole_free(&filling.holes[i]);
    free(filling.holes);
    return status;
}
