#include "gd/trace.h"

#include <stdlib.h>

#include "base/tolerance.h"
#include "field/layout.h"
#include "mesh/canonical.h"
#include "transport/flight.h"
#include "transport/line.h"
#include "transport/meetings.h"
#include "transport/straight.h"

/* A trace is flights from face to face, and halts between them: at vertices, at the boundary, at
 * its end. A flight knows the face that it comes to by its side alone; where the line came from at
 * a halt is kept as a turn. */

enum halt {
    HALT_NONE,   /* over an edge, into the face of the flight's side */
    HALT_VERTEX, /* at the last point, from the turn `back` */
    HALT_BORDER, /* on the flight's side, which has no face */
    HALT_END,    /* by length; here and below it is over */
    HALT_STOP,   /* by the boundary */
    HALT_MEETING,
    HALT_LIMIT /* of steps; or the line's status is a failure */
};

struct tracer {
    const struct gd_mesh *mesh;
    const struct gd_trace_options *options;
    struct gd__line line;
    struct gd__flight flight;
    enum halt halt;
    /* turn at the last point to where the line came from: at halts but NONE and BORDER */
    double back;
    struct gd__meetings *meetings; /* NULL: not asked for */
    struct gd_direction ahead;     /* at the start */
};

/* --- one face --------------------------------------------------------------------------------- */

/* How far from where it should be a point may be for rounding. */
static inline double drift(const struct tracer *tracer)
{
    return GD_TOL_DRIFT * tracer->line.gone;
}

/* Looks whether the last segment, which is in `face`, meets the line: then the line ends there. */
static enum halt meet(struct tracer *tracer, uint32_t face, double run, enum halt halt)
{
    const struct gd_mesh *mesh = tracer->mesh;
    struct gd__line *line = &tracer->line;
    struct gd_point *from = gd__line_last(line) - 1, *to = from + 1;
    double part = 2, a[3], b[3], at[3];
    line->status = gd__meetings_add(tracer->meetings, face, from, to, &part);
    if (line->status || part > 1) return line->status ? HALT_LIMIT : halt;
    gd__point_weights(mesh, from, face, a);
    gd__point_weights(mesh, to, face, b);
    for (int k = 0; k < 3; k++) at[k] = fmax(a[k] + part * (b[k] - a[k]), 0);
    uint32_t side = mesh->face_side[face][0];
    struct gd__local way =
        gd__face_local(mesh, side, (double[3]){a[0] - b[0], a[1] - b[1], a[2] - b[2]});
    if (part < 1) *to = gd__point_of_face(mesh, face, at);
    gd__line_go(line, (part - 1) * run);
    tracer->back = gd__turn_in_face(mesh, to, side, way.x, way.y);
    return HALT_MEETING;
}

/* Appends a point of a face; the line came to it by a straight segment in that face. */
static inline enum halt append(struct tracer *tracer, struct gd_point point, uint32_t face,
                               double run, enum halt halt)
{
    if (!gd__line_append(&tracer->line, &point, run)) return HALT_LIMIT;
    return tracer->meetings ? meet(tracer, face, run, halt) : halt;
}

/* The point of a side's face at a place in its frame; of an edge or a vertex, when it is no farther
 * from it than `snap`. */
static struct gd_point point_at(const struct gd_mesh *mesh, uint32_t side, struct gd__local at,
                                double snap)
{
    const struct gd_side *s = &mesh->side[side];
    uint32_t face = mesh->side_face[side];
    double px = s->left_length * s->left_x, py = s->left_length * s->left_y, area = s->length * py;
    double apex = at.y / py, destination = (at.x - apex * px) / s->length;
    double weight[3] = {1 - apex - destination, destination, apex},
           opposite[3] = {s->right_length, s->left_length, s->length}, own[3], sum = 0;
    int first = gd__place_of_side(mesh->face_side[face], side);
    for (int k = 0; k < 3; k++) {
        if (weight[k] * area <= snap * opposite[k]) weight[k] = 0;
        sum += weight[k];
    }
    for (int k = 0; k < 3; k++) own[(first + k) % 3] = weight[k] / sum;
    return gd__point_of_face(mesh, face, own);
}

