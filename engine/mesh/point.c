#include "gd/point.h"

#include <string.h>

#include "base/tolerance.h"
#include "mesh/canonical.h"
#include "mesh/local.h"

struct gd_point gd__point_of_vertex(uint32_t vertex)
{
    return (struct gd_point){.kind = GD_POINT_VERTEX, .element = vertex};
}

/* Returns a point of an edge. `rest` is 1 - t. If the caller ignores a small weight of the face's
 * third corner, `rest` is 1 - t minus that weight. The smaller of t and rest is more precise, so it
 * determines the point. */
static struct gd_point of_edge(const struct gd_mesh *mesh, uint32_t edge, double t, double rest,
                               double border)
{
    if (t <= border) return gd__point_of_vertex(mesh->origin[2 * edge]);
    if (rest <= border) return gd__point_of_vertex(mesh->origin[2 * edge + 1]);
    struct gd_point point = {.kind = GD_POINT_EDGE, .element = edge};
    point.weight[0] = t < rest ? t : 1 - rest;
    point.weight[1] = t < rest ? 1 - t : rest;
    return point;
}

static struct gd_point of_face(const struct gd_mesh *mesh, uint32_t face, const double weight[3],
                               double border)
{
    const uint32_t *side = mesh->face_side[face];
    for (int k = 0; k < 3; k++) {
        if (weight[k] >= 1 - 2 * border) return gd__point_of_vertex(mesh->origin[side[k]]);
    }
    for (int k = 0; k < 3; k++) {
        if (weight[k] > border) continue;
        /* The point is on the side opposite to corner k. Its parameter is the weight of the end of
           the edge's side 0. */
        uint32_t h = side[(k + 1) % 3], end = h % 2 ? 1 : 2;
        return of_edge(mesh, h / 2, weight[(k + end) % 3], weight[(k + 3 - end) % 3], border);
    }
    return (struct gd_point){
        .kind = GD_POINT_FACE, .element = face, .weight = {weight[0], weight[1], weight[2]}};
}

struct gd_point gd__point_of_edge(const struct gd_mesh *mesh, uint32_t edge, double t)
{
    return of_edge(mesh, edge, t, 1 - t, GD_TOL_ON_BORDER);
}

struct gd_point gd__point_on_side(const struct gd_mesh *mesh, uint32_t side, double t, double rest)
{
    bool turned = side & 1;
    return of_edge(mesh, side >> 1, turned ? rest : t, turned ? t : rest, GD_TOL_ON_BORDER);
}

struct gd_point gd__point_of_face(const struct gd_mesh *mesh, uint32_t face, const double weight[3])
{
    return of_face(mesh, face, weight, GD_TOL_ON_BORDER);
}

struct gd_point gd__point_settled(const struct gd_mesh *mesh, const struct gd_point *point,
                                  double border)
{
    if (point->kind == GD_POINT_EDGE)
        return of_edge(mesh, point->element, point->weight[0], gd__edge_rest(point), border);
    if (point->kind == GD_POINT_FACE) return of_face(mesh, point->element, point->weight, border);
    return *point;
}

static enum gd_status find_vertex(const struct gd_mesh *mesh, struct gd_vertex vertex,
                                  uint32_t *out, struct gd_detail *detail)
{
    if (vertex.index >= mesh->summary.index_count)
        return gd_fail(detail, GD_OUT_OF_RANGE,
                       "there is no vertex %u: the mesh has %u, numbered from 0", vertex.index,
                       mesh->summary.index_count);
    if (mesh->vertex_of_index[vertex.index] == GD_NONE)
        return gd_fail(detail, GD_UNREFERENCED_VERTEX,
                       "vertex %u belongs to no face, so it is not on the surface", vertex.index);
    *out = mesh->vertex_of_index[vertex.index];
    return GD_OK;
}

enum gd_status gd_point_at_vertex(const struct gd_mesh *mesh, struct gd_vertex vertex,
                                  struct gd_point *out, struct gd_detail *detail)
{
    uint32_t v = GD_NONE;
    enum gd_status status = find_vertex(mesh, vertex, &v, detail);
    if (!status) *out = gd__point_of_vertex(v);
    return status;
}

