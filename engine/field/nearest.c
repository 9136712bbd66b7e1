#include "field/layout.h"

#include "mesh/canonical.h"

/* Which seed a point's distance is of: from pseudo-source to pseudo-source by the births, without the crossings in between. */

/* Where a walk has got to: a pseudo-source (a vertex, or vertex_count + number of the seed) or, when that is GD_NONE, a point of an edge. */
struct place {
    uint32_t source;
    struct gd_point point;
};

static struct place behind_leg(const struct gd_field *field, const struct gd__leg *leg)
{
    if (leg->kind == GD__LEG_WEDGE) return (struct place){.source = leg->source};
    return (struct place){.source = leg->kind == GD__LEG_SEED ? field->mesh->vertex_count + leg->from : leg->from};
}

static struct place behind_bend(const struct gd_field *field, const struct gd_point *bend)
{
    struct gd__leg leg = gd__field_leg(field, bend);
    return behind_leg(field, &leg);
}

/* The last leg to a vertex begins in a pseudo-source, or bends on the side opposite to the vertex. */
static struct place behind_vertex(const struct gd_field *field, uint32_t vertex)
{
    const struct gd_mesh *mesh = field->mesh;
    struct gd__birth birth = field->birth[vertex];
    if (birth.source != GD_NONE) return (struct place){.source = birth.source};
    double t = birth.x / mesh->side[birth.side].length;
    struct gd_point bend = gd__point_of_edge(mesh, birth.side >> 1, birth.side & 1 ? 1 - t : t);
    return (struct place){.source = bend.kind == GD_POINT_VERTEX ? bend.element : GD_NONE, .point = bend};
}

/* No shortest path bends at a vertex or an edge twice: a longer walk is an error. */
static enum gd_status walk_to_seed(const struct gd_field *field, struct place place, uint32_t *seed)
{
    const struct gd_mesh *mesh = field->mesh;
    uint64_t steps_left = (uint64_t)mesh->vertex_count + mesh->edge_count + 1;
    while (place.source == GD_NONE || place.source < mesh->vertex_count) {
        if (!steps_left--) return GD_INTERNAL;
        place = place.source == GD_NONE ? behind_bend(field, &place.point) : behind_vertex(field, place.source);
    }
    *seed = place.source - mesh->vertex_count;
    return GD_OK;
}

enum gd_status gd_field_nearest(const struct gd_field *field, const struct gd_point *point, double *distance,
                                uint32_t *seed)
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
