#include "field/layout.h"

#include <stdlib.h>

/* A stored wedge in the caller's terms: parameters from the edge's lower-numbered vertex, in the caller's unit. */
static struct gd_wedge export_wedge(const struct gd_field *field, uint32_t edge, uint32_t index, bool reversed)
{
    const struct gd_mesh *mesh = field->mesh;
    const struct gd__wedge *w = &field->wedges[index];
    double length = mesh->side[2 * edge].length, step = length * GD__WEDGE_UNIT;
    double b0 = w->b0 * step, b1 = index + 1 < field->first[edge + 1] ? w[1].b0 * step : length, x = w->x;
    if (reversed) {
        double begin = length - b1;
        b1 = length - b0;
        b0 = begin;
        x = length - x;
    }
    bool at_vertex = w->source < mesh->vertex_count;
    bool left = w->y > 0 || (w->y == 0 && !signbit(w->y)); /* of the edge as stored */
    return (struct gd_wedge){.b0 = b0 * mesh->unit,
                             .b1 = b1 * mesh->unit,
                             .d0 = sqrt((b0 - x) * (b0 - x) + w->y * w->y) * mesh->unit,
                             .d1 = sqrt((b1 - x) * (b1 - x) + w->y * w->y) * mesh->unit,
                             .sigma = gd__field_sigma(field, w->source) * mesh->unit,
                             .tau = left != reversed,
                             .at_vertex = at_vertex,
                             .source = at_vertex ? mesh->index_of_vertex[w->source] : w->source - mesh->vertex_count};
}

enum gd_status gd_field_wedges(const struct gd_field *field, struct gd_vertex a, struct gd_vertex b,
                               struct gd_wedge **out, uint32_t *count)
{
    const struct gd_mesh *mesh = field->mesh;
    uint32_t limit = mesh->summary.index_count;
    uint32_t va = a.index < limit ? mesh->vertex_of_index[a.index] : GD_NONE,
             vb = b.index < limit ? mesh->vertex_of_index[b.index] : GD_NONE;
    uint32_t side = va == GD_NONE || vb == GD_NONE ? GD_NONE : gd__side_between(mesh, va, vb);
    if (side == GD_NONE) return GD_NO_SUCH_EDGE;
    uint32_t edge = side >> 1, first = field->first[edge], end = field->first[edge + 1], kept = 0;
    uint32_t origin = mesh->index_of_vertex[mesh->origin[2 * edge]],
             destination = mesh->index_of_vertex[mesh->origin[2 * edge + 1]];
    bool reversed = origin > destination;
    struct gd_wedge *wedges = malloc(sizeof *wedges * (end - first + 1));
    if (!wedges) return GD_NO_MEMORY;
    for (uint32_t i = 0; i < end - first; i++) {
        uint32_t index = reversed ? end - 1 - i : first + i;
        if (field->wedges[index].source != GD_NONE) wedges[kept++] = export_wedge(field, edge, index, reversed);
    }
    *out = wedges;
    *count = kept;
    return GD_OK;
}
