#include "gd/curve.h"

#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/share.h"
#include "base/tolerance.h"
#include "gd/direction.h"
#include "gd/query.h"
#include "mesh/canonical.h"
#include "mesh/topology.h"
#include "mesh/segment.h"

#define PORTION 4096 /* number of points between two checks of the control */

/* A curve under construction. */
struct drawing {
    const struct gd_mesh *mesh;
    const struct gd_curve_request *request;
    const struct gd_control *control;
    struct gd_detail *detail;
    struct gd_curve curve;
    uint32_t capacity;
};

void gd_curve_free(struct gd_curve *curve)
{
    if (!curve) return;
    free(curve->points);
    *curve = (struct gd_curve){0};
}

double gd_curve_length(const struct gd_mesh *mesh, const struct gd_curve *curve)
{
    double length = 0;
    struct gd_vec3 last =
        gd_point_position(mesh, &curve->points[curve->closed ? curve->count - 1 : 0]);
    for (uint32_t i = 0; i < curve->count; i++) {
        struct gd_vec3 here = gd_point_position(mesh, &curve->points[i]);
        length += gd_vec3_distance(last, here);
        last = here;
    }
    return length;
}

uint32_t gd_curve_seed_count(const struct gd_curve *curve)
{
    return curve->closed && curve->count > 2 ? 2 * curve->count : 2 * curve->count - 1;
}

/* Also zeroes the padding of the structs, so that the seeds of equal curves have equal bytes. */
void gd_curve_seeds(const struct gd_curve *curve, double offset, struct gd_seed *out)
{
    uint32_t count = gd_curve_seed_count(curve);
    memset(out, 0, count * sizeof *out);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t from = i / 2;
        out[i].point = curve->points[from];
        out[i].offset = offset;
        out[i].is_segment = i % 2;
        if (out[i].is_segment) out[i].end = curve->points[(from + 1) % curve->count];
    }
}

static size_t held(const struct drawing *drawing)
{
    return drawing->capacity * sizeof *drawing->curve.points;
}

static enum gd_status query_curve_add(struct drawing *drawing, const struct gd_point *point)
{
    struct gd_curve *curve = &drawing->curve;
    if (curve->count && gd_point_equal(&curve->points[curve->count - 1], point)) return GD_OK;
    enum gd_status status =
        gd__array_extend(&curve->points, &drawing->capacity, curve->count + 1ULL,
                         sizeof *curve->points, drawing->control);
    if (!status) curve->points[curve->count++] = *point;
    return status;
}

/* --- from points ------------------------------------------------------------------------------ */

/* Returns the i-th point. If it is too close to the border of its face, moves it onto the border
 * (GD_TOL_CORNER). */
static struct gd_point query_curve_corner(const struct drawing *drawing, uint32_t i)
{
    return gd__point_settled(drawing->mesh, &drawing->request->points[i], GD_TOL_CORNER);
}

/* Appends the shortest path from the i-th point to the j-th one. */
static enum gd_status query_curve_join(struct drawing *drawing, uint32_t i, uint32_t j,
                                       const struct gd_landmarks *landmarks,
                                       const struct gd_control *control)
{
    const struct gd_point from = query_curve_corner(drawing, i),
                          to = query_curve_corner(drawing, j);
    if (gd__common_face(drawing->mesh, &from, &to) != GD_NONE) return query_curve_add(drawing, &to);
    struct gd_pair_answer answer;
    enum gd_status status =
        gd_pair_solve(drawing->mesh,
                      &(struct gd_pair_request){
                          .from = &from, .to = &to, .output = GD_PAIR_PATH, .landmarks = landmarks},
                      control, &answer, drawing->detail);
    if (status) return status;
    if (!answer.path.count)
        status = gd_fail(drawing->detail, GD_INVALID_ARGUMENT,
                         "points %u and %u of the curve lie on different connected components; use "
                         "points of one component",
                         i, j);
    for (uint32_t k = 0; k < answer.path.count && !status; k++)
        status = query_curve_add(drawing, &answer.path.points[k]);
    gd_pair_answer_free(&answer);
    return status;
}

static enum gd_status draw_points(struct drawing *drawing, const struct gd_landmarks *landmarks)
{
    const struct gd_curve_request *request = drawing->request;
    uint32_t joints = request->closed ? request->count : request->count - 1;
    struct gd__share share = {.control = drawing->control, .total = joints};
    const struct gd_point first = query_curve_corner(drawing, 0);
    enum gd_status status = query_curve_add(drawing, &first);
    for (uint32_t i = 0; i < joints && !status; i++) {
        const struct gd_control own = gd__share_control(&share, held(drawing));
        status = query_curve_join(drawing, i, (i + 1) % request->count, landmarks, &own);
        share.done++;
    }
    return status;
}

/* --- from vertices and boundaries ------------------------------------------------------------- */

static enum gd_status draw_vertices(struct drawing *drawing)
{
    const struct gd_curve_request *request = drawing->request;
    uint32_t last = GD_NONE;
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < request->count + request->closed && !status; i++) {
        struct gd_vertex vertex = request->vertices[i % request->count];
        struct gd_point point;
        status = gd_point_at_vertex(drawing->mesh, vertex, &point, drawing->detail);
        if (status) return status;
        if (i && last != point.element &&
            gd__side_between(drawing->mesh, last, point.element) == GD_NONE)
            return gd_fail(drawing->detail, GD_NO_SUCH_EDGE,
                           "vertices %u and %u of the curve share no edge; consecutive vertices "
                           "must be the ends of an edge",
                           request->vertices[i - 1].index, vertex.index);
        status = query_curve_add(drawing, &point);
        last = point.element;
        if (!status && (i + 1) % PORTION == 0)
            status = gd_control_check(drawing->control, (double)i / request->count);
    }
    return status;
}

