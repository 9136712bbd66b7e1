#include "mesh/local.h"

void gd__point_weights(const struct gd_mesh *mesh, const struct gd_point *point, uint32_t face, double weight[3])
{
    weight[0] = weight[1] = weight[2] = 0;
    for (int k = 0; k < 3; k++) {
        uint32_t side = mesh->face_side[face][k];
        switch (point->kind) {
        case GD_POINT_VERTEX:
            if (mesh->origin[side] == point->element) weight[k] = 1;
            break;
        case GD_POINT_EDGE:
            if (side >> 1 != point->element) break;
            weight[k] = side & 1 ? point->weight[0] : 1 - point->weight[0];
            weight[(k + 1) % 3] = side & 1 ? 1 - point->weight[0] : point->weight[0];
            break;
        case GD_POINT_FACE:
            weight[k] = point->weight[k];
            break;
        }
    }
}