/* The line ends in the ray's face. */
static enum halt end_in_face(struct tracer *tracer, const struct gd__ray *ray, double snap)
{
    const struct gd_mesh *mesh = tracer->mesh;
    double run = fmax(gd__line_rest(&tracer->line), 0);
    struct gd_point end = point_at(
        mesh, ray->side, (struct gd__local){ray->x + run * ray->dx, ray->y + run * ray->dy}, snap);
    tracer->back = gd__turn_in_face(mesh, &end, ray->side, -ray->dx, -ray->dy);
    if (gd_point_equal(&end, gd__line_last(&tracer->line))) {
        gd__line_go(&tracer->line, run);
        return HALT_END;
    }
    return append(tracer, end, mesh->side_face[ray->side], run, HALT_END);
}

/* A corner of the face in the frame of its side. */
static struct gd__local corner_of(const struct gd_mesh *mesh, uint32_t side, uint32_t vertex)
{
    const struct gd_side *s = &mesh->side[side];
    if (vertex == mesh->origin[side]) return (struct gd__local){0, 0};
    if (vertex == mesh->origin[side ^ 1]) return (struct gd__local){s->length, 0};
    return (struct gd__local){s->left_length * s->left_x, s->left_length * s->left_y};
}

/* The line ends on the edge or the vertex that its end is no farther from. */
static double snap_of_end(const struct tracer *tracer, double edge)
{
    return GD_TOL_HIT * fmin(edge, tracer->line.length) + drift(tracer);
}

/* The line leaves the ray's face through an end of the edge to which the flight has come. */
static enum halt pass_vertex(struct tracer *tracer, const struct gd__ray *ray, double edge,
                             double snap)
{
    const struct gd_mesh *mesh = tracer->mesh;
    const struct gd__flight *flight = &tracer->flight;
    struct gd_point vertex =
        gd__point_of_vertex(mesh->origin[flight->side ^ !(flight->t < 0.5 * edge)]);
    struct gd__local corner = corner_of(mesh, ray->side, vertex.element);
    double run = hypot(corner.x - ray->x, corner.y - ray->y);
    if (gd__line_rest(&tracer->line) < run - snap)
        return end_in_face(tracer, ray, snap_of_end(tracer, edge));
    tracer->back = gd__turn_in_face(mesh, &vertex, flight->side ^ 1, flight->dx, flight->dy);
    bool is_end = gd__line_rest(&tracer->line) <= run + snap;
    return append(tracer, vertex, mesh->side_face[ray->side],
                  is_end ? gd__line_rest(&tracer->line) : run, is_end ? HALT_END : HALT_VERTEX);
}

/* The flight has left the face that the ray lies in. */
static inline enum halt pass(struct tracer *tracer, const struct gd__ray *ray,
                             const struct gd__passage *passage)
{
    const struct gd__flight *flight = &tracer->flight;
    /* near its start a line tells the sides of a vertex well */
    double gone = tracer->line.gone + passage->run;
    double snap =
        GD_TOL_HIT * fmin(passage->edge, gone) + GD_TOL_PLACE * passage->edge + drift(tracer);
    if (!(flight->t > snap && flight->t < passage->edge - snap))
        return pass_vertex(tracer, ray, passage->edge, snap);
    double end_snap = snap_of_end(tracer, passage->edge);
    if (gd__line_rest(&tracer->line) <= passage->run + end_snap)
        return end_in_face(tracer, ray, end_snap);
    struct gd_point point = gd__point_within_side(flight->side, flight->t / passage->edge);
    return append(tracer, point,
                  tracer->meetings ? tracer->mesh->side_face[flight->side ^ 1] : GD_NONE,
                  passage->run, HALT_NONE);
}

/* --- flights ---------------------------------------------------------------------------------- */

