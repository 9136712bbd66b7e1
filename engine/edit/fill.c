/* Fills the holes of a mesh by patches: a triangulation of least area (Barequet and Sharir, 1995),
 * which patch.cc refines and smooths. */
#include <stdlib.h>

#include "base/arena.h"
#include "base/pace.h"
#include "base/share.h"
#include "edit/crossings.h"
#include "edit/edited.h"
#include "edit/patch.h"
#include "mesh/topology.h"
#include "mesh/triangle.h"

/* --- one hole --------------------------------------------------------------------------------- */

/* One boundary loop, and the patch of triangles that fills it. */
struct hole {
    const struct gd_mesh *mesh;
    uint32_t *vertex; /* internal numbers of the vertices, in the order of the boundary sides */
    uint32_t count;
    struct gd__patch rough; /* the triangulation of least area */
    struct gd__patch patch; /* the final patch */
};

static void patch_free(struct gd__patch *patch)
{
    free(patch->positions);
    free(patch->corners);
    *patch = (struct gd__patch){0};
}

static void hole_free(struct hole *hole)
{
    free(hole->vertex);
    patch_free(&hole->rough);
    patch_free(&hole->patch);
}

/* Reads a boundary loop. Errors: GD_NO_MEMORY. */
static enum gd_status hole_read(const struct gd_mesh *mesh, uint32_t loop, struct hole *out)
{
    uint32_t count = mesh->boundary[loop].vertices, side = mesh->boundary_side[loop];
    if (!gd__side_is_boundary(mesh, side)) side ^= 1;
    *out = (struct hole){.mesh = mesh, .vertex = malloc(count * sizeof *out->vertex)};
    if (!out->vertex) return GD_NO_MEMORY;
    for (; out->count < count; side = gd__edit_side(mesh, side).next)
        out->vertex[out->count++] = mesh->origin[side];
    return GD_OK;
}

/* Returns GD_NOT_TRIANGULABLE. Writes the text "a hole of 7 edges <reason>" and the vertices of the
 * hole to the detail. */
static enum gd_status hole_refuse(const struct hole *hole, struct gd_detail *detail,
                                  const char *reason)
{
    gd_fail(detail, GD_NOT_TRIANGULABLE, "a hole of %u edges %s", hole->count, reason);
    for (uint32_t i = 0; i < hole->count; i++)
        gd_detail_add(detail, GD_ELEMENT_VERTEX, hole->mesh->index_of_vertex[hole->vertex[i]], 0);
    return GD_NOT_TRIANGULABLE;
}

/* Returns true if two vertices of the loop are at the same place. */
static bool is_pinched(const struct hole *hole)
{
    const struct gd_vec3 *place = hole->mesh->position;
    for (uint32_t i = 1; i < hole->count; i++) {
        for (uint32_t k = 0; k < i; k++)
            if (gd_vec3_distance(place[hole->vertex[i]], place[hole->vertex[k]]) == 0) return true;
    }
    return false;
}

/* Returns true if an edge of the mesh already joins two vertices of the loop. The patch must not
 * contain a second edge between them. */
static bool is_taken(const void *user, uint32_t i, uint32_t j)
{
    const struct hole *hole = user;
    return gd__side_between(hole->mesh, hole->vertex[i], hole->vertex[j]) != GD_NONE ||
           gd__side_between(hole->mesh, hole->vertex[j], hole->vertex[i]) != GD_NONE;
}

/* --- least area ------------------------------------------------------------------------------- */

/* The best triangulations for all parts of the loop, count x count items. A part of the loop from
 * vertex i to vertex j, closed by the chord i-j, is a polygon. */
struct spans {
    struct hole *hole;
    double *cost; /* least area, or INFINITY if there is none */
    uint16_t *apex;
};

