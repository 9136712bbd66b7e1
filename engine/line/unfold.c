#include "line/unfold.h"

#include "line/portal.h"
#include "mesh/segment.h"

/* Measures the line between two points of one face. Computes it from differences of weights, in the
 * frame of the corner nearest to the first point. So the direction of a short line is precise. */
static void measure_in_face(const struct gd_mesh *mesh, uint32_t face, const struct gd_point *a,
                            const struct gd_point *b, struct gd__straight *out)
{
    double from[3], to[3];
    gd__point_weights(mesh, a, face, from);
    gd__point_weights(mesh, b, face, to);
    int k = gd__main_corner(from);
    uint32_t side = mesh->face_side[face][k];
    struct gd__local d = gd__leg_key_in_face(mesh, face, k, from, to);
    out->length = hypot(d.x, d.y);
    /* for equal points any direction is valid, but it must be the same for both turns */
    if (out->length == 0) d.x = 1;
    out->ahead = gd__turn_in_face(mesh, a, side, d.x, d.y);
    out->back = gd__turn_in_face(mesh, b, side, -d.x, -d.y);
}

/* Returns the side of an edge by which a line leaves the face behind a portal: the left or the
 * right edge of the face, or the portal's own edge. */
static uint32_t side_of(const struct gd_mesh *mesh, const struct gd__portal *portal, uint32_t edge)
{
    const struct gd_side *s = &mesh->side[portal->side];
    return s->left >> 1 == edge ? s->left : s->right >> 1 == edge ? s->right : portal->side ^ 1;
}

enum gd_status gd__unfold(const struct gd_mesh *mesh, const struct gd_point *points, uint32_t count,
                          struct gd__straight *out)
{
    const struct gd_point *a = &points[0], *b = &points[count - 1];
    /* points [begin, end) are on crossed edges that contain neither end of the line */
    uint32_t begin = 1, end = count - 1;
    while (begin < end && gd__point_is_on_edge(mesh, a, points[begin].element)) begin++;
    while (begin < end && gd__point_is_on_edge(mesh, b, points[end - 1].element)) end--;
    uint32_t face = gd__common_face(mesh, a, begin < end ? &points[begin] : b);
    if (face == GD_NONE) return GD_INTERNAL;
    if (begin == end) {
        measure_in_face(mesh, face, a, b, out);
        return GD_OK;
    }
    struct gd__portal first = gd__portal_entrance(mesh, face), last = first;
    for (uint32_t i = begin; i < end; i++) {
        struct gd__portal next = {.side = side_of(mesh, &last, points[i].element)};
        bool is_side = next.side >> 1 == points[i].element;
        if (!is_side || !gd__portal_next(mesh, &last, &next)) return GD_INTERNAL;
        last = next;
    }
    if (!gd__face_contains(mesh, mesh->side_face[last.side], b)) return GD_INTERNAL;
    struct gd__local from = gd__portal_place(mesh, &first, a),
                     to = gd__portal_place(mesh, &last, b), u = last.along;
    double x = to.x - from.x, y = to.y - from.y, length = hypot(x, y);
    if (length == 0) x = 1;
    *out = (struct gd__straight){
        .length = length,
        .ahead = gd__turn_in_face(mesh, a, first.side, x, y),
        .back = gd__turn_in_face(mesh, b, last.side, -(x * u.x + y * u.y), x * u.y - y * u.x)};
    return GD_OK;
}