/* Over one face. It reads one record of the mesh, and asks for both of those that may be next as
 * soon as that is there. */
static inline enum halt hop(struct tracer *tracer)
{
    const struct gd_mesh *mesh = tracer->mesh;
    const struct gd__flight *flight = &tracer->flight;
    const struct gd_side *s = &mesh->side[flight->side];
    if (s->left == GD_NONE) return HALT_BORDER;
    __builtin_prefetch(&mesh->side[s->left]);
    __builtin_prefetch(&mesh->side[s->right]);
    struct gd__ray ray = {flight->side, flight->t, 0, flight->dx, flight->dy};
    struct gd__passage passage = gd__flight_cross(s, &tracer->flight);
    enum halt halt = pass(tracer, &ray, &passage);
    if (halt == HALT_LIMIT) /* the last point is where the ray begins */
        tracer->back =
            gd__turn_in_face(mesh, gd__line_last(&tracer->line), ray.side, -ray.dx, -ray.dy);
    return halt;
}

/* Leaves a face from inside, by the first of its sides. */
static struct gd__passage leave_from_inside(const struct gd_mesh *mesh, const struct gd__ray *ray,
                                            struct gd__flight *flight)
{
    struct gd__passage passage = {0, INFINITY};
    double x = ray->x, y = ray->y, dx = ray->dx, dy = ray->dy;
    uint32_t side = ray->side;
    for (int k = 0; k < 3; k++) {
        const struct gd_side *s = &mesh->side[side];
        double run = dy < 0 ? fmax(y, 0) / -dy : INFINITY;
        if (run < passage.run) {
            passage = (struct gd__passage){s->length, run};
            *flight = (struct gd__flight){side ^ 1, s->length - (x + run * dx), -dx, -dy};
        }
        /* into the frame of the next side, whose direction is that of destination -> apex */
        double ux = -s->right_x, uy = -s->right_y, rx = x - s->length, ry = y, ex = dx, ey = dy;
        x = rx * ux + ry * uy, y = ry * ux - rx * uy;
        dx = ex * ux + ey * uy, dy = ey * ux - ex * uy;
        side = gd__side_next(mesh, side);
    }
    return passage;
}

/* From the last point in the direction of a turn, over the first face. */
static enum halt depart(struct tracer *tracer, double turn)
{
    const struct gd_mesh *mesh = tracer->mesh;
    const struct gd_point *point = gd__line_last(&tracer->line);
    struct gd__ray ray = gd__turn_ray(mesh, point, turn);
    struct gd__passage passage;
    if (point->kind == GD_POINT_FACE) {
        passage = leave_from_inside(mesh, &ray, &tracer->flight);
    } else {
        tracer->flight = (struct gd__flight){ray.side, ray.x, ray.dx, fmax(ray.dy, 0)};
        passage = gd__flight_cross(&mesh->side[ray.side], &tracer->flight);
    }
    return pass(tracer, &ray, &passage);
}

/* --- the boundary ----------------------------------------------------------------------------- */

/* Along a boundary side from `at`, forward or backward, to its end. */
static enum halt slide(struct tracer *tracer, uint32_t side, double at, bool forward)
{
    const struct gd_mesh *mesh = tracer->mesh;
    double edge = mesh->side[side].length, run = forward ? edge - at : at,
           rest = gd__line_rest(&tracer->line);
    uint32_t face = mesh->side_face[side ^ 1];
    double snap = snap_of_end(tracer, edge);
    if (rest < run - snap) {
        double part = (forward ? at + rest : at - rest) / edge;
        struct gd_point end = gd__point_of_edge(mesh, side >> 1, side & 1 ? 1 - part : part);
        tracer->back = gd__turn_in_face(mesh, &end, side ^ 1, forward ? 1 : -1, 0);
        return append(tracer, end, face, rest, HALT_END);
    }
    struct gd_point vertex = gd__point_of_vertex(mesh->origin[forward ? side ^ 1 : side]);
    tracer->back = forward ? 0 : mesh->total_angle[vertex.element];
    bool is_end = rest <= run + snap;
    return append(tracer, vertex, face, is_end ? rest : run, is_end ? HALT_END : HALT_VERTEX);
}

