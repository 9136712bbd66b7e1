#include "mesh/segment.h"

#include <math.h>

bool gd__point_is_on_edge(const struct gd_mesh *mesh, const struct gd_point *point, uint32_t edge)
{
    if (point->kind == GD_POINT_EDGE) return point->element == edge;
    return point->kind == GD_POINT_VERTEX && (mesh->origin[2 * edge] == point->element ||
                                              mesh->origin[2 * edge + 1] == point->element);
}

bool gd__face_contains(const struct gd_mesh *mesh, uint32_t face, const struct gd_point *point)
{
    const uint32_t *side = mesh->face_side[face], element = point->element;
    switch (point->kind) {
    case GD_POINT_VERTEX:
        return mesh->origin[side[0]] == element || mesh->origin[side[1]] == element ||
               mesh->origin[side[2]] == element;
    case GD_POINT_EDGE:
        return side[gd__place_of_edge(side, element)] >> 1 == element;
    case GD_POINT_FACE:
        return element == face;
    }
    return false;
}

uint32_t gd__common_face(const struct gd_mesh *mesh, const struct gd_point *p,
                         const struct gd_point *q)
{
    if (p->kind == GD_POINT_EDGE && q->kind == GD_POINT_EDGE)
        return gd__face_of_edges(mesh, p->element, q->element);
    if (p->kind == GD_POINT_FACE)
        return gd__face_contains(mesh, p->element, q) ? p->element : GD_NONE;
    if (q->kind != GD_POINT_VERTEX && p->kind == GD_POINT_VERTEX)
        return gd__common_face(mesh, q, p);
    uint32_t begin = 2 * p->element, end = begin + 2;
    if (p->kind == GD_POINT_VERTEX) {
        begin = mesh->fan_first[p->element];
        end = mesh->fan_first[p->element + 1];
    }
    for (uint32_t i = begin; i < end; i++) {
        uint32_t face = mesh->side_face[p->kind == GD_POINT_VERTEX ? mesh->fan[i].side : i];
        if (face != GD_NONE && gd__face_contains(mesh, face, q)) return face;
    }
    return GD_NONE;
}

uint32_t gd__edge_between(const struct gd_mesh *mesh, const struct gd_point *a,
                          const struct gd_point *b)
{
    if (a->kind == GD_POINT_EDGE) return a->element;
    if (b->kind == GD_POINT_EDGE) return b->element;
    if (a->kind == GD_POINT_FACE || b->kind == GD_POINT_FACE) return GD_NONE;
    uint32_t side = gd__side_between(mesh, a->element, b->element);
    return side == GD_NONE ? GD_NONE : side >> 1;
}

bool gd__segment_locate_elsewhere(const struct gd_mesh *mesh, const struct gd_point *a,
                                  const struct gd_point *b, struct gd__segment_location *out)
{
    struct gd__segment_location location = {GD_NONE, GD_NONE};
    if (gd_point_equal(a, b)) return false;
    uint32_t edge = gd__edge_between(mesh, a, b);
    if (edge != GD_NONE && gd__point_is_on_edge(mesh, a, edge) &&
        gd__point_is_on_edge(mesh, b, edge)) {
        location.edge = edge;
    } else {
        location.face = gd__common_face(mesh, a, b);
        if (location.face == GD_NONE) return false;
    }
    *out = location;
    return true;
}

double gd__edge_parameter(const struct gd_mesh *mesh, uint32_t edge, const struct gd_point *point)
{
    double length = mesh->side[2 * edge].length;
    if (point->kind == GD_POINT_EDGE) return point->weight[0] * length;
    return mesh->origin[2 * edge] == point->element ? 0 : length;
}

static struct gd__chord chord_in_frame(const struct gd_mesh *mesh, uint32_t face, int k,
                                       const double from[3], const double to[3])
{
    const struct gd_side *side = &mesh->side[mesh->face_side[face][k]];
    int l = (k + 1) % 3, m = (k + 2) % 3;
    struct gd__local span = gd__side_local(side, to[l] - from[l], to[m] - from[m]);
    double length = sqrt(span.x * span.x + span.y * span.y), inverse = 1 / length;
    return (struct gd__chord){.from = gd__side_local(side, from[l], from[m]),
                              .to = gd__side_local(side, to[l], to[m]),
                              .along = {span.x * inverse, span.y * inverse},
                              .length = length};
}

struct gd__chord gd__chord(const struct gd_mesh *mesh, uint32_t face, int k,
                           const struct gd_point *a, const struct gd_point *b)
{
    double from[3], to[3];
    gd__point_weights(mesh, a, face, from);
    gd__point_weights(mesh, b, face, to);
    return chord_in_frame(mesh, face, k, from, to);
}

void gd__chords(const struct gd_mesh *mesh, uint32_t face, const struct gd_point *a,
                const struct gd_point *b, struct gd__chord out[3])
{
    double from[3], to[3];
    gd__point_weights(mesh, a, face, from);
    gd__point_weights(mesh, b, face, to);
    for (int k = 0; k < 3; k++) out[k] = chord_in_frame(mesh, face, k, from, to);
}
