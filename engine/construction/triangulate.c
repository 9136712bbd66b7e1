/* Converts polygons to triangles. The triangles of a polygon are consecutive. Each triangle of a
 * divided polygon has at least one new diagonal, so two polygons cannot give the same triangle. */
#include <stdlib.h>
#include <string.h>

#include "base/large.h"
#include "construction/steps.h"
#include "construction/ear.h"

static uint32_t triangulate_size_of(const struct gd_polygons *polygons, uint32_t polygon)
{
    return gd_polygons_first(polygons, polygon + 1) - gd_polygons_first(polygons, polygon);
}

static uint32_t largest_polygon(const struct gd_polygons *polygons, struct gd__pace *pace,
                                uint32_t *which)
{
    uint32_t most = 0;
    GD__PACED (pace, i, polygons->polygon_count) {
        if (triangulate_size_of(polygons, i) <= most) continue;
        most = triangulate_size_of(polygons, i);
        *which = i;
    }
    return most;
}

static void insert_ring(struct gd__edge_set *edges, const uint32_t *corner, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        gd__edge_set_insert(edges, corner[i], corner[i + 1 < count ? i + 1 : 0]);
}

static enum gd_status refuse_split(struct gd__construction *work, uint32_t polygon,
                                   const uint32_t *corner, uint32_t count)
{
    uint32_t repeated = gd__repeated_corner(corner, count);
    enum gd_status status = repeated == GD_NONE ? GD_NOT_TRIANGULABLE : GD_DEGENERATE_FACE;
    if (repeated == GD_NONE)
        gd_fail(work->detail, status,
                "face %u with %u corners can't be split into triangles: its diagonals are edges of "
                "other faces",
                polygon, count);
    else
        gd_fail(work->detail, status,
                "face %u has vertex %u as two of its corners, and is not a ring with a bridge to a "
                "hole: it can't be split into triangles",
                polygon, repeated);
    gd_detail_add(work->detail, GD_ELEMENT_FACE, polygon, 0);
    return status;
}

/* Triangulates one polygon into triangle[0 .. n-3] and adds its diagonals to the edge set. */
static enum gd_status triangulate_split(struct gd__construction *work, uint32_t polygon,
                                        struct gd__ear_clipper *clipper, struct gd__edge_set *edges,
                                        uint32_t (*triangle)[3])
{
    const struct gd_polygons *polygons = work->polygons;
    uint32_t count = triangulate_size_of(polygons, polygon);
    const uint32_t *corner = polygons->corners + gd_polygons_first(polygons, polygon);
    if (count == 3) {
        memcpy(triangle, corner, sizeof *triangle);
        return GD_OK;
    }
    if (!gd__ear_clip(clipper, (const double(*)[3])polygons->positions, corner, count, edges,
                      triangle))
        return refuse_split(work, polygon, corner, count);
    for (uint32_t i = 0; i < count - 2; i++) insert_ring(edges, triangle[i], 3);
    return GD_OK;
}

/* Assigns face indices to the triangles of a polygon. A face index counts the triangles of the
 * input's polygons, before vertices are merged. If a polygon lost corners, its last indices are not
 * used. Returns the first index of the next polygon. */
static uint32_t name_triangles(struct gd__construction *work, uint32_t polygon, uint32_t made,
                               uint32_t index)
{
    uint32_t count = triangulate_size_of(work->polygons, polygon),
             end = index + triangulate_size_of(work->input, polygon) - 2;
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
                    triangulate_size_of(polygons, i));
    uint32_t made = 0, index = 0;
    for (uint32_t i = 0; i < polygons->polygon_count; i++) {
        uint32_t size = triangulate_size_of(polygons, i);
        double done = (double)i / polygons->polygon_count;
        work->pace.fraction = work->progress + (work->progress_end - work->progress) * done;
        if (!gd__pace(&work->pace, size > 4 ? GD__PACE_STEPS : 16)) return work->pace.status;
        enum gd_status status =
            size ? triangulate_split(work, i, clipper, edges, work->triangle + made) : GD_OK;
        if (status) return status;
        index = name_triangles(work, i, made, index);
        if (size) made += size - 2;
    }
    return GD_OK;
}

static enum gd_status triangulate_polygons(struct gd__construction *work, uint32_t most_corners)
{
    struct gd_mesh *mesh = work->mesh;
    struct gd__edge_set edges = {0};
    struct gd__ear_clipper *clipper = gd__ear_clipper_create(most_corners);
    enum gd_status status = clipper ? GD_OK : GD_NO_MEMORY;
    /* the set must have room for all edges and all diagonals of the polygons */
    if (!status)
        status = gd__edge_set_create(gd_polygons_corner_count(work->polygons) +
                                         (uint64_t)mesh->face_count,
                                     &work->pace, &edges);
    if (!status) status = split_all(work, clipper, &edges);
    gd__edge_set_free(&edges);
    gd__ear_clipper_free(clipper);
    return status;
}

/* Copies the corners, if all polygons are triangles. */
static void take_triangles(struct gd__construction *work)
{
    const uint32_t *corners = work->polygons->corners;
    GD__PACED (&work->pace, i, work->mesh->face_count)
        memcpy(work->triangle[i], corners + 3 * (size_t)i, sizeof *work->triangle);
    uint32_t made = 0, index = 0;
    if (!work->face_index) return;
    GD__PACED (&work->pace, i, work->polygons->polygon_count) {
        index = name_triangles(work, i, made, index);
        made += triangulate_size_of(work->polygons, i) > 0;
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
        count += triangulate_size_of(polygons, i) ? triangulate_size_of(polygons, i) - 2 : 0;
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
    if (!work->polygons->first && !work->options.repair_split) {
        work->triangle = (uint32_t(*)[3])work->polygons->corners;
        return GD_OK;
    }
    work->triangle = gd__large_array(mesh->face_count, sizeof *work->triangle);
    if (edited) work->face_index = gd__large_array(mesh->face_count, sizeof *work->face_index);
    if (!work->triangle || (edited && !work->face_index)) return GD_NO_MEMORY;
    if (largest_polygon(work->input, &work->pace, &which) > 3) {
        mesh->source_polygon =
            gd__mesh_array(work, mesh->summary.face_index_count, sizeof *mesh->source_polygon);
        if (!mesh->source_polygon) return GD_NO_MEMORY;
    }
    if (most_corners > 3) return triangulate_polygons(work, most_corners);
    take_triangles(work);
    return GD_OK;
}