/* Does the line reach the boundary at so small an angle that its end, or the vertex ahead, lies on
 * the edge within rounding? Then it goes on along the edge: the angle does not tell where the line
 * crosses it. */
static bool grazes(const struct tracer *tracer)
{
    const struct gd__flight *flight = &tracer->flight;
    double edge = tracer->mesh->side[flight->side].length,
           ahead = flight->dx > 0 ? edge - flight->t : flight->t;
    return fmin(ahead, gd__line_rest(&tracer->line)) * flight->dy <=
           GD_TOL_HIT * edge + drift(tracer);
}

static enum halt at_border(struct tracer *tracer)
{
    const struct gd__flight *flight = &tracer->flight;
    tracer->back = gd__turn_in_face(tracer->mesh, gd__line_last(&tracer->line), flight->side ^ 1,
                                    flight->dx, flight->dy);
    bool leans = fabs(flight->dx) > GD_TOL_HIT;
    bool stops = tracer->options->boundary_rule == GD_BOUNDARY_RULE_STOP;
    if (!leans || (stops && !grazes(tracer))) return HALT_STOP;
    return slide(tracer, flight->side, flight->t, flight->dx > 0);
}

static enum halt at_vertex(struct tracer *tracer)
{
    uint32_t vertex = gd__line_last(&tracer->line)->element, side;
    double turn;
    bool forward;
    if (gd__straight_on(tracer->mesh, vertex, tracer->back, tracer->options, &turn))
        return depart(tracer, turn);
    if (tracer->options->boundary_rule == GD_BOUNDARY_RULE_STOP) return HALT_STOP;
    if (!gd__straight_slide(tracer->mesh, vertex, tracer->back, &side, &forward)) return HALT_STOP;
    return slide(tracer, side, forward ? 0 : tracer->mesh->side[side].length, forward);
}

/* --- the whole -------------------------------------------------------------------------------- */

static inline bool is_over(const struct tracer *tracer)
{
    return tracer->halt >= HALT_END;
}

static inline enum halt go_on(struct tracer *tracer)
{
    if (tracer->halt == HALT_NONE) return hop(tracer);
    return tracer->halt == HALT_VERTEX ? at_vertex(tracer) : at_border(tracer);
}

/* Each a face at a time in turn: while one waits for its record of the mesh the others go on. */
static void run(struct tracer *tracers, uint32_t count)
{
    uint32_t going;
    do {
        going = 0;
        for (uint32_t i = 0; i < count; i++) {
            if (is_over(&tracers[i])) continue;
            tracers[i].halt = go_on(&tracers[i]);
            going++;
        }
    } while (going);
}

static enum gd_trace_end end_of(enum halt halt)
{
    switch (halt) {
    case HALT_STOP:
        return GD_TRACE_END_BOUNDARY;
    case HALT_MEETING:
        return GD_TRACE_END_SELF_INTERSECTION;
    case HALT_LIMIT:
        return GD_TRACE_END_STEP_LIMIT;
    default:
        return GD_TRACE_END_LENGTH;
    }
}

static void finish(struct tracer *tracer, struct gd_trace *out)
{
    const struct gd__line *line = &tracer->line;
    const struct gd_mesh *mesh = tracer->mesh;
    const struct gd_point *last = gd__line_last(line);
    struct gd_direction back = gd__turn_direction(mesh, last, tracer->back);
    *out = (struct gd_trace){
        .path = {(line->gone + line->carry) * mesh->unit, line->count, line->points},
        .direction = gd_direction_opposite(mesh, last, &back),
        .end = end_of(tracer->halt)};
}

static enum gd_status check(const struct gd_mesh *mesh, const struct gd_point *start,
                            const struct gd_direction *ahead, double length,
                            struct gd_direction *out, struct gd_detail *detail)
{
    if (!(isfinite(length) && length >= 0))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the length is %.17g; it must be a finite number, 0 or more", length);
    return gd_direction_at_angle(mesh, start, ahead->angle, out, detail);
}

