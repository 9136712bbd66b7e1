#include "line/portal.h"

/* Converts the vector `by` to the coordinates of the plane. `by` is given in a frame whose x axis
 * is the unit vector `along`. */
static struct gd__local turned(struct gd__local along, struct gd__local by)
{
    return (struct gd__local){along.x * by.x - along.y * by.y, along.x * by.y + along.y * by.x};
}

static struct gd__local placed(struct gd__local origin, struct gd__local along, struct gd__local at)
{
    struct gd__local way = turned(along, at);
    return (struct gd__local){origin.x + way.x, origin.y + way.y};
}

bool gd__portal_next(const struct gd_mesh *mesh, const struct gd__portal *last,
                     struct gd__portal *out)
{
    const struct gd_side *s = &mesh->side[last->side];
    struct gd__local apex =
        placed(last->left, last->along,
               (struct gd__local){s->left_length * s->left_x, s->left_length * s->left_y});
    if (out->side == s->left)
        *out = (struct gd__portal){s->left, last->left, apex,
                                   turned(last->along, (struct gd__local){s->left_x, s->left_y})};
    else if (out->side == s->right)
        *out = (struct gd__portal){s->right, apex, last->right,
                                   turned(last->along, (struct gd__local){s->right_x, s->right_y})};
    else if (out->side == (last->side ^ 1))
        *out = (struct gd__portal){
            out->side, last->right, last->left, {-last->along.x, -last->along.y}};
    else
        return false;
    return mesh->side_face[out->side] != GD_NONE;
}

struct gd__local gd__portal_place(const struct gd_mesh *mesh, const struct gd__portal *portal,
                                  const struct gd_point *point)
{
    uint32_t face = mesh->side_face[portal->side];
    double weight[3];
    gd__point_weights(mesh, point, face, weight);
    int k = gd__place_of_side(mesh->face_side[face], portal->side);
    return placed(portal->left, portal->along,
                  gd__face_local(mesh, portal->side,
                                 (double[3]){weight[k], weight[(k + 1) % 3], weight[(k + 2) % 3]}));
}

struct gd__portal gd__portal_entrance(const struct gd_mesh *mesh, uint32_t face)
{
    uint32_t side = mesh->face_side[face][0];
    return (struct gd__portal){side, {0, 0}, {mesh->side[side].length, 0}, {1, 0}};
}