/* Returns the area of a triangle, or INFINITY if the triangle is too flat. */
static double area(const struct hole *hole, uint32_t i, uint32_t k, uint32_t j)
{
    const struct gd_vec3 *place = hole->mesh->position;
    struct gd_vec3 a = place[hole->vertex[i]], b = place[hole->vertex[k]],
                   c = place[hole->vertex[j]];
    struct gd__triangle t =
        gd__triangle_measure(gd_vec3_sub(b, a), gd_vec3_sub(c, b), gd_vec3_sub(a, c));
    return gd__triangle_flatness(&t) < GD_TOL_EDIT_PATCH ? INFINITY : t.double_area / 2;
}

static void span_solve(struct spans *spans, uint32_t i, uint32_t j)
{
    const size_t n = spans->hole->count;
    double best = INFINITY;
    uint32_t apex = 0;
    for (uint32_t k = i + 1; k < j; k++) {
        double rest = spans->cost[i * n + k] + spans->cost[k * n + j];
        if (rest >= best) continue;
        double cost = rest + area(spans->hole, i, k, j);
        if (cost < best) best = cost, apex = k;
    }
    spans->cost[i * n + j] = best;
    spans->apex[i * n + j] = (uint16_t)apex;
}

static void corners_write(const struct spans *spans, uint32_t i, uint32_t j)
{
    struct gd__patch *rough = &spans->hole->rough;
    while (j - i > 1) {
        uint32_t apex = spans->apex[i * (size_t)spans->hole->count + j];
        uint32_t *corner = &rough->corners[3 * rough->face_count++];
        corner[0] = i, corner[1] = apex, corner[2] = j;
        /* recursion handles the shorter part, so its depth is at most the logarithm of the count */
        if (apex - i < j - apex) {
            corners_write(spans, i, apex);
            i = apex;
        } else {
            corners_write(spans, apex, j);
            j = apex;
        }
    }
}

static enum gd_status spans_solve(struct spans *spans, struct gd__pace *pace,
                                  struct gd_detail *detail)
{
    const uint32_t n = spans->hole->count;
    for (uint32_t length = 2; length < n; length++) {
        for (uint32_t i = 0; i + length < n && gd__pace(pace, length); i++) {
            bool is_chord = length < n - 1;
            if (is_chord && is_taken(spans->hole, i, i + length))
                spans->cost[i * (size_t)n + i + length] = INFINITY;
            else
                span_solve(spans, i, i + length);
        }
    }
    if (pace->status) return pace->status;
    if (isinf(spans->cost[n - 1]))
        return hole_refuse(spans->hole, detail, "can't be filled by triangles that are not flat");
    corners_write(spans, 0, n - 1);
    return GD_OK;
}

static void places_write(struct hole *hole)
{
    struct gd__patch *rough = &hole->rough;
    rough->position_count = rough->loop_count = hole->count;
    for (uint32_t i = 0; i < hole->count; i++) {
        struct gd_vec3 p = gd__edit_place(hole->mesh, hole->vertex[i]);
        memcpy(rough->positions[i], &p, sizeof p);
    }
}

/* Computes the rough patch. Errors: GD_NOT_TRIANGULABLE (all triangulations have flat triangles),
 * GD_NO_MEMORY, GD_CANCELLED, GD_DEADLINE. For n edges: O(n^3) time and 10 n^2 bytes. */
static enum gd_status hole_triangulate(struct hole *hole, struct gd__pace *pace,
                                       struct gd_detail *detail)
{
    const size_t n = hole->count;
    struct gd__patch *rough = &hole->rough;
    struct spans spans = {hole, calloc(n * n, sizeof *spans.cost),
                          calloc(n * n, sizeof *spans.apex)};
    rough->positions = malloc(n * sizeof *rough->positions);
    rough->corners = malloc(3 * n * sizeof *rough->corners);
    enum gd_status status = GD_NO_MEMORY;
    if (spans.cost && spans.apex && rough->positions && rough->corners) {
        places_write(hole);
        status = spans_solve(&spans, pace, detail);
    }
    free(spans.cost);
    free(spans.apex);
    return status;
}

/* --- the patch -------------------------------------------------------------------------------- */