enum gd_status gd_point_on_edge(const struct gd_mesh *mesh, const struct gd_vertex ends[2],
                                double t, struct gd_point *out, struct gd_detail *detail)
{
    struct gd_vertex a = ends[0], b = ends[1];
    uint32_t from = GD_NONE, to = GD_NONE;
    enum gd_status status = find_vertex(mesh, a, &from, detail);
    if (!status) status = find_vertex(mesh, b, &to, detail);
    if (status) return status;
    if (!isfinite(t)) return gd_fail(detail, GD_INVALID_ARGUMENT, "t is not a finite number");
    if (t < -GD_TOL_INPUT || t > 1 + GD_TOL_INPUT)
        return gd_fail(detail, GD_NOT_ON_SURFACE,
                       "t is %.17g; it runs from 0 at vertex %u to 1 at vertex %u", t, a.index,
                       b.index);
    uint32_t side = gd__side_between(mesh, from, to);
    if (side == GD_NONE)
        return gd_fail(detail, GD_NO_SUCH_EDGE, "vertices %u and %u share no edge", a.index,
                       b.index);
    *out = gd__point_on_side(mesh, side, t, 1 - t);
    return GD_OK;
}

static enum gd_status find_face(const struct gd_mesh *mesh, struct gd_face face, uint32_t *out,
                                struct gd_detail *detail)
{
    if (face.index >= mesh->summary.face_index_count)
        return gd_fail(detail, GD_OUT_OF_RANGE,
                       "there is no face %u: the mesh has %u, numbered from 0", face.index,
                       mesh->summary.face_index_count);
    if (!gd_mesh_has_face(mesh, face))
        return gd_fail(detail, GD_OUT_OF_RANGE,
                       "face %u was removed when the mesh was repaired or welded: it had no area, "
                       "or was a duplicate",
                       face.index);
    *out = mesh->face_of_index[face.index];
    return GD_OK;
}

static enum gd_status check_barycentric(const double b[3], struct gd_detail *detail)
{
    if (!isfinite(b[0]) || !isfinite(b[1]) || !isfinite(b[2]))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "a barycentric coordinate is not a finite number");
    for (int k = 0; k < 3; k++) {
        if (b[k] < -GD_TOL_INPUT)
            return gd_fail(
                detail, GD_NOT_ON_SURFACE,
                "barycentric coordinate %.17g is negative: the point is outside the face", b[k]);
    }
    double sum = b[0] + b[1] + b[2];
    if (fabs(sum - 1) > GD_TOL_INPUT)
        return gd_fail(detail, GD_NOT_ON_SURFACE,
                       "the barycentric coordinates sum to %.17g instead of 1", sum);
    return GD_OK;
}

/* Converts weights from the input's corner order to the internal one. Negative weights from
 * rounding become 0, and the sum becomes 1 unless it is 1 already. */
static void normalise(const struct gd_mesh *mesh, uint32_t face, const double b[3],
                      double weight[3])
{
    bool flipped = mesh->face_flipped[face];
    weight[0] = fmax(b[0], 0);
    weight[1] = fmax(b[flipped ? 2 : 1], 0);
    weight[2] = fmax(b[flipped ? 1 : 2], 0);
    double sum = weight[0] + weight[1] + weight[2];
    if (fabs(sum - 1) <= GD_TOL_ON_BORDER) return;
    for (int k = 0; k < 3; k++) weight[k] /= sum;
}

enum gd_status gd_point_in_face(const struct gd_mesh *mesh, struct gd_face face,
                                const double barycentric[3], struct gd_point *out,
                                struct gd_detail *detail)
{
    uint32_t f = GD_NONE;
    enum gd_status status = find_face(mesh, face, &f, detail);
    if (!status) status = check_barycentric(barycentric, detail);
    if (status) return status;
    double weight[3];
    normalise(mesh, f, barycentric, weight);
    *out = gd__point_of_face(mesh, f, weight);
    return GD_OK;
}

