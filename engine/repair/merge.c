/* Merges the vertices that the weld joins, and the ends of edges of length zero. Replaces each
 * corner by the vertex that represents it, and simplifies the polygons. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/large.h"
#include "repair/repair.h"
#include "mesh/union_find.h"

static void join_ends(struct gd__construction *work, uint32_t a, uint32_t b)
{
    a = gd__union_find_root(work->representative, a);
    b = gd__union_find_root(work->representative, b);
    const double *p = work->input->positions[a], *q = work->input->positions[b];
    if (a == b || p[0] != q[0] || p[1] != q[1] || p[2] != q[2]) return;
    gd__union_find_join(work->representative, a, b);
    gd_mended_add(&work->mesh->repair->vertices_merged, a < b ? b : a, a < b ? a : b);
}

static void join_zero_edges(struct gd__construction *work)
{
    const struct gd_polygons *input = work->input;
    GD__PACED (&work->pace, i, input->polygon_count) {
        uint32_t begin = gd_polygons_first(input, i), end = gd_polygons_first(input, i + 1);
        for (uint32_t c = begin; c < end; c++)
            join_ends(work, input->corners[c], input->corners[c + 1 < end ? c + 1 : begin]);
    }
}

/* Simplifies a ring of corners in place: removes repeated corners, and paths that go along an edge
 * and back. Returns the number of corners that are left, or 0 if it is less than three. */
static uint32_t simplify(uint32_t *ring, uint32_t count)
{
    uint32_t begin = 0, end = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (end > 0 && ring[end - 1] == ring[i]) continue;
        if (end > 1 && ring[end - 2] == ring[i])
            end--;
        else
            ring[end++] = ring[i];
    }
    /* the ring is closed, so the last corners are also compared with the first ones */
    while (end - begin > 1) {
        if (ring[end - 1] == ring[begin] || ring[end - 2] == ring[begin])
            end--;
        else if (ring[end - 1] == ring[begin + 1])
            begin++;
        else
            break;
    }
    if (end - begin < 3) return 0;
    memmove(ring, ring + begin, (end - begin) * sizeof *ring);
    return end - begin;
}

/* If a ring consists of several repetitions of the same corners, reduces it to one repetition. */
static uint32_t unwind(const uint32_t *ring, uint32_t count)
{
    for (uint32_t period = 3; 2 * period <= count; period++) {
        if (count % period != 0 || ring[period] != ring[0]) continue;
        uint32_t i = period;
        while (i < count && ring[i] == ring[i - period]) i++;
        if (i == count) return period;
    }
    return count;
}

/* Records the indices of the triangles that a polygon has lost because it lost corners. */
static void note_lost_triangles(struct gd__construction *work, uint32_t index, uint32_t before,
                                uint32_t after)
{
    uint32_t kept = after ? after - 2 : 0;
    for (uint32_t k = kept; k < before - 2; k++)
        gd_mended_add(&work->mesh->repair->degenerate_faces, index + k, 0);
}

/* Writes work->merged. Returns true if it differs from the input. */
static bool rename_corners(struct gd__construction *work)
{
    const struct gd_polygons *input = work->input;
    struct gd_polygons *merged = &work->merged;
    bool edited = false;
    merged->first[0] = 0;
    uint32_t index = 0;
    GD__PACED (&work->pace, i, input->polygon_count) {
        uint32_t begin = gd_polygons_first(input, i),
                 count = gd_polygons_first(input, i + 1) - begin;
        uint32_t *ring = merged->corners + merged->first[i];
        for (uint32_t k = 0; k < count; k++) {
            ring[k] = gd__union_find_root(work->representative, input->corners[begin + k]);
            edited |= ring[k] != input->corners[begin + k];
        }
        uint32_t left = simplify(ring, count);
        if (work->options.repair_split) left = unwind(ring, left);
        edited |= left < count;
        note_lost_triangles(work, index, count, left);
        merged->first[i + 1] = merged->first[i] + left;
        index += count - 2;
    }
    return edited;
}

/* Returns the index of the first triangle of a polygon of the input. */
static uint32_t first_triangle(const struct gd__construction *work, uint32_t polygon)
{
    return gd_polygons_first(work->input, polygon) - 2 * polygon;
}

