#include "field/layout.h"

#include "mesh/canonical.h"

/* The nearest seed of a point: follows the predecessors from pseudo-source to pseudo-source,
 * without computing crossings. */

/* Returns the pseudo-source where a leg begins. */
static uint32_t behind_leg(const struct gd_field *field, const struct gd__leg *leg)
{
    if (leg->kind == GD__LEG_WEDGE) return leg->source;
    return leg->kind == GD__LEG_SEED || leg->kind == GD__LEG_CLOSE
               ? field->mesh->vertex_count + leg->from
               : leg->from;
}

/* If the predecessor has no source, the last leg begins at a bend on the side opposite to the
 * vertex. */
uint32_t gd__field_source_behind(const struct gd_field *field, uint32_t vertex)
{
    const struct gd_mesh *mesh = field->mesh;
    struct gd__predecessor predecessor = field->predecessor[vertex];
    if (predecessor.source != GD_NONE || predecessor.side == GD_NONE) return predecessor.source;
    double t = predecessor.x / mesh->side[predecessor.side].length;
    struct gd_point bend =
        gd__point_of_edge(mesh, predecessor.side >> 1, predecessor.side & 1 ? 1 - t : t);
    struct gd__leg leg = gd__field_leg_onward(field, &bend, vertex);
    return leg.kind == GD__LEG_NONE ? GD_NONE : behind_leg(field, &leg);
}

/* Follows pseudo-sources to a seed. No shortest path bends at a vertex twice, so more steps than
 * vertices are an error. */
static enum gd_status walk_to_seed(const struct gd_field *field, uint32_t source, uint32_t *seed)
{
    uint32_t vertices = field->mesh->vertex_count, steps_left = vertices;
    while (source < vertices) {
        if (!steps_left--) return GD_INTERNAL;
        source = gd__field_source_behind(field, source);
    }
    if (source == GD_NONE) return GD_INTERNAL;
    *seed = gd__field_seed_of(field, source);
    return GD_OK;
}

enum gd_status gd_field_nearest(const struct gd_field *field, const struct gd_point *point,
                                double *distance, uint32_t *seed)
{
    struct gd__leg leg = gd__field_leg(field, point);
    if (leg.distance > field->reach) return GD_BEYOND_REACH;
    if (leg.kind == GD__LEG_NONE) {
        *distance = INFINITY;
        *seed = UINT32_MAX;
        return GD_OK;
    }
    enum gd_status status = walk_to_seed(field, behind_leg(field, &leg), seed);
    if (!status) *distance = leg.distance * field->mesh->unit;
    return status;
}

uint32_t gd_field_seed_count(const struct gd_field *field)
{
    return field->seed_count;
}
