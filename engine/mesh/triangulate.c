/* Polygons to triangles. The triangles of a polygon stand together; each holds at least one diagonal that was no edge
 * before, so that no two polygons can yield the same triangle. */
#include <stdlib.h>
#include <string.h>

#include "mesh/build.h"
#include "mesh/ear.h"

static uint32_t size_of(const struct gd_polygons *polygons, uint32_t polygon)
{
    return gd_polygons_first(polygons, polygon + 1) - gd_polygons_first(polygons, polygon);
}

static uint32_t largest_polygon(const struct gd_polygons *polygons, uint32_t *which)
{
    uint32_t most = 0;
    for (uint32_t i = 0; i < polygons->polygon_count; i++) {
        if (size_of(polygons, i) <= most) continue;
        most = size_of(polygons, i);
        *which = i;
    }
    return most;
}

static void insert_ring(struct gd__edge_set *edges, const uint32_t *corner, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) gd__edge_set_insert(edges, corner[i], corner[i + 1 < count ? i + 1 : 0]);
}

/* Triangulates one polygon into triangle[0 .. n-3] and makes its diagonals edges. */
static enum gd_status split(struct gd__construction *work, uint32_t polygon, struct gd__ear_clipper *clipper,
                            struct gd__edge_set *edges, uint32_t (*triangle)[3])
{
    const struct gd_polygons *polygons = work->polygons;
    uint32_t count = size_of(polygons, polygon);
    const uint32_t *corner = polygons->corners + gd_polygons_first(polygons, polygon);
    if (count == 3) {
        memcpy(triangle, corner, sizeof *triangle);
        return GD_OK;
    }
    if (!gd__ear_clip(clipper, (const double(*)[3])polygons->positions, corner, count, edges, triangle)) {
        gd_fail(work->detail, GD_NOT_TRIANGULABLE,
                "face %u with %u corners can't be split into triangles: its diagonals are edges of other faces",
                polygon, count);
        gd_detail_add(work->detail, GD_ELEMENT_FACE, polygon, 0);
        return GD_NOT_TRIANGULABLE;
    }
    for (uint32_t i = 0; i < count - 2; i++) insert_ring(edges, triangle[i], 3);
    return GD_OK;
}

static enum gd_status split_all(struct gd__construction *work, struct gd__ear_clipper *clipper,
                                struct gd__edge_set *edges)
{
    const struct gd_polygons *polygons = work->polygons;
    for (uint32_t i = 0; i < polygons->polygon_count; i++)
        insert_ring(edges, polygons->corners + gd_polygons_first(polygons, i), size_of(polygons, i));
    uint32_t first = 0;
    for (uint32_t i = 0; i < polygons->polygon_count; i++) {
        double done = (double)i / polygons->polygon_count;
        enum gd_status status = gd_control_check(work->control, work->begun + (work->until - work->begun) * done);
        if (!status) status = split(work, i, clipper, edges, work->triangle + first);
        if (status) return status;
        for (uint32_t k = size_of(polygons, i); k > 2; k--) work->mesh->source_polygon[first++] = i;
    }
    return GD_OK;
}

static enum gd_status triangulate(struct gd__construction *work, uint32_t most_corners)
{
    struct gd_mesh *mesh = work->mesh;
    struct gd__edge_set edges = {0};
    struct gd__ear_clipper *clipper = gd__ear_clipper_create(most_corners);
    mesh->source_polygon = gd__mesh_array(mesh, mesh->face_count, sizeof *mesh->source_polygon);
    enum gd_status status = clipper && mesh->source_polygon ? GD_OK : GD_NO_MEMORY;
    /* every edge of every polygon, and its diagonals */
    if (!status)
        status = gd__edge_set_create(gd_polygons_corner_count(work->polygons) + (uint64_t)mesh->face_count, &edges);
    if (!status) status = split_all(work, clipper, &edges);
    gd__edge_set_free(&edges);
    gd__ear_clipper_free(clipper);
    return status;
}

enum gd_status gd__triangulate(struct gd__construction *work)
{
    const struct gd_polygons *polygons = work->polygons;
    uint32_t which = 0, most_corners = largest_polygon(polygons, &which);
    if (most_corners > GD_EAR_MAX_CORNERS) {
        gd_fail(work->detail, GD_UNSUPPORTED, "face %u has %u corners; at most %u are supported, split it", which,
                most_corners, GD_EAR_MAX_CORNERS);
        gd_detail_add(work->detail, GD_ELEMENT_FACE, which, 0);
        return GD_UNSUPPORTED;
    }
    uint32_t corners = gd_polygons_corner_count(polygons);
    work->mesh->face_count = corners - 2 * polygons->polygon_count;
    work->triangle = malloc(work->mesh->face_count * sizeof *work->triangle);
    if (!work->triangle) return GD_NO_MEMORY;
    if (most_corners > 3) return triangulate(work, most_corners);
    memcpy(work->triangle, polygons->corners, corners * sizeof *polygons->corners);
    return GD_OK;
}
