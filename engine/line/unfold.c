#include "line/unfold.h"

#include "field/face_frame.h"

/* Position of a face in the plane of the first face: the frame of `side` begins at `origin`, with
 * the x axis `along`. */
struct laid {
    uint32_t side;
    struct gd__local origin, along;
};

static struct gd__local unfold_place(const struct laid *laid, struct gd__local at)
{
    struct gd__local u = laid->along;
    return (struct gd__local){laid->origin.x + at.x * u.x - at.y * u.y,
                              laid->origin.y + at.x * u.y + at.y * u.x};
}

/* --- faces of points -------------------------------------------------------------------------- */

static bool contains(const struct gd_mesh *mesh, uint32_t face, const struct gd_point *point)
{
    double weight[3];
    if (face == GD_NONE) return false;
    if (point->kind == GD_POINT_FACE) return point->element == face;
    gd__point_weights(mesh, point, face, weight);
    return weight[0] + weight[1] + weight[2] > 0;
}

/* Returns a face that contains both `a` and `b`, or GD_NONE. */
static uint32_t face_beside(const struct gd_mesh *mesh, const struct gd_point *a,
                            const struct gd_point *b)
{
    uint32_t begin = 2 * a->element, end = begin + 2;
    if (a->kind == GD_POINT_FACE) return contains(mesh, a->element, b) ? a->element : GD_NONE;
    if (a->kind == GD_POINT_VERTEX)
        begin = mesh->fan_first[a->element], end = mesh->fan_first[a->element + 1];
    for (uint32_t i = begin; i < end; i++) {
        uint32_t face = mesh->side_face[a->kind == GD_POINT_VERTEX ? mesh->fan[i].side : i];
        if (contains(mesh, face, b)) return face;
    }
    return GD_NONE;
}

static struct gd__local local_of(const struct gd_mesh *mesh, uint32_t side,
                                 const struct gd_point *point)
{
    uint32_t face = mesh->side_face[side];
    double w[3];
    gd__point_weights(mesh, point, face, w);
    int k = gd__place_of_side(mesh->face_side[face], side);
    return gd__face_local(mesh, side, (double[3]){w[k], w[(k + 1) % 3], w[(k + 2) % 3]});
}

/* Returns true if a point (a vertex, or a point of an edge) lies on an edge. */
static bool is_on(const struct gd_mesh *mesh, uint32_t edge, const struct gd_point *point)
{
    if (point->kind == GD_POINT_EDGE) return point->element == edge;
    return point->kind == GD_POINT_VERTEX && (mesh->origin[2 * edge] == point->element ||
                                              mesh->origin[2 * edge + 1] == point->element);
}

/* --- the strip -------------------------------------------------------------------------------- */

/* Crosses a side of the face. Returns false if the edge is not a side of the face, or if there is
 * no face on its other side. */
static bool lay_next(const struct gd_mesh *mesh, struct laid *laid, uint32_t edge)
{
    const struct gd_side *s = &mesh->side[laid->side];
    struct gd__local turn;
    if (s->left >> 1 == edge) {
        turn = (struct gd__local){s->left_x, s->left_y};
        laid->side = s->left;
    } else if (s->right >> 1 == edge) {
        struct gd__local apex = {s->left_length * s->left_x, s->left_length * s->left_y};
        laid->origin = unfold_place(laid, apex);
        turn = (struct gd__local){s->right_x, s->right_y};
        laid->side = s->right;
    } else {
        laid->origin = unfold_place(laid, (struct gd__local){s->length, 0});
        turn = (struct gd__local){-1, 0};
        laid->side ^= 1;
    }
    struct gd__local u = laid->along;
    laid->along = (struct gd__local){u.x * turn.x - u.y * turn.y, u.x * turn.y + u.y * turn.x};
    return laid->side >> 1 == edge && mesh->side_face[laid->side] != GD_NONE;
}

/* Measures the line between two points of one face. Computes it from differences of weights, in the
 * frame of the corner nearest to the first point. So the direction of a short line is precise. */
static void measure_in_face(const struct gd_mesh *mesh, uint32_t face, const struct gd_point *a,
                            const struct gd_point *b, struct gd__straight *out)
{
    double from[3], to[3];
    gd__point_weights(mesh, a, face, from);
    gd__point_weights(mesh, b, face, to);
    int k = from[1] > from[0] ? 1 : 0;
    if (from[2] > from[k]) k = 2;
    uint32_t side = mesh->face_side[face][k];
    int next = (k + 1) % 3, last = (k + 2) % 3;
    struct gd__local d =
        gd__side_local(&mesh->side[side], to[next] - from[next], to[last] - from[last]);
    out->length = hypot(d.x, d.y);
    /* for equal points any direction is valid, but it must be the same for both turns */
    if (out->length == 0) d.x = 1;
    out->ahead = gd__turn_in_face(mesh, a, side, d.x, d.y);
    out->back = gd__turn_in_face(mesh, b, side, -d.x, -d.y);
}

enum gd_status gd__unfold(const struct gd_mesh *mesh, const struct gd_point *points, uint32_t count,
                          struct gd__straight *out)
{
    const struct gd_point *a = &points[0], *b = &points[count - 1];
    /* points [begin, end) are on crossed edges that contain neither end of the line */
    uint32_t begin = 1, end = count - 1;
    while (begin < end && is_on(mesh, points[begin].element, a)) begin++;
    while (begin < end && is_on(mesh, points[end - 1].element, b)) end--;
    uint32_t face = face_beside(mesh, a, begin < end ? &points[begin] : b);
    if (face == GD_NONE) return GD_INTERNAL;
    if (begin == end) {
        measure_in_face(mesh, face, a, b, out);
        return GD_OK;
    }
    uint32_t first = mesh->face_side[face][0];
    struct laid laid = {first, {0, 0}, {1, 0}};
    for (uint32_t i = begin; i < end; i++)
        if (!lay_next(mesh, &laid, points[i].element)) return GD_INTERNAL;
    if (!contains(mesh, mesh->side_face[laid.side], b)) return GD_INTERNAL;
    struct gd__local from = local_of(mesh, first, a),
                     to = unfold_place(&laid, local_of(mesh, laid.side, b)), u = laid.along;
    double x = to.x - from.x, y = to.y - from.y, length = hypot(x, y);
    if (length == 0) x = 1;
    *out = (struct gd__straight){
        .length = length,
        .ahead = gd__turn_in_face(mesh, a, first, x, y),
        .back = gd__turn_in_face(mesh, b, laid.side, -(x * u.x + y * u.y), x * u.y - y * u.x)};
    return GD_OK;
}
