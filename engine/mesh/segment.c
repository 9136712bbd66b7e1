#include "mesh/segment.h"

#include <math.h>

static bool is_on_edge(const struct gd_mesh *mesh, const struct gd_point *point, uint32_t edge)
{
    if (point->kind == GD_POINT_EDGE) return point->element == edge;
    return point->kind == GD_POINT_VERTEX &&
           (mesh->origin[2 * edge] == point->element || mesh->origin[2 * edge + 1] == point->element);
}

static bool is_in_face(const struct gd_mesh *mesh, const struct gd_point *point, uint32_t face)
{
    if (face == GD_NONE) return false;
    if (point->kind == GD_POINT_FACE) return point->element == face;
    double weight[3];
    gd__point_weights(mesh, point, face, weight);
    return weight[0] + weight[1] + weight[2] > 0;
}

/* The only edge that two points might have in common. */
static uint32_t edge_between(const struct gd_mesh *mesh, const struct gd_point *a, const struct gd_point *b)
{
    if (a->kind == GD_POINT_EDGE) return a->element;
    if (b->kind == GD_POINT_EDGE) return b->element;
    if (a->kind == GD_POINT_FACE || b->kind == GD_POINT_FACE) return GD_NONE;
    uint32_t side = gd__side_between(mesh, a->element, b->element);
    return side == GD_NONE ? GD_NONE : side >> 1;
}

/* A face of `wide`, which is no vertex, that contains the other point. */
static uint32_t face_between(const struct gd_mesh *mesh, const struct gd_point *wide, const struct gd_point *other)
{
    uint32_t faces[2] = {wide->element, GD_NONE};
    if (wide->kind == GD_POINT_EDGE)
        for (uint32_t k = 0; k < 2; k++) faces[k] = mesh->side_face[2 * wide->element + k];
    if (is_in_face(mesh, other, faces[0])) return faces[0];
    return is_in_face(mesh, other, faces[1]) ? faces[1] : GD_NONE;
}

bool gd__segment_home(const struct gd_mesh *mesh, const struct gd_point *a, const struct gd_point *b,
                      struct gd__home *out)
{
    struct gd__home home = {GD_NONE, GD_NONE};
    if (gd_point_equal(a, b)) return false;
    uint32_t edge = edge_between(mesh, a, b);
    if (edge != GD_NONE && is_on_edge(mesh, a, edge) && is_on_edge(mesh, b, edge)) {
        home.edge = edge;
    } else {
        const struct gd_point *wide = a->kind >= b->kind ? a : b;
        if (wide->kind == GD_POINT_VERTEX) return false;
        home.face = face_between(mesh, wide, wide == a ? b : a);
        if (home.face == GD_NONE) return false;
    }
    *out = home;
    return true;
}

double gd__edge_parameter(const struct gd_mesh *mesh, uint32_t edge, const struct gd_point *point)
{
    double length = mesh->side[2 * edge].length;
    if (point->kind == GD_POINT_EDGE) return point->weight[0] * length;
    return mesh->origin[2 * edge] == point->element ? 0 : length;
}

struct gd__chord gd__chord(const struct gd_mesh *mesh, uint32_t face, int k, const struct gd_point *a,
                           const struct gd_point *b)
{
    double from[3], to[3];
    uint32_t side = mesh->face_side[face][k];
    gd__point_weights(mesh, a, face, from);
    gd__point_weights(mesh, b, face, to);
    int l = (k + 1) % 3, m = (k + 2) % 3;
    struct gd__local span = gd__side_local(&mesh->side[side], to[l] - from[l], to[m] - from[m]);
    double length = sqrt(span.x * span.x + span.y * span.y);
    return (struct gd__chord){.from = gd__side_local(&mesh->side[side], from[l], from[m]),
                              .along = {span.x / length, span.y / length},
                              .length = length};
}
