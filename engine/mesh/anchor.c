#include "mesh/anchor.h"

#include "mesh/local.h"

static void anchor_edge(const struct gd_mesh *mesh, const struct gd_point *point,
                        struct gd__anchor *anchor)
{
    double length = mesh->side[2 * point->element].length;
    for (uint32_t k = 0; k < 2; k++) {
        anchor->corner[k] = mesh->origin[2 * point->element + k];
        anchor->leg[k] = length * (k ? gd__edge_rest(point) : point->weight[0]);
    }
}

static void anchor_face(const struct gd_mesh *mesh, const struct gd_point *point,
                        struct gd__anchor *anchor)
{
    for (int k = 0; k < 3; k++) {
        uint32_t side = mesh->face_side[point->element][k];
        anchor->corner[k] = mesh->origin[side];
        anchor->leg[k] = gd__local_length(gd__side_local(
            &mesh->side[side], point->weight[(k + 1) % 3], point->weight[(k + 2) % 3]));
    }
}

struct gd__anchor gd__anchor(const struct gd_mesh *mesh, const struct gd_point *point)
{
    struct gd__anchor anchor = {.corner = {GD_NONE, GD_NONE, GD_NONE, GD_NONE},
                                .position =
                                    gd_vec3_scale(gd_point_position(mesh, point), 1 / mesh->unit)};
    switch (point->kind) {
    case GD_POINT_VERTEX:
        anchor.corner[0] = point->element;
        break;
    case GD_POINT_EDGE:
        anchor_edge(mesh, point, &anchor);
        break;
    case GD_POINT_FACE:
        anchor_face(mesh, point, &anchor);
        break;
    }
    return anchor;
}
