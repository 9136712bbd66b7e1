/* Computes a triangulation of least area (Barequet and Sharir, 1995), which patch.cc refines and
 * smooths. */
#include "edit/hole.h"

#include <stdlib.h>

#include "base/tolerance.h"
#include "edit/crossings.h"
#include "edit/edited.h"
#include "mesh/topology.h"
#include "mesh/triangle.h"

static void patch_free(struct gd__patch *patch)
{
    free(patch->positions);
    free(patch->corners);
    *patch = (struct gd__patch){0};
}

void gd__hole_free(struct gd__hole *hole)
{
    free(hole->vertex);
    patch_free(&hole->rough);
    patch_free(&hole->patch);
}

enum gd_status gd__hole_read(const struct gd_mesh *mesh, uint32_t loop, struct gd__hole *out)
{
    uint32_t count = mesh->boundary[loop].vertices, side = mesh->boundary_side[loop];
    if (!gd__side_is_boundary(mesh, side)) side ^= 1;
    *out = (struct gd__hole){.mesh = mesh, .vertex = malloc(count * sizeof *out->vertex)};
    if (!out->vertex) return GD_NO_MEMORY;
    for (; out->count < count; side = gd__edit_side(mesh, side).next)
        out->vertex[out->count++] = mesh->origin[side];
    return GD_OK;
}

enum gd_status gd__hole_refuse(const struct gd__hole *hole, struct gd_detail *detail,
                               const char *reason)
{
    gd_fail(detail, GD_NOT_TRIANGULABLE, "a hole of %u edges %s", hole->count, reason);
    for (uint32_t i = 0; i < hole->count; i++)
        gd_detail_add(detail, GD_ELEMENT_VERTEX, hole->mesh->index_of_vertex[hole->vertex[i]], 0);
    return GD_NOT_TRIANGULABLE;
}

/* Returns true if two vertices of the loop are at the same place. */
static bool is_pinched(const struct gd__hole *hole)
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
    const struct gd__hole *hole = user;
    return gd__side_between(hole->mesh, hole->vertex[i], hole->vertex[j]) != GD_NONE ||
           gd__side_between(hole->mesh, hole->vertex[j], hole->vertex[i]) != GD_NONE;
}

/* --- least area ------------------------------------------------------------------------------- */

/* The best triangulations for all parts of the loop, count x count items. A part of the loop from
 * vertex i to vertex j, closed by the chord i-j, is a polygon. */
struct spans {
    struct gd__hole *hole;
    double *cost; /* least area, or INFINITY if there is none */
    uint16_t *apex;
};

/* Returns the area of a triangle, or INFINITY if the triangle is too flat. */
static double area(const struct gd__hole *hole, uint32_t i, uint32_t k, uint32_t j)
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
        return gd__hole_refuse(spans->hole, detail,
                               "can't be filled by triangles that are not flat");
    corners_write(spans, 0, n - 1);
    return GD_OK;
}

static void places_write(struct gd__hole *hole)
{
    struct gd__patch *rough = &hole->rough;
    rough->position_count = rough->loop_count = hole->count;
    for (uint32_t i = 0; i < hole->count; i++) {
        struct gd_vec3 p = gd__edit_place(hole->mesh, hole->vertex[i]);
        memcpy(rough->positions[i], &p, sizeof p);
    }
}

enum gd_status gd__hole_triangulate(struct gd__hole *hole, struct gd__pace *pace,
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

enum gd_status gd__hole_finish(struct gd__hole *hole, const struct gd_control *control,
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
    return gd__hole_refuse(hole, detail,
                           is_pinched(hole)
                               ? "can't be filled: two of its vertices are at the same place"
                               : "can't be filled by triangles that do not cross");
}