static struct gd_vec3 position_in_face(const struct gd_mesh *mesh, uint32_t face,
                                       const double weight[3])
{
    const uint32_t *side = mesh->face_side[face];
    struct gd_vec3 a = gd__vertex_position(mesh, mesh->origin[side[0]]);
    struct gd_vec3 ab = gd_vec3_sub(gd__vertex_position(mesh, mesh->origin[side[0] ^ 1]), a);
    struct gd_vec3 ac = gd_vec3_sub(gd__vertex_position(mesh, mesh->origin[side[2]]), a);
    return gd_vec3_add(a, gd_vec3_along(gd_vec3_scale(ab, weight[1]), weight[2], ac));
}

static inline struct gd_vec3 point_position_of(const struct gd_mesh *mesh,
                                               const struct gd_point *point)
{
    if (point->kind == GD_POINT_EDGE) {
        /* a multiple of the edge vector is added to one end, so that the position has exactly the
           x, y or z that both ends share */
        const uint32_t *ends = &mesh->origin[2 * point->element];
        struct gd_vec3 a = gd__vertex_position(mesh, ends[0]);
        return gd_vec3_along(a, point->weight[0],
                             gd_vec3_sub(gd__vertex_position(mesh, ends[1]), a));
    }
    return point->kind == GD_POINT_VERTEX ? gd__vertex_position(mesh, point->element)
                                          : position_in_face(mesh, point->element, point->weight);
}

struct gd_vec3 gd_point_position(const struct gd_mesh *mesh, const struct gd_point *point)
{
    return point_position_of(mesh, point);
}

void gd_points_positions(const struct gd_mesh *mesh, const struct gd_point *points, uint32_t count,
                         double (*out)[3])
{
    for (uint32_t i = 0; i < count; i++) {
        struct gd_vec3 position = point_position_of(mesh, &points[i]);
        out[i][0] = position.x;
        out[i][1] = position.y;
        out[i][2] = position.z;
    }
}

/* Returns the lowest-numbered input face around a vertex or on either side of an edge. */
static uint32_t lowest_face(const struct gd_mesh *mesh, const struct gd_point *point)
{
    if (point->kind == GD_POINT_FACE) return point->element;
    uint32_t best = GD_NONE, begin = 2 * point->element, end = begin + 2;
    if (point->kind == GD_POINT_VERTEX) {
        begin = mesh->fan_first[point->element];
        end = mesh->fan_first[point->element + 1];
    }
    for (uint32_t i = begin; i < end; i++) {
        uint32_t face = mesh->side_face[point->kind == GD_POINT_VERTEX ? mesh->fan[i].side : i];
        if (face == GD_NONE) continue;
        if (best == GD_NONE || mesh->index_of_face[face] < mesh->index_of_face[best]) best = face;
    }
    return best;
}

static void describe_edge(const struct gd_mesh *mesh, const struct gd_point *point,
                          struct gd_point_description *out)
{
    uint32_t a = mesh->index_of_vertex[mesh->origin[2 * point->element]];
    uint32_t b = mesh->index_of_vertex[mesh->origin[2 * point->element + 1]];
    out->edge[0].index = a < b ? a : b;
    out->edge[1].index = a < b ? b : a;
    out->t = a < b ? point->weight[0] : gd__edge_rest(point);
}

void gd_point_describe(const struct gd_mesh *mesh, const struct gd_point *point,
                       struct gd_point_description *out)
{
    uint32_t face = lowest_face(mesh, point);
    double weight[3];
    gd__point_weights(mesh, point, face, weight);
    bool flipped = mesh->face_flipped[face];
    *out = (struct gd_point_description){
        .xyz = gd_point_position(mesh, point),
        .face = {mesh->index_of_face[face]},
        .barycentric = {weight[0], weight[flipped ? 2 : 1], weight[flipped ? 1 : 2]},
        .kind = point->kind,
    };
    if (point->kind == GD_POINT_VERTEX) out->vertex.index = mesh->index_of_vertex[point->element];
    if (point->kind == GD_POINT_EDGE) describe_edge(mesh, point, out);
}

uint32_t gd_point_component(const struct gd_mesh *mesh, const struct gd_point *point)
{
    switch (point->kind) {
    case GD_POINT_VERTEX:
        return mesh->vertex_component[point->element];
    case GD_POINT_EDGE:
        return mesh->vertex_component[mesh->origin[2 * point->element]];
    case GD_POINT_FACE:
        break;
    }
    return mesh->vertex_component[mesh->origin[mesh->face_side[point->element][0]]];
}