/* Sets `*out` to true if faces of the patch cross, or are too flat for a mesh. */
static enum gd_status is_bad(const struct gd__patch *patch, const struct gd_control *control,
                             bool *out)
{
    const struct gd_polygons triangles = {.positions = patch->positions,
                                          .position_count = patch->position_count,
                                          .polygon_count = patch->face_count,
                                          .corners = patch->corners};
    uint32_t *crossed = malloc(patch->face_count * sizeof *crossed);
    if (!crossed) return GD_NO_MEMORY;
    enum gd_status status = gd__find_crossings(&triangles, control, crossed);
    *out = status == GD_DEGENERATE_FACE;
    for (uint32_t i = 0; !status && i < patch->face_count; i++) *out |= crossed[i] != GD_NONE;
    free(crossed);
    return status == GD_DEGENERATE_FACE ? GD_OK : status;
}

/* Computes the final patch from the rough one. Tries three forms: refined and smoothed, only
 * refined, and unchanged. Keeps the first form whose faces do not cross. Errors:
 * GD_NOT_TRIANGULABLE (faces cross in all three forms), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED,
 * GD_DEADLINE. */
static enum gd_status hole_finish(struct hole *hole, const struct gd_control *control,
                                  struct gd_detail *detail)
{
    enum { SMOOTH, REFINED, ROUGH };
    struct gd__patch *patch = &hole->patch;
    enum gd_status status = GD_OK;
    bool bad = true;
    /* several forms are tried, because smoothing and flips may turn faces over where the loop is
       not convex */
    for (int form = SMOOTH; !status && bad && form <= ROUGH; form++) {
        const struct gd__patch_options options = {form == SMOOTH, is_taken, hole};
        patch_free(patch);
        if (form < ROUGH) {
            status = gd__patch_refine(&hole->rough, &options, control, patch);
        } else {
            *patch = hole->rough;
            hole->rough = (struct gd__patch){0};
        }
        if (!status) status = is_bad(patch, control, &bad);
    }
    patch_free(&hole->rough);
    if (status || !bad) return status;
    return hole_refuse(hole, detail,
                       is_pinched(hole)
                           ? "can't be filled: two of its vertices are at the same place"
                           : "can't be filled by triangles that do not cross");
}

struct filling {
    const struct gd_mesh *mesh;
    const struct gd_fill_options *options;
    /* progress: two parts for each loop (triangulation and refinement), and one for the result */
    struct gd__share share;
    struct gd_control part;
    struct gd__pace pace; /* pace of the current part */
    struct hole *holes;
    uint32_t count;
};

/* Returns true if the loop is the border of a single face. A patch would be a duplicate of that
 * face. */
static bool is_lone_face(const struct gd_mesh *mesh, uint32_t loop)
{
    uint32_t side = mesh->boundary_side[loop];
    if (!gd__side_is_boundary(mesh, side)) side ^= 1;
    return mesh->boundary[loop].vertices == 3 &&
           mesh->side_face[side ^ 1] == mesh->side_face[gd__edit_side(mesh, side).next ^ 1];
}

/* Sums over the patches. `vertices` counts all vertices of the patches. `loops` counts only those
 * that are vertices of the mesh. */
struct patch_sizes {
    uint32_t vertices, loops, faces;
};

static struct patch_sizes sizes_of(const struct filling *filling)
{
    struct patch_sizes sizes = {0};
    for (uint32_t i = 0; i < filling->count; i++) {
        const struct gd__patch *patch = &filling->holes[i].patch;
        sizes.vertices += patch->position_count;
        sizes.loops += patch->loop_count;
        sizes.faces += patch->face_count;
    }
    return sizes;
}

static enum gd_status fill_one(struct filling *filling, uint32_t loop, struct gd_detail *detail)
{
    struct hole *hole = &filling->holes[filling->count++];
    enum gd_status status = hole_read(filling->mesh, loop, hole);
    if (!status) status = hole_triangulate(hole, &filling->pace, detail);
    filling->share.done++;
    if (!status) status = hole_finish(hole, &filling->part, detail);
    if (status == GD_NOT_TRIANGULABLE) hole_free(&filling->holes[--filling->count]);
    return status;
}

