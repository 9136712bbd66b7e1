/* Polygons to triangles. The triangles of a polygon stand together; each holds at least one
 * diagonal that was no edge before, so that no two polygons can yield the same triangle. */
#include <stdlib.h>
#include <string.h>

#include "base/large.h"
#include "construction/steps.h"
#include "construction/ear.h"

static uint32_t size_of(const struct gd_polygons *polygons, uint32_t polygon)
{
    return gd_polygons_first(polygons, polygon + 1) - gd_polygons_first(polygons, polygon);
}

static uint32_t largest_polygon(const struct gd_polygons *polygons, struct gd__pace *pace,
                                uint32_t *which)
{
    uint32_t most = 0;
    GD__PACED (pace, i, polygons->polygon_count) {
        if (size_of(polygons, i) <= most) continue;
        most = size_of(polygons, i);
        *which = i;
    }
    return most;
}

static void insert_ring(struct gd__edge_set *edges, const uint32_t *corner, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        gd__edge_set_insert(edges, corner[i], corner[i + 1 < count ? i + 1 : 0]);
}

/* Triangulates one polygon into triangle[0 .. n-3] and makes its diagonals edges. */
static enum gd_status split(struct gd__construction *work, uint32_t polygon,
                            struct gd__ear_clipper *clipper, struct gd__edge_set *edges,
                            uint32_t (*triangle)[3])
{
    const struct gd_polygons *polygons = work->polygons;
    uint32_t count = size_of(polygons, polygon);
    const uint32_t *corner = polygons->corners + gd_polygons_first(polygons, polygon);
    if (count == 3) {
        memcpy(triangle, corner, sizeof *triangle);
        return GD_OK;
    }
    if (!gd__ear_clip(clipper, (const double(*)[3])polygons->positions, corner, count, edges,
                      triangle)) {
        gd_fail(work->detail, GD_NOT_TRIANGULABLE,
                "face %u with %u corners can't be split into triangles: its diagonals are edges of "
                "other faces",
                polygon, count);
        gd_detail_add(work->detail, GD_ELEMENT_FACE, polygon, 0);
        return GD_NOT_TRIANGULABLE;
    }
    for (uint32_t i = 0; i < count - 2; i++) insert_ring(edges, triangle[i], 3);
    return GD_OK;
}

/* Face indices count the triangles of the uploaded polygons: a polygon that lost corners leaves its
 * last ones unused. Returns the first index of the next polygon. */
static uint32_t name_triangles(struct gd__construction *work, uint32_t polygon, uint32_t made,
                               uint32_t index)
{
    uint32_t count = size_of(work->polygons, polygon),
             end = index + size_of(work->input, polygon) - 2;
    for (uint32_t k = 0; work->face_index && k + 2 < count; k++)
        work->face_index[made + k] = index + k;
    for (uint32_t i = index; work->mesh->source_polygon && i < end; i++)
        work->mesh->source_polygon[i] = polygon;
    return end;
}

static enum gd_status split_all(struct gd__construction *work, struct gd__ear_clipper *clipper,
                                struct gd__edge_set *edges)
{
    const struct gd_polygons *polygons = work->polygons;
    GD__PACED (&work->pace, i, polygons->polygon_count)
        insert_ring(edges, polygons->corners + gd_polygons_first(polygons, i),
                    size_of(polygons, i));
    uint32_t made = 0, index = 0;
    for (uint32_t i = 0; i < polygons->polygon_count; i++) {
        uint32_t size = size_of(polygons, i);
        double done = (double)i / polygons->polygon_count;
        work->pace.fraction = work->begun + (work->until - work->begun) * done;
        if (!gd__pace(&work->pace, size > 4 ? GD__PACE_STEPS : 16)) return work->pace.status;
        enum gd_status status =
            size ? split(work, i, clipper, edges, work->triangle + made) : GD_OK;
        if (status) return status;
        index = name_triangles(work, i, made, index);
        if (size) made += size - 2;
    }
    return GD_OK;
}

static enum gd_status triangulate(struct gd__construction *work, uint32_t most_corners)
{
    struct gd_mesh *mesh = work->mesh;
    struct gd__edge_set edges = {0};
    struct gd__ear_clipper *clipper = gd__ear_clipper_create(most_corners);
    enum gd_status status = clipper ? GD_OK : GD_NO_MEMORY;
    /* every edge of every polygon, and its diagonals */
    if (!status)
        status = gd__edge_set_create(gd_polygons_corner_count(work->polygons) +
                                         (uint64_t)mesh->face_count,
                                     &work->pace, &edges);
    if (!status) status = split_all(work, clipper, &edges);
    gd__edge_set_free(&edges);
    gd__ear_clipper_free(clipper);
    return status;
}

/* The corners are the triangles. */
static void take_triangles(struct gd__construction *work)
{
    const uint32_t *corners = work->polygons->corners;
    GD__PACED (&work->pace, i, work->mesh->face_count)
        memcpy(work->triangle[i], corners + 3 * (size_t)i, sizeof *work->triangle);
    uint32_t made = 0, index = 0;
    if (!work->face_index) return;
    GD__PACED (&work->pace, i, work->polygons->polygon_count) {
        index = name_triangles(work, i, made, index);
        made += size_of(work->polygons, i) > 0;
    }
}

static enum gd_status refuse_size(struct gd__construction *work, uint32_t polygon, uint32_t corners)
{
    gd_fail(work->detail, GD_UNSUPPORTED,
            "face %u has %u corners; at most %u are supported, split it", polygon, corners,
            GD_EAR_MAX_CORNERS);
    gd_detail_add(work->detail, GD_ELEMENT_FACE, polygon, 0);
    return GD_UNSUPPORTED;
}

static uint32_t count_triangles(const struct gd_polygons *polygons, struct gd__pace *pace)
{
    uint32_t count = 0;
    GD__PACED (pace, i, polygons->polygon_count)
        count += size_of(polygons, i) ? size_of(polygons, i) - 2 : 0;
    return count;
}

enum gd_status gd__triangulate(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    bool edited = work->polygons != work->input;
    uint32_t which = 0, most_corners = largest_polygon(work->polygons, &work->pace, &which);
    if (most_corners > GD_EAR_MAX_CORNERS) return refuse_size(work, which, most_corners);
    mesh->face_count = count_triangles(work->polygons, &work->pace);
    mesh->summary.face_index_count = count_triangles(work->input, &work->pace);
    work->triangle = gd__large_array(mesh->face_count, sizeof *work->triangle);
    if (edited) work->face_index = gd__large_array(mesh->face_count, sizeof *work->face_index);
    if (!work->triangle || (edited && !work->face_index)) return GD_NO_MEMORY;
    if (largest_polygon(work->input, &work->pace, &which) > 3) {
        mesh->source_polygon =
            gd__mesh_array(mesh, mesh->summary.face_index_count, sizeof *mesh->source_polygon);
        if (!mesh->source_polygon) return GD_NO_MEMORY;
    }
    if (most_corners > 3) return triangulate(work, most_corners);
    take_triangles(work);
    return GD_OK;
}
