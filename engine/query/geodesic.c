/* The simple interface: gd_mesh_load, gd_distance, gd_path. */
#include "gd/geodesic.h"

#include "base/share.h"

static size_t bytes_of_polygons(const struct gd_polygons *polygons)
{
    return polygons->position_count * sizeof *polygons->positions +
           gd_polygons_corner_count(polygons) * sizeof *polygons->corners +
           (polygons->first ? (polygons->polygon_count + (size_t)1) * sizeof *polygons->first : 0);
}

static enum gd_status query_geodesic_load(const void *bytes, size_t size,
                                          const struct gd_load_options *options,
                                          struct gd_mesh **out, struct gd_detail *detail)
{
    struct gd__share share = {.control = options->control, .total = 2};
    struct gd_control control = gd__share_control(&share, 0);
    struct gd_mended skipped = {0};
    struct gd_mesh_options building = options->mesh;
    building.lines_skipped = &skipped;
    const struct gd_read_options reading = {.format = options->format,
                                            .max_faces = options->max_faces,
                                            .max_vertices = options->max_vertices,
                                            .control = &control,
                                            .skipped =
                                                options->mesh.repair_split ? &skipped : NULL};
    enum gd_status status = GD_OK;
    if (control.budget_bytes)
        status = gd_control_afford(&control, gd_read_cost(bytes, size, &reading));
    struct gd_polygons polygons;
    if (!status) status = gd_read_polygons(bytes, size, &reading, &polygons, detail);
    if (status) return status;
    share.done = 1;
    control = gd__share_control(&share, bytes_of_polygons(&polygons));
    status = gd_mesh_build_consuming(&polygons, &building, &control, out, detail);
    gd_polygons_free(&polygons);
    return status;
}

enum gd_status gd_mesh_load(const void *bytes, size_t size, const struct gd_load_options *options,
                            struct gd_mesh **out, struct gd_detail *error)
{
    const struct gd_load_options defaults = {0};
    struct gd_detail detail = {0};
    enum gd_status status =
        query_geodesic_load(bytes, size, options ? options : &defaults, out, &detail);
    if (!status || !error) return status;
    if (!detail.text[0]) status = gd_fail_status(&detail, status);
    *error = detail;
    return status;
}

enum gd_status gd_distance(const struct gd_mesh *mesh, const struct gd_point *from,
                           const struct gd_point *to, double *out)
{
    struct gd_pair_answer answer;
    enum gd_status status =
        gd_pair_solve(mesh, &(struct gd_pair_request){.from = from, .to = to}, NULL, &answer, NULL);
    if (!status) *out = answer.distance;
    return status;
}

enum gd_status gd_path(const struct gd_mesh *mesh, const struct gd_point *from,
                       const struct gd_point *to, struct gd_path *out)
{
    struct gd_pair_answer answer;
    enum gd_status status = gd_pair_solve(
        mesh, &(struct gd_pair_request){.from = from, .to = to, .output = GD_PAIR_PATH}, NULL,
        &answer, NULL);
    if (!status && answer.path.count == 0) status = GD_NOT_ON_SURFACE;
    if (!status) *out = answer.path;
    return status;
}
