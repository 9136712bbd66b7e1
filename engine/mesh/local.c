#include "mesh/local.h"

/* Nothing here can be foretold, so that nothing is branched on but what never happens. */
static void put_on_edge(const uint32_t side[3], const struct gd_point *point, double weight[3])
{
    static const uint8_t next[3] = {1, 2, 0};
    int k = gd__place_of_edge(side, point->element);
    if (side[k] >> 1 != point->element) return;
    double of_end[2] = {1 - point->weight[0], point->weight[0]}; /* of side 0 of the edge */
    weight[k] = of_end[side[k] & 1];
    weight[next[k]] = of_end[~side[k] & 1];
}

void gd__point_weights(const struct gd_mesh *mesh, const struct gd_point *point, uint32_t face, double weight[3])
{
    const uint32_t *side = mesh->face_side[face];
    weight[0] = weight[1] = weight[2] = 0;
    switch (point->kind) {
    case GD_POINT_VERTEX:
        for (int k = 0; k < 3; k++) weight[k] = mesh->origin[side[k]] == point->element ? 1 : 0;
        break;
    case GD_POINT_EDGE:
        put_on_edge(side, point, weight);
        break;
    case GD_POINT_FACE:
        for (int k = 0; k < 3; k++) weight[k] = point->weight[k];
        break;
    }
}
