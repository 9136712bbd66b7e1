#include "gd/vector.h"

#include <stdlib.h>
#include <string.h>

#include "base/tolerance.h"
#include "field/layout.h"
#include "mesh/canonical.h"
#include "line/route.h"
#include "line/unfold.h"

/* --- log -------------------------------------------------------------------------------------- */

void gd_log_free(struct gd_log *log)
{
    if (!log) return;
    free(log->segments);
    *log = (struct gd_log){0};
}

static uint32_t count_parts(const struct gd_path *path)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i + 1 < path->count; i = gd__route_bend(path->points, path->count, i))
        count++;
    return count;
}

/* Returns true if `sum`, the length of the unfolded parts, equals the path's length up to the
 * rounding of lengths and of positions in faces. */
static bool agree(const struct gd_mesh *mesh, const struct gd_path *path, double sum)
{
    double slack =
        GD_TOL_CHECK * path->length + GD_TOL_PLACE * mesh->summary.edge_length.max * path->count;
    return fabs(sum - path->length) <= slack;
}

static enum gd_status fill_segments(const struct gd_mesh *mesh, const struct gd_path *path,
                                    struct gd_log *log)
{
    double sum = 0;
    for (uint32_t i = 0, end; i + 1 < path->count; i = end) {
        struct gd__straight part;
        end = gd__route_bend(path->points, path->count, i);
        enum gd_status status = gd__unfold(mesh, &path->points[i], end - i + 1, &part);
        if (status) return status;
        if (part.length == 0) continue;
        log->segments[log->count++] = (struct gd_vector){
            gd__turn_direction(mesh, &path->points[i], part.ahead), part.length * mesh->unit};
        sum += part.length * mesh->unit;
    }
    return agree(mesh, path, sum) ? GD_OK : GD_INTERNAL;
}

enum gd_status gd_vector_log(const struct gd_mesh *mesh, const struct gd_path *path,
                             struct gd_log *out, struct gd_detail *detail)
{
    struct gd_log log = {0};
    enum gd_status status = GD_OK;
    if (path->count > 1) {
        log.segments = malloc(count_parts(path) * sizeof *log.segments);
        status = log.segments ? fill_segments(mesh, path, &log) : GD_NO_MEMORY;
    }
    if (status) {
        gd_log_free(&log);
        return gd_fail_status(detail, status);
    }
    log.vector.direction =
        log.count ? log.segments[0].direction : gd__turn_direction(mesh, path->points, 0);
    /* the path's length is more precise than the sum of the unfolded parts */
    if (log.count) log.vector.length = path->length;
    *out = log;
    return GD_OK;
}

/* --- exp -------------------------------------------------------------------------------------- */

/* Returns the point where the next segment begins: a vertex near the end of this segment, or the
 * end itself if no vertex is near. */
static struct gd_point vector_settle(const struct gd_mesh *mesh, const struct gd_point *end,
                                     double length)
{
    uint32_t side = 2 * end->element;
    if (end->kind == GD_POINT_VERTEX) return *end;
    if (end->kind == GD_POINT_FACE) side = mesh->face_side[end->element][0];
    if (gd__side_is_boundary(mesh, side)) side ^= 1;
    uint32_t face = mesh->side_face[side], nearest = 0;
    double weight[3];
    gd__point_weights(mesh, end, face, weight);
    for (uint32_t k = 1; k < 3; k++)
        if (weight[k] > weight[nearest]) nearest = k;
    uint32_t corner = mesh->face_side[face][nearest];
    struct gd__local at = gd__face_local(
        mesh, corner, (double[3]){0, weight[(nearest + 1) % 3], weight[(nearest + 2) % 3]});
    double rounding = GD_TOL_PLACE * mesh->side[corner].length;
    return hypot(at.x, at.y) <= GD_TOL_JOINT * length + rounding
               ? gd__point_of_vertex(mesh->origin[corner])
               : *end;
}

/* Appends a leg to the trace and empties the leg. */
static enum gd_status vector_join(struct gd_trace *trace, struct gd_trace *leg)
{
    struct gd_path *path = &trace->path;
    uint32_t more = leg->path.count - 1;
    struct gd_point *points = realloc(path->points, ((size_t)path->count + more) * sizeof *points);
    if (points) {
        memcpy(points + path->count, leg->path.points + 1, more * sizeof *points);
        *path = (struct gd_path){path->length + leg->path.length, path->count + more, points};
        trace->direction = leg->direction;
        trace->end = leg->end;
    }
    gd_trace_free(leg);
    return points ? GD_OK : GD_NO_MEMORY;
}

