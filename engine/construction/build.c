/* gd_mesh_build: runs the steps in order. */
#include <stdlib.h>

#include "construction/steps.h"
#include "mesh/bvh.h"
#include "repair/repair.h"

struct step {
    enum gd_status (*run)(struct gd__construction *work);
    double done; /* progress of the build after this step, measured on a sphere of 328k faces */
};

static const struct step steps[] = {
    {gd__merge_vertices, 0},   {gd__validate_corners, 0.03},
    {gd__triangulate, 0.05},   {gd__repair, 0.05},
    {gd__order, 0.17},         {gd__scale, 0.23},
    {gd__connect, 0.34},       {gd__orient, 0.38},
    {gd__check_vertices, 0.4}, {gd__make_sides, 0.65},
    {gd__measure, 0.7},        {gd__make_fans, 0.94},
    {gd__summarise, 0.95},     {gd__make_bvh, 1},
};

static enum gd_status run_steps(struct gd__construction *work)
{
    work->progress_end = 0;
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        work->progress = work->pace.fraction = work->progress_end;
        work->progress_end = steps[i].done;
        enum gd_status status = gd_control_check(work->control, work->progress);
        if (!status) status = steps[i].run(work);
        if (status || work->pace.status) return status;
    }
    return gd_control_check(work->control, 1);
}

/* Returns the status of a step. A step that the pace has stopped may report an error about
 * unfinished data, so the status of the pace replaces the step's status. */
static enum gd_status outcome(const struct gd__construction *work, enum gd_status status)
{
    if (!work->pace.status) return status;
    if (work->detail) *work->detail = (struct gd_detail){0};
    return work->pace.status;
}

static void free_scratch(struct gd__construction *work)
{
    free(work->representative);
    free(work->merged.corners);
    free(work->merged.first);
    if (work->triangle && work->triangle[0] != work->polygons->corners) free(work->triangle);
    free(work->face_index);
    gd__scratch_free(work, work->corner);
    gd__scratch_free(work, work->neighbour);
    gd__scratch_free(work, work->component);
    gd__scratch_free(work, work->any_corner);
    gd__scratch_free(work, work->measure);
    gd__scratch_free(work, work->edge_length);
}

/* Builds the mesh of work->input. */
static enum gd_status build(struct gd__construction *work, const struct gd_mesh_options *options,
                            struct gd_mesh **out)
{
    const struct gd_polygons *polygons = work->polygons = work->input;
    work->pace.control = work->control;
    if (options) work->options = *options;
    enum gd_status status = outcome(work, gd__validate(work));
    if (!status)
        status = gd__afford(
            work, gd_polygons_corner_count(polygons) - 2 * (uint64_t)polygons->polygon_count,
            polygons->position_count);
    if (status) return status;
    work->mesh = calloc(1, sizeof *work->mesh);
    if (!work->mesh) return GD_NO_MEMORY;
    work->mesh->bytes = sizeof *work->mesh;
    atomic_init(&work->mesh->references, 1);
    status = outcome(work, run_steps(work));
    free_scratch(work);
    if (status)
        gd_mesh_release(work->mesh);
    else
        *out = work->mesh;
    return status;
}

enum gd_status gd_mesh_build(const struct gd_polygons *polygons,
                             const struct gd_mesh_options *options,
                             const struct gd_control *control, struct gd_mesh **out,
                             struct gd_detail *detail)
{
    struct gd__construction work = {.input = polygons, .control = control, .detail = detail};
    return build(&work, options, out);
}

enum gd_status gd_mesh_build_consuming(struct gd_polygons *polygons,
                                       const struct gd_mesh_options *options,
                                       const struct gd_control *control, struct gd_mesh **out,
                                       struct gd_detail *detail)
{
    struct gd__construction work = {
        .input = polygons, .consumed = polygons, .control = control, .detail = detail};
    return build(&work, options, out);
}
