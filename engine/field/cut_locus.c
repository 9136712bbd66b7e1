#include "gd/cut_locus.h"

#include "field/ridges.h"

enum { STEPS_OF_FACE = 64 /* time for a face with few sources, in steps of pace.h */ };

#define LINES_PROGRESS 0.9 /* progress of the call when lines are written */

static enum gd_status find_parts(struct gd__ridges *ridges)
{
    uint32_t faces = ridges->diagram.mesh->face_count;
    enum gd_status status = GD_OK;
    for (uint32_t face = 0; face < faces && !status; face++) {
        ridges->pace.fraction = LINES_PROGRESS * face / faces;
        status = gd__pace_step(&ridges->pace, STEPS_OF_FACE);
        if (!status) status = gd__ridges_of_face(ridges, face);
        if (!status) status = gd__ridges_settle(ridges, face);
    }
    return status;
}

static enum gd_status trace_ridges(struct gd__ridges *ridges, const uint32_t *member_of_seed)
{
    struct gd__diagram *diagram = &ridges->diagram;
    enum gd_status status =
        gd__members_find(diagram->field, member_of_seed, &diagram->arena, &diagram->members);
    if (!status) status = gd__ridges_open(ridges);
    if (!status) status = find_parts(ridges);
    if (!status) status = gd__ridges_finish(ridges);
    if (!status) gd__ridges_count(ridges);
    if (!status) status = gd__ridges_close_gaps(ridges);
    if (!status) status = gd__ridges_keep_branches(ridges);
    return status;
}

enum gd_status gd_cut_locus_trace(const struct gd_field *field, const uint32_t *member_of_seed,
                                  const struct gd_cut_locus_options *options,
                                  const struct gd_control *control, struct gd_voronoi *out)
{
    double min_angle = options->min_angle;
    if (!(options->tolerance > 0 && min_angle >= 0 && min_angle <= M_PI))
        return GD_INVALID_ARGUMENT;
    if (field->reach < GD__FAR) return GD_BEYOND_REACH;
    struct gd__ridges ridges = {
        .diagram = {.field = field, .mesh = field->mesh, .arena.budget.control = control},
        .tolerance = options->tolerance / field->mesh->unit,
        .min_angle = fmax(min_angle, GD_CUT_LOCUS_ANGLE),
        .pace.control = control};
    enum gd_status status = trace_ridges(&ridges, member_of_seed);
    const struct gd__export_options export = {ridges.tolerance, control, LINES_PROGRESS};
    if (!status) status = gd__diagram_export(&ridges.diagram, &export, out);
    gd__ridges_close(&ridges);
    return status;
}