/* Removes the corners of duplicate polygons from work->merged. Polygon i is a duplicate if
 * original[i] is another polygon. */
static bool take_out(struct gd__construction *work, const uint32_t *original)
{
    struct gd_polygons *merged = &work->merged;
    bool edited = false;
    uint32_t begin = 0, end = 0;
    GD__PACED (&work->pace, i, merged->polygon_count) {
        uint32_t next = merged->first[i + 1], count = next - begin;
        if (original[i] != i) {
            for (uint32_t k = 0; k < count - 2; k++)
                gd_mended_add(&work->mesh->repair->duplicate_faces, first_triangle(work, i) + k,
                              first_triangle(work, original[i]));
            edited = true;
            count = 0;
        }
        memmove(merged->corners + end, merged->corners + begin, count * sizeof *merged->corners);
        end += count;
        merged->first[i + 1] = end;
        begin = next;
    }
    return edited;
}

static enum gd_status drop_duplicates(struct gd__construction *work, bool *edited)
{
    uint32_t *original = gd__large_array(work->merged.polygon_count, sizeof *original);
    enum gd_status status =
        original ? gd__find_duplicates(&work->merged, &work->pace, original) : GD_NO_MEMORY;
    if (!status) *edited |= take_out(work, original);
    free(original);
    return status;
}

static enum gd_status name_representatives(struct gd__construction *work)
{
    uint32_t vertices = work->input->position_count;
    GD__PACED (&work->pace, i, vertices) work->representative[i] = i;
    enum gd_status status = work->options.weld ? gd__weld_vertices(work) : GD_OK;
    if (status) return status;
    if (work->options.repair_split) join_zero_edges(work);
    GD__PACED (&work->pace, i, vertices) gd__union_find_root(work->representative, i);
    return GD_OK;
}

static enum gd_status merge_allocate(struct gd__construction *work)
{
    const struct gd_polygons *input = work->input;
    struct gd_mesh *mesh = work->mesh;
    mesh->repair = gd__mesh_array(work, 1, sizeof *mesh->repair);
    if (mesh->repair && work->options.lines_skipped)
        mesh->repair->lines_skipped = *work->options.lines_skipped;
    work->representative = gd__large_array(input->position_count, sizeof *work->representative);
    work->merged = (struct gd_polygons){
        .positions = input->positions, /* borrowed; build.c frees the other two arrays */
        .position_count = input->position_count,
        .polygon_count = input->polygon_count,
        .corners = gd__large_array(gd_polygons_corner_count(input), sizeof *input->corners),
        .first = gd__large_array((size_t)input->polygon_count + 1, sizeof *input->first),
    };
    return mesh->repair && work->representative && work->merged.corners && work->merged.first
               ? GD_OK
               : GD_NO_MEMORY;
}

enum gd_status gd__merge_vertices(struct gd__construction *work)
{
    if (!work->options.weld && !work->options.repair_split) return GD_OK;
    enum gd_status status = merge_allocate(work);
    if (!status) status = name_representatives(work);
    if (status) return status;
    bool edited = rename_corners(work);
    if (work->pace.status) return work->pace.status;
    if (work->options.repair_split) status = drop_duplicates(work, &edited);
    if (status || !edited || work->pace.status) return status;
    work->polygons = &work->merged;
    if (gd_polygons_corner_count(work->polygons)) return GD_OK;
    return gd_fail(work->detail, GD_EMPTY, "no face is left: the corners of each fell together%s",
                   work->options.weld ? "; use a smaller weld tolerance" : "");
}

void gd__blame_weld(const struct gd__construction *work, const uint32_t *vertices, uint32_t count)
{
    struct gd_detail *detail = work->detail;
    if (!detail || !work->options.weld) return;
    for (uint32_t i = 0; i < work->input->position_count; i++) {
        for (uint32_t k = 0; k < count; k++) {
            if (work->representative[i] != vertices[k] || i == vertices[k]) continue;
            size_t length = strlen(detail->text);
            snprintf(detail->text + length, sizeof detail->text - length,
                     "; the weld brought vertex %u to vertex %u: use a smaller tolerance, or "
                     "repair=split",
                     i, vertices[k]);
            return;
        }
    }
}
