#include "gd/cut_locus.h"

#include <stdlib.h>

#include "field/ridges.h"

enum { CHECK_INTERVAL = 64 /* faces */ };

#define LINES_PROGRESS 0.9 /* progress of the call when lines are written */

static void close_ridges(struct gd__ridges *ridges)
{
    gd__members_destroy(&ridges->diagram.members);
    gd__sources_destroy(&ridges->scratch.sources);
    free(ridges->scratch.view);
    free(ridges->scratch.covered.span);
    free(ridges->scratch.spans.span);
    free(ridges->diagram.node);
    free(ridges->diagram.bisector_part);
    free(ridges->angle);
    free(ridges->end);
    free(ridges->along);
}

/* Returns the bytes of the graph, including the copy of an array that grows. */
static size_t held_by(const struct gd__ridges *ridges)
{
    const struct gd__diagram *diagram = &ridges->diagram;
    return diagram->mesh->vertex_count * sizeof *diagram->members.of +
           2 * (diagram->node_capacity * sizeof *diagram->node +
                diagram->bisector_part_capacity * sizeof *diagram->bisector_part +
                ridges->angle_capacity * sizeof *ridges->angle +
                ridges->end_capacity * sizeof *ridges->end +
                ridges->along_capacity * sizeof *ridges->along);
}

static enum gd_status find_parts(struct gd__ridges *ridges, const struct gd_control *control)
{
    uint32_t faces = ridges->diagram.mesh->face_count;
    enum gd_status status = GD_OK;
    for (uint32_t face = 0; face < faces && !status; face++) {
        if (face % CHECK_INTERVAL == 0) {
            status = gd_control_afford(control, held_by(ridges));
            if (!status) status = gd_control_check(control, LINES_PROGRESS * face / faces);
        }
        if (!status) status = gd__ridges_of_face(ridges, face);
    }
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
    struct gd__ridges ridges = {.diagram = {.field = field, .mesh = field->mesh}};
    enum gd_status status = gd__members_find(field, member_of_seed, &ridges.diagram.members);
    if (!status) status = find_parts(&ridges, control);
    if (!status) status = gd__ridges_join(&ridges, fmax(min_angle, GD_CUT_LOCUS_ANGLE));
    const struct gd__export_options export = {options->tolerance / field->mesh->unit, control,
                                              held_by(&ridges), LINES_PROGRESS};
    if (!status) status = gd__diagram_export(&ridges.diagram, &export, out);
    close_ridges(&ridges);
    return status;
}