/* Appends the patch to the triangles, whose arrays have room for it. */
static void patch_append(const struct gd__patch *patch, struct gd_polygons *triangles)
{
    memcpy(&triangles->positions[triangles->position_count], patch->positions,
           patch->position_count * sizeof *patch->positions);
    for (uint32_t i = 0; i < 3 * patch->face_count; i++)
        triangles->corners[3 * triangles->polygon_count + i] =
            patch->corners[i] + triangles->position_count;
    triangles->position_count += patch->position_count;
    triangles->polygon_count += patch->face_count;
}

/* Returns true if one of the triangles [first, end) crosses a triangle before them. */
static bool cross_earlier(const uint32_t *crossed, uint32_t first, uint32_t end)
{
    bool found = false;
    for (uint32_t i = first; i < end; i++) found |= crossed[i] < first;
    return found;
}

/* Removes the holes whose patches cross the patch of an earlier hole. These holes stay open. */
static void remove_crossing(struct filling *filling, const uint32_t *crossed,
                            struct gd_detail *refusal)
{
    uint32_t kept = 0, first = 0;
    for (uint32_t i = 0; i < filling->count; i++) {
        struct hole hole = filling->holes[i];
        uint32_t end = first + hole.patch.face_count;
        if (cross_earlier(crossed, first, end)) {
            (void)hole_refuse(&hole, refusal,
                              "can't be filled: the triangles would cross another filled hole");
            hole_free(&hole);
        } else {
            filling->holes[kept++] = hole;
        }
        first = end;
    }
    filling->count = kept;
}

/* Tests whether patches cross each other. */
static enum gd_status check_patches(struct filling *filling, struct gd_detail *refusal)
{
    struct patch_sizes all = sizes_of(filling);
    struct gd__arena arena = {0};
    struct gd_polygons triangles = {
        .positions = gd__arena_take(&arena, all.vertices, sizeof *triangles.positions),
        .corners = gd__arena_take(&arena, 3 * (size_t)all.faces, sizeof *triangles.corners)};
    uint32_t *crossed = gd__arena_take(&arena, all.faces, sizeof *crossed);
    enum gd_status status = arena.status;
    for (uint32_t i = 0; !status && i < filling->count; i++)
        patch_append(&filling->holes[i].patch, &triangles);
    if (!status) status = gd__find_crossings(&triangles, &filling->part, crossed);
    if (!status) remove_crossing(filling, crossed, refusal);
    gd__arena_free(&arena);
    return status;
}

/* Fills all holes that the options select. Returns GD_NOT_TRIANGULABLE if no hole was filled and at
 * least one cannot be triangulated. */
static enum gd_status fill_all(struct filling *filling, struct gd_detail *detail)
{
    const struct gd_mesh *mesh = filling->mesh;
    enum gd_status status = GD_OK;
    struct gd_detail refusal = {.text = ""};
    filling->holes = calloc(mesh->summary.boundaries + 1, sizeof *filling->holes);
    if (!filling->holes) return GD_NO_MEMORY;
    for (uint32_t loop = 0; !status && loop < mesh->summary.boundaries; loop++) {
        filling->share.done = 2 * loop;
        if (mesh->boundary[loop].vertices > filling->options->max_edges || is_lone_face(mesh, loop))
            continue;
        status = fill_one(filling, loop, &refusal);
        if (status == GD_NOT_TRIANGULABLE) status = GD_OK;
    }
    if (!status && filling->count > 1) status = check_patches(filling, &refusal);
    if (status || filling->count || !refusal.text[0]) return status;
    if (detail) *detail = refusal;
    return GD_NOT_TRIANGULABLE;
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
    uint32_t *number; /* for each internal vertex, its number in the result */
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
    struct patch_sizes all = sizes_of(filling);
    enum gd_status status =
        writing.number
            ? gd__edited_allocate(&writing.made, mesh->vertex_count + all.vertices - all.loops,
                                  mesh->face_count + all.faces)
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
