#include <stdlib.h>
#include <string.h>

#include "field/layout.h"

static enum gd_status check_resume(const struct gd_field *partial, double radius,
                                   struct gd_detail *detail)
{
    if (!(radius >= 0))
        return gd_fail(detail, GD_INVALID_ARGUMENT, "the radius must be zero (no limit) or more");
    if (partial->reach >= GD__FAR)
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the field is complete: there is nothing to resume");
    if (radius > 0 && radius / partial->mesh->unit <= partial->reach)
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the radius %g must be greater than the field's reach, %g", radius,
                       gd_field_reach(partial));
    bool is_sound = partial->reach >= 0;
    for (uint32_t v = 0; v < partial->mesh->vertex_count; v++)
        is_sound &= partial->distance[v] >= 0;
    if (!is_sound)
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the field is damaged: it has distances below zero");
    return GD_OK;
}

static enum gd_status copy_seeds(struct gd_field *field, const struct gd_field *from)
{
    field->seeds = malloc(from->seed_count * sizeof *field->seeds);
    if (!field->seeds) return GD_NO_MEMORY;
    memcpy(field->seeds, from->seeds, from->seed_count * sizeof *field->seeds);
    field->seed_count = from->seed_count;
    return gd__field_index_seeds(field);
}

/* Returns true if stored wedges are too coarse to resume from. Their ends are rounded to 2^-32 of
 * their edges, which is too much if the reach or the shortest edge is small compared with the
 * longest edge. */
static bool is_coarse(const struct gd_field *partial)
{
    const struct gd_mesh *mesh = partial->mesh;
    return gd__mesh_is_graded(mesh) ||
           partial->reach < GD_TOL_COARSE_REACH * mesh->summary.edge_length.max / mesh->unit;
}

static void add_statistics(struct gd_field_statistics *to, const struct gd_field_statistics *from)
{
    to->windows_created += from->windows_created;
    to->windows_propagated += from->windows_propagated;
    to->sides_propagated += from->sides_propagated;
    to->vertices_emitted += from->vertices_emitted;
    to->build_ns += from->build_ns;
}

static enum gd_status resume_field(struct gd_field *field, const struct gd_field *partial,
                                   double radius, const struct gd_control *control)
{
    enum gd_status status = copy_seeds(field, partial);
    if (status) return status;
    const struct gd__partial_state state = {.bound = partial->reach,
                                            .distance = partial->distance,
                                            .predecessor = partial->predecessor,
                                            .newest = partial->newest,
                                            .wedges = partial->wedges,
                                            .wedge_bytes = partial->wedge_bytes,
                                            .wedge_count = partial->statistics.wedges};
    struct gd__propagation propagation = {.seeds = field->seeds,
                                          .seed_count = field->seed_count,
                                          .radius =
                                              radius > 0 ? radius / field->mesh->unit : GD__FAR};
    bool continues = !is_coarse(partial);
    if (continues) propagation.partial = &state;
    status = gd__field_propagate(field, &propagation, control);
    if (continues) add_statistics(&field->statistics, &partial->statistics);
    return status;
}

enum gd_status gd_field_resume(const struct gd_field *partial, double radius,
                               const struct gd_control *control, struct gd_field **out,
                               struct gd_detail *detail)
{
    enum gd_status status = check_resume(partial, radius, detail);
    if (status) return status;
    struct gd_field *field = gd__field_create(partial->mesh);
    if (!field) return gd_fail_status(detail, GD_NO_MEMORY);
    status = resume_field(field, partial, radius, control);
    if (status) {
        gd_field_release(field);
        return gd_fail_status(detail, status);
    }
    *out = field;
    return GD_OK;
}