static enum gd_status trace_segment(const struct gd_mesh *mesh, const struct gd_point *start,
                                    const struct gd_vector *segment,
                                    const struct gd_trace_options *options,
                                    const struct gd_control *control, struct gd_trace *out,
                                    struct gd_detail *detail)
{
    enum gd_status status = gd_trace_follow(mesh,
                                            &(struct gd_trace_request){.start = start,
                                                                       .ahead = &segment->direction,
                                                                       .length = segment->length,
                                                                       .options = options},
                                            control, out, detail);
    if (status) return status;
    bool is_over = segment->length - out->path.length <= GD_TOL_JOINT * segment->length;
    if (out->end == GD_TRACE_END_BOUNDARY && is_over) out->end = GD_TRACE_END_LENGTH;
    return GD_OK;
}

static enum gd_status go_on(const struct gd_mesh *mesh, const struct gd_vector *segment,
                            const struct gd_trace_options *options,
                            const struct gd_control *control, struct gd_trace *trace,
                            struct gd_detail *detail)
{
    struct gd_trace leg;
    struct gd_point *end = &trace->path.points[trace->path.count - 1];
    *end = vector_settle(mesh, end, trace->path.length / mesh->unit);
    enum gd_status status = trace_segment(mesh, end, segment, options, control, &leg, detail);
    return status ? status : vector_join(trace, &leg);
}

enum gd_status gd_vector_exp(const struct gd_mesh *mesh, const struct gd_exp_request *request,
                             const struct gd_control *control, struct gd_trace *out,
                             struct gd_detail *detail)
{
    const struct gd_point *start = request->start;
    const struct gd_vector *segments = request->segments;
    const struct gd_trace_options *options = request->options;
    struct gd_trace trace;
    const struct gd_vector none = {.direction = gd__turn_direction(mesh, start, 0)};
    enum gd_status status = trace_segment(mesh, start, request->count ? segments : &none, options,
                                          control, &trace, detail);
    if (status) return status;
    for (uint32_t i = 1; i < request->count && trace.end == GD_TRACE_END_LENGTH && !status; i++)
        status = go_on(mesh, &segments[i], options, control, &trace, detail);
    if (status)
        gd_trace_free(&trace);
    else
        *out = trace;
    return status;
}

/* --- transport -------------------------------------------------------------------------------- */

/* Returns a vector with the given angle at a point. At a boundary vertex, angles that differ by 2
 * pi are different directions. So a multiple of 2 pi is added to the angle, such that the result is
 * nearest to the angles on the surface. */
static struct gd_vector vector_at(const struct gd_mesh *mesh, const struct gd_point *point,
                                  double angle, double length)
{
    if (point->kind == GD_POINT_VERTEX && !gd__turn_is_closed(mesh, point))
        angle = gd__turn_nearest(angle, gd__turn_total(mesh, point));
    return (struct gd_vector){
        gd__turn_direction(mesh, point, gd__turn_of_angle(mesh, point, angle)), length};
}

/* Computes the angle by which transport along a path of at least two points rotates vectors. */
static enum gd_status find_rotation(const struct gd_mesh *mesh, const struct gd_path *path,
                                    double *out)
{
    double ahead, back;
    enum gd_status status = gd__route_ahead(mesh, path->points, path->count, &ahead);
    if (!status) status = gd__route_back(mesh, path->points, path->count, &back);
    if (status) return status;
    *out = gd__turn_to_angle(mesh, &path->points[path->count - 1], back) + M_PI -
           gd__turn_to_angle(mesh, &path->points[0], ahead);
    return GD_OK;
}

enum gd_status gd_vector_transport(const struct gd_mesh *mesh, const struct gd_path *path,
                                   struct gd_vector *vectors, uint32_t count,
                                   struct gd_detail *detail)
{
    double rotation = 0;
    enum gd_status status = path->count > 1 ? find_rotation(mesh, path, &rotation) : GD_OK;
    if (status) return gd_fail_status(detail, status);
    const struct gd_point *to = &path->points[path->count - 1];
    for (uint32_t i = 0; i < count; i++)
        vectors[i] = vector_at(mesh, to, vectors[i].direction.angle + rotation, vectors[i].length);
    return GD_OK;
}

/* --- sums ------------------------------------------------------------------------------------- */

struct gd_vector gd_vector_combine(const struct gd_mesh *mesh, const struct gd_point *point,
                                   const struct gd_vector *vectors, const double *factors,
                                   uint32_t count)
{
    double x = 0, y = 0;
    for (uint32_t i = 0; i < count; i++) {
        x += factors[i] * vectors[i].length * cos(vectors[i].direction.angle);
        y += factors[i] * vectors[i].length * sin(vectors[i].direction.angle);
    }
    return vector_at(mesh, point, atan2(y, x), hypot(x, y));
}