/* Builds the curve of a boundary. The fan of a boundary vertex begins at the boundary edge that
 * leaves the vertex with the surface on its left. */
static enum gd_status draw_boundary(struct drawing *drawing)
{
    const struct gd_mesh *mesh = drawing->mesh;
    uint32_t loop = drawing->request->boundary, count = mesh->summary.boundaries;
    if (loop >= count)
        return gd_fail(
            drawing->detail, GD_OUT_OF_RANGE,
            "boundary %u does not exist; the mesh has %u boundary loops, numbered from 0", loop,
            count);
    uint32_t first = mesh->origin[mesh->boundary_side[loop]], vertex = first;
    enum gd_status status = GD_OK;
    do {
        const struct gd_point point = gd__point_of_vertex(vertex);
        status = query_curve_add(drawing, &point);
        vertex = mesh->fan[mesh->fan_first[vertex]].tip;
    } while (vertex != first && !status);
    return status;
}

/* --- request ---------------------------------------------------------------------------------- */

/* Removes the last point of a closed curve if it repeats the first one. */
static void make_closed(struct gd_curve *curve)
{
    while (curve->count > 1 && gd_point_equal(&curve->points[0], &curve->points[curve->count - 1]))
        curve->count--;
    curve->closed = true;
}

static enum gd_status query_curve_draw(struct drawing *drawing)
{
    if (drawing->request->kind == GD_CURVE_BOUNDARY) return draw_boundary(drawing);
    if (!drawing->request->count)
        return gd_fail(drawing->detail, GD_INVALID_ARGUMENT,
                       "the curve has no points; give at least one point");
    return drawing->request->kind == GD_CURVE_POINTS
               ? draw_points(drawing, drawing->request->landmarks)
               : draw_vertices(drawing);
}

enum gd_status gd_curve_resolve(const struct gd_mesh *mesh, const struct gd_curve_request *request,
                                const struct gd_control *control, struct gd_curve *out,
                                struct gd_detail *detail)
{
    struct drawing drawing = {
        .mesh = mesh, .request = request, .control = control, .detail = detail};
    enum gd_status status = query_curve_draw(&drawing);
    if (status) {
        gd_curve_free(&drawing.curve);
        return status;
    }
    if (request->closed || request->kind == GD_CURVE_BOUNDARY) make_closed(&drawing.curve);
    *out = drawing.curve;
    return GD_OK;
}

/* --- parts ------------------------------------------------------------------------------------ */

static bool direction_to(const struct gd_mesh *mesh, const struct gd_point *from,
                         const struct gd_point *to, struct gd_direction *out)
{
    struct gd_vec3 a = gd_point_position(mesh, from), b = gd_point_position(mesh, to);
    return !gd_direction_along(mesh, from, (struct gd_vec3){b.x - a.x, b.y - a.y, b.z - a.z}, out,
                               NULL);
}

/* Segment `in` ends where segment `out` begins. Returns true if the curve turns there by more than
 * `turn`. */
static bool is_corner(const struct gd_mesh *mesh, const struct gd_seed *in,
                      const struct gd_seed *out, double turn)
{
    struct gd_direction back, onward;
    if (!direction_to(mesh, &out->point, &in->point, &back) ||
        !direction_to(mesh, &out->point, &out->end, &onward))
        return true;
    double between = fabs(back.angle - onward.angle);
    bool is_periodic = out->point.kind != GD_POINT_VERTEX ||
                       mesh->vertex_kind[out->point.element] != GD_VERTEX_BOUNDARY;
    if (is_periodic) between = fmin(between, 2 * M_PI - between);
    return fabs(M_PI - between) > turn;
}

/* A curve or a point begins at seed `first`. Returns the number of the first seed after this curve
 * or point. */
static uint32_t end_of_curve(const struct gd_seed *seeds, uint32_t count, uint32_t first)
{
    uint32_t i = first + 1;
    while (i < count && seeds[i].is_segment && gd_point_equal(&seeds[i].point, &seeds[i - 1].point))
        i += 1 + (i + 1 < count && !seeds[i + 1].is_segment &&
                  gd_point_equal(&seeds[i + 1].point, &seeds[i].end));
    return i;
}

uint32_t gd_curve_parts(const struct gd_mesh *mesh, const struct gd_seed *seeds, uint32_t count,
                        double turn, uint32_t *out)
{
    uint32_t parts = 0;
    for (uint32_t first = 0, end; first < count; first = end) {
        uint32_t begin = parts;
        end = end_of_curve(seeds, count, first);
        for (uint32_t i = first; i < end; i++) {
            bool is_inner = !seeds[i].is_segment && i > first && i + 1 < end;
            if (is_inner && is_corner(mesh, &seeds[i - 1], &seeds[i + 1], turn)) parts++;
            out[i] = parts;
        }
        bool is_closed =
            seeds[end - 1].is_segment && gd_point_equal(&seeds[end - 1].end, &seeds[first].point);
        if (is_closed && parts > begin &&
            !is_corner(mesh, &seeds[end - 1], &seeds[first + 1], turn)) {
            for (uint32_t i = end; i-- > first && out[i] == parts;) out[i] = begin;
            parts--;
        }
        parts++;
    }
    return parts;
}
