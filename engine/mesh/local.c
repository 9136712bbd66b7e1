#include "mesh/local.h"

void gd__point_weights_off_edges(const struct gd_mesh *mesh, const struct gd_point *point,
                                 uint32_t face, double weight[3])
{
    const uint32_t *side = mesh->face_side[face];
    bool is_inside = point->kind == GD_POINT_FACE;
    for (int k = 0; k < 3; k++)
        weight[k] = is_inside ? point->weight[k] : mesh->origin[side[k]] == point->element ? 1 : 0;
}
