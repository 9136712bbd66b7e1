/* The steps of repair=split on triangles: removes faces without area and duplicate faces, then
 * splits edges and vertices with too many faces. */
#include "repair/repair.h"

#include <stdlib.h>
#include <string.h>

#include "base/large.h"

/* Stores the input index of each face, because the next steps remove faces. */
static enum gd_status name_faces(struct gd__construction *work)
{
    if (work->face_index) return GD_OK;
    work->face_index = gd__large_array(work->mesh->face_count, sizeof *work->face_index);
    if (!work->face_index) return GD_NO_MEMORY;
    GD__PACED (&work->pace, f, work->mesh->face_count) work->face_index[f] = f;
    return GD_OK;
}

enum gd_status gd__compact_triangles(struct gd__construction *work)
{
    enum gd_status status = name_faces(work);
    if (status) return status;
    uint32_t end = 0;
    GD__PACED (&work->pace, f, work->mesh->face_count) {
        if (work->triangle[f][0] == GD_NONE) continue;
        memcpy(work->triangle[end], work->triangle[f], sizeof *work->triangle);
        work->face_index[end++] = work->face_index[f];
    }
    if (work->pace.status) return work->pace.status;
    work->mesh->face_count = end;
    if (end) return GD_OK;
    return gd_fail(work->detail, GD_EMPTY, "no face is left: none of them has an area");
}

/* Removes duplicate faces, which flips and merges may have created. */
static enum gd_status drop_duplicates(struct gd__construction *work)
{
    const struct gd_polygons triangles = {
        .position_count = work->input->position_count,
        .polygon_count = work->mesh->face_count,
        .corners = *work->triangle,
    };
    uint32_t *original = gd__large_array(triangles.polygon_count, sizeof *original);
    enum gd_status status =
        original ? gd__find_duplicates(&triangles, &work->pace, original) : GD_NO_MEMORY;
    GD__PACED (&work->pace, f, status ? 0 : triangles.polygon_count) {
        if (original[f] == f) continue;
        gd_mended_add(&work->mesh->repair->duplicate_faces, gd__index_of_triangle(work, f),
                      gd__index_of_triangle(work, original[f]));
        work->triangle[f][0] = GD_NONE;
    }
    free(original);
    return status ? status : gd__compact_triangles(work);
}

/* Checks the budget for the copies of vertices. The bound of gd_mesh_build_cost exceeds the need
 * without copies by about 50 bytes a face. A copy and its edges take 160 bytes. So the bound is
 * enough for one copy for every four faces. */
static enum gd_status afford_copies(const struct gd__construction *work, uint32_t faces)
{
    if (work->copy_count <= faces / 4) return GD_OK;
    return gd__afford(work, faces,
                      (uint64_t)work->input->position_count + work->copy_count - faces / 4);
}

enum gd_status gd__repair(struct gd__construction *work)
{
    if (!work->options.repair_split) return GD_OK;
    uint32_t faces = work->mesh->face_count;
    const struct gd_mesh_repair *repair = work->mesh->repair;
    uint32_t merged = repair->vertices_merged.count;
    enum gd_status status = gd__flatten_faces(work);
    if (!status && (repair->edges_flipped.count || repair->vertices_merged.count > merged))
        status = drop_duplicates(work);
    if (!status) status = gd__split_faces(work);
    return status ? status : afford_copies(work, faces);
}