/* At its start, on its way over the first face. */
static enum gd_status open(struct tracer *tracer, const struct gd_trace_request *request,
                           const struct gd_direction *ahead, struct gd_detail *detail)
{
    const struct gd_point *start = request->start;
    double length = request->length;
    enum gd_status status = check(tracer->mesh, start, ahead, length, &tracer->ahead, detail);
    if (status) return status;
    uint64_t limit = tracer->options->step_limit ? tracer->options->step_limit : GD_TRACE_STEPS;
    tracer->line.limit = limit < UINT32_MAX - 1 ? (uint32_t)limit : UINT32_MAX - 1;
    tracer->line.length = length / tracer->mesh->unit;
    tracer->halt = HALT_END;
    if (!gd__line_append(&tracer->line, start, 0)) status = tracer->line.status;
    if (!status && tracer->options->stop_at_self_intersection)
        status = gd__meetings_create(tracer->mesh, start, tracer->line.control, &tracer->meetings);
    if (status) return gd_fail(detail, status, "%s", gd_status_sentence(status));
    if (length > 0)
        tracer->halt = depart(tracer, gd__turn_of_angle(tracer->mesh, start, tracer->ahead.angle));
    return GD_OK;
}

/* The first failure of all. */
static enum gd_status status_of(const struct tracer *tracers, uint32_t count)
{
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < count && !status; i++) status = tracers[i].line.status;
    return status;
}

enum gd_status gd_trace_follow_many(const struct gd_mesh *mesh,
                                    const struct gd_trace_request *request,
                                    const struct gd_control *control, struct gd_trace *out,
                                    struct gd_detail *detail)
{
    uint32_t count = request->count;
    static const struct gd_trace_options usual = {0};
    struct tracer tracers[GD_TRACE_LANES];
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < count; i++) {
        tracers[i] = (struct tracer){.mesh = mesh,
                                     .options = request->options ? request->options : &usual,
                                     .line = {.control = control, .others = count - 1}};
        if (!status) status = open(&tracers[i], request, &request->ahead[i], detail);
    }
    if (!status) {
        run(tracers, count);
        status = status_of(tracers, count);
        if (status) gd_fail(detail, status, "%s", gd_status_sentence(status));
    }
    for (uint32_t i = 0; i < count; i++) {
        if (!status) finish(&tracers[i], &out[i]);
        if (!status && !(request->length > 0)) out[i].direction = tracers[i].ahead;
        if (status) free(tracers[i].line.points);
        gd__meetings_destroy(tracers[i].meetings);
    }
    return status;
}

enum gd_status gd_trace_follow(const struct gd_mesh *mesh, const struct gd_trace_request *request,
                               const struct gd_control *control, struct gd_trace *out,
                               struct gd_detail *detail)
{
    struct gd_trace_request one = *request;
    one.count = 1;
    return gd_trace_follow_many(mesh, &one, control, out, detail);
}

void gd_trace_free(struct gd_trace *trace)
{
    if (!trace) return;
    gd_path_free(&trace->path);
    *trace = (struct gd_trace){0};
}

struct gd_direction gd_trace_fan(const struct gd_mesh *mesh, const struct gd_point *point,
                                 uint32_t count, uint32_t i)
{
    bool is_closed = gd__turn_is_closed(mesh, point), is_vertex = point->kind == GD_POINT_VERTEX;
    double total = is_closed || is_vertex ? gd__turn_total(mesh, point) : M_PI, first = 0;
    if (is_closed)
        return gd__turn_direction(mesh, point,
                                  gd__turn_of_angle(mesh, point, 2 * M_PI * i / count));
    if (!is_vertex && gd__side_is_boundary(mesh, 2 * point->element)) first = M_PI;
    return gd__turn_direction(mesh, point, first + (count > 1 ? total * i / (count - 1) : 0));
}
