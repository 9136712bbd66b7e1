#include "gd/trace.h"

#include <stdlib.h>
#include <string.h>

#include "base/arena.h"
#include "base/tolerance.h"
#include "mesh/canonical.h"
#include "transport/straight.h"
#include "transport/surface_ray.h"

/* --- the line --------------------------------------------------------------------------------- */

enum {
    FIRST = 64,   /* initial capacity of a line, in points */
    CHUNK = 16384 /* number of points between two checks of the control, a millisecond */
};

/* The polyline of a trace, with its length and limits. Normalised unit. */
struct line {
    struct gd_point *points;
    uint32_t count, capacity;
    uint32_t limit;     /* largest number of points after the first */
    double length;      /* requested */
    double gone, carry; /* sum of the segments: gone + carry */
    const struct gd_control *control;
    enum gd_status status; /* the first failure */
};

static uint32_t next_capacity(const struct line *line)
{
    uint32_t doubled = line->capacity ? 2 * line->capacity : FIRST,
             stepped = line->capacity + CHUNK;
    uint32_t capacity = doubled < stepped ? doubled : stepped;
    return capacity < line->limit + 1 ? capacity : line->limit + 1;
}

/* Increases the capacity and checks the control. Returns false on failure, and also if the limit is
 * reached; the status is then GD_OK. */
static bool line_grow(struct line *line)
{
    uint32_t capacity = next_capacity(line);
    if (line->status || capacity <= line->count) return false;
    double part = line->length > 0 ? fmin((line->gone + line->carry) / line->length, 1) : 0;
    line->status = gd_control_check(line->control, part);
    if (!line->status)
        line->status = gd_control_afford(line->control, ((size_t)capacity + line->capacity) *
                                                            sizeof *line->points);
    if (line->status) return false;
    struct gd_point *points = realloc(line->points, capacity * sizeof *points);
    if (!points) {
        line->status = GD_NO_MEMORY;
        return false;
    }
    line->points = points;
    line->capacity = capacity;
    return true;
}

static inline double line_rest(const struct line *line)
{
    return line->length - line->gone - line->carry;
}

/* Adds `run` to `gone` by Neumaier's compensated summation: `carry` collects the rounding
 * errors. */
static inline void line_go(struct line *line, double run)
{
    double sum = line->gone + run;
    line->carry += line->gone >= run ? (line->gone - sum) + run : (run - sum) + line->gone;
    line->gone = sum;
}

static inline bool line_append(struct line *line, const struct gd_point *point, double run)
{
    if (line->count == line->capacity && !line_grow(line)) return false;
    line->points[line->count++] = *point;
    line_go(line, run);
    return true;
}

static inline struct gd_point *line_last(const struct line *line)
{
    return &line->points[line->count - 1];
}

/* --- meetings --------------------------------------------------------------------------------- */

/* A segment, in the frame of its face's side 0. */
struct segment {
    struct gd__local from, to;
    uint32_t before; /* the previous segment in the same face, or GD_NONE if there is none */
};

/* Detects where a line meets itself. Segments are indexed by face. The vertices that the line
 * passes are marked separately. */
struct meetings {
    const struct gd_mesh *mesh;
    struct gd__arena arena;
    uint32_t *newest; /* for each face, its latest segment */
    bool *is_met;     /* for each vertex, true if the line has passed through it */
    struct segment *segments;
    uint32_t count, capacity;
};

/* Opens the index of a line that begins at `start`. O(faces). */
static enum gd_status meetings_open(struct meetings *meetings, const struct gd_mesh *mesh,
                                    const struct gd_point *start, const struct gd_control *control)
{
    struct gd__arena *arena = &meetings->arena;
    meetings->mesh = mesh;
    arena->budget.control = control;
    meetings->newest = gd__arena_take(arena, mesh->face_count, sizeof *meetings->newest);
    meetings->is_met = gd__arena_zeroed(arena, mesh->vertex_count, sizeof *meetings->is_met);
    if (arena->status) return arena->status;
    memset(meetings->newest, 0xff,
           mesh->face_count * sizeof *meetings->newest); /* sets all entries to GD_NONE */
    if (start->kind == GD_POINT_VERTEX) meetings->is_met[start->element] = true;
    return GD_OK;
}

/* For segments on the same line: returns the fraction of `a` at which it first overlaps `b`, or 2
 * if they do not overlap. */
static double meet_along(const struct segment *a, const struct segment *b)
{
    struct gd__local d = gd__local_minus(a->to, a->from), w = gd__local_minus(b->from, a->from),
                     e = gd__local_minus(b->to, a->from);
    double length = gd__local_dot(d, d), touch = GD_TOL_TOUCH * length;
    if (fabs(gd__local_cross(d, w)) > touch || fabs(gd__local_cross(d, e)) > touch) return 2;
    double first = fmin(gd__local_dot(d, w), gd__local_dot(d, e)) / length,
           last = fmax(gd__local_dot(d, w), gd__local_dot(d, e)) / length;
    if (last <= GD_TOL_TOUCH || first > 1 + GD_TOL_TOUCH) return 2;
    return fmax(first, GD_TOL_TOUCH);
}

/* Returns the fraction of `a` at which it meets `b`, or 2 if they do not meet. */
static double meetings_meet(const struct segment *a, const struct segment *b)
{
    struct gd__local d = gd__local_minus(a->to, a->from), e = gd__local_minus(b->to, b->from),
                     w = gd__local_minus(b->from, a->from);
    double sine = gd__local_cross(d, e), lengths = sqrt(gd__local_dot(d, d) * gd__local_dot(e, e));
    if (!(lengths > 0)) return 2;
    if (fabs(sine) <= GD_TOL_TOUCH * lengths) return meet_along(a, b);
    double part = gd__local_cross(w, e) / sine, other = gd__local_cross(w, d) / sine;
    if (part <= GD_TOL_TOUCH || part > 1 + GD_TOL_TOUCH) return 2;
    return other >= -GD_TOL_TOUCH && other <= 1 + GD_TOL_TOUCH ? part : 2;
}

/* Adds the line's next segment, which lies in `face`. Sets *part to the fraction of the segment, in
 * (0, 1], at which it first meets an earlier segment, or to 2 if it meets none. The end of the
 * previous segment, where this segment begins, does not count. O(segments in the face). */
static enum gd_status meetings_add(struct meetings *meetings, uint32_t face,
                                   const struct gd_point *from, const struct gd_point *to,
                                   double *part)
{
    struct segment segment = {gd__point_local(meetings->mesh, face, from),
                              gd__point_local(meetings->mesh, face, to), meetings->newest[face]};
    double first = 2;
    for (uint32_t i = segment.before; i != GD_NONE; i = meetings->segments[i].before)
        first = fmin(first, meetings_meet(&segment, &meetings->segments[i]));
    if (to->kind == GD_POINT_VERTEX) {
        if (meetings->is_met[to->element]) first = fmin(first, 1);
        meetings->is_met[to->element] = true;
    }
    meetings->newest[face] = meetings->count;
    *part = first > 1 && first < 2 ? 1 : first;
    return gd__arena_append(&meetings->arena, &meetings->segments, &meetings->count,
                            &meetings->capacity, &segment, sizeof segment);
}

/* --- halts ------------------------------------------------------------------------------------ */

/* A trace alternates between rays and halts. A ray runs straight from face to face; its side
 * determines the current face. A halt is a vertex, a position on the boundary, or the end of the
 * trace. At a halt, the direction of arrival is stored as a turn (line/turn.h). */

enum halt {
    HALT_NONE, /* no halt: the ray enters the face of its side */
    /* at a vertex, the last point of the line; the line arrived from the turn `back` */
    HALT_VERTEX,
    HALT_BORDER, /* at the boundary, on the ray's side */
    /* the requested length is reached; this halt and the following ones end the trace */
    HALT_END,
    HALT_STOP, /* the boundary is reached */
    HALT_MEETING,
    HALT_LIMIT /* the step limit is reached, or the line's status is a failure */
};

struct tracer {
    const struct gd_mesh *mesh;
    const struct gd_trace_options *options;
    struct line line;
    struct gd__surface_ray walk;
    enum halt halt;
    /* at all halts except HALT_NONE and HALT_BORDER, the turn of the direction from the last point
       back along the line */
    double back;
    struct meetings meetings;  /* all zero if not requested */
    struct gd_direction ahead; /* direction at the start */
};

/* --- one face --------------------------------------------------------------------------------- */

/* Returns a bound on the accumulated rounding error of the line's position. */
static inline double drift(const struct tracer *tracer)
{
    return GD_TOL_DRIFT * tracer->line.gone;
}

/* Ends the trace if its last segment, which lies in `face`, meets an earlier segment. */
static enum halt transport_trace_meet(struct tracer *tracer, uint32_t face, double run,
                                      enum halt halt)
{
    const struct gd_mesh *mesh = tracer->mesh;
    struct line *line = &tracer->line;
    struct gd_point *from = line_last(line) - 1, *to = from + 1;
    double part = 2, a[3], b[3], at[3];
    line->status = meetings_add(&tracer->meetings, face, from, to, &part);
    if (line->status || part > 1) return line->status ? HALT_LIMIT : halt;
    gd__point_weights(mesh, from, face, a);
    gd__point_weights(mesh, to, face, b);
    for (int k = 0; k < 3; k++) at[k] = fmax(a[k] + part * (b[k] - a[k]), 0);
    uint32_t side = mesh->face_side[face][0];
    struct gd__local way =
        gd__face_local(mesh, side, (double[3]){a[0] - b[0], a[1] - b[1], a[2] - b[2]});
    if (part < 1) *to = gd__point_of_face(mesh, face, at);
    line_go(line, (part - 1) * run);
    tracer->back = gd__turn_in_face(mesh, to, side, way.x, way.y);
    return HALT_MEETING;
}

/* Appends a point of a face. The segment to this point lies in the same face. */
static inline enum halt transport_trace_append(struct tracer *tracer, struct gd_point point,
                                               uint32_t face, double run, enum halt halt)
{
    if (!line_append(&tracer->line, &point, run)) return HALT_LIMIT;
    return tracer->meetings.mesh ? transport_trace_meet(tracer, face, run, halt) : halt;
}

/* Returns the point of the side's face at a position in the side's frame. If an edge or a vertex is
 * within the distance `snap`, moves the point there. */
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

/* Ends the line in the ray's face. */
static enum halt end_in_face(struct tracer *tracer, const struct gd__ray *ray, double snap)
{
    const struct gd_mesh *mesh = tracer->mesh;
    double run = fmax(line_rest(&tracer->line), 0);
    struct gd_point end = point_at(
        mesh, ray->side, (struct gd__local){ray->x + run * ray->dx, ray->y + run * ray->dy}, snap);
    tracer->back = gd__turn_in_face(mesh, &end, ray->side, -ray->dx, -ray->dy);
    if (gd_point_equal(&end, line_last(&tracer->line))) {
        line_go(&tracer->line, run);
        return HALT_END;
    }
    return transport_trace_append(tracer, end, mesh->side_face[ray->side], run, HALT_END);
}

/* Returns the position of a corner of the side's face, in the side's frame. */
static struct gd__local corner_of(const struct gd_mesh *mesh, uint32_t side, uint32_t vertex)
{
    const struct gd_side *s = &mesh->side[side];
    if (vertex == mesh->origin[side]) return (struct gd__local){0, 0};
    if (vertex == mesh->origin[side ^ 1]) return (struct gd__local){s->length, 0};
    return (struct gd__local){s->left_length * s->left_x, s->left_length * s->left_y};
}

/* Returns the distance within which the line's end is snapped to an edge or a vertex. */
static double snap_of_end(const struct tracer *tracer, double edge)
{
    return GD_TOL_HIT * fmin(edge, tracer->line.length) + drift(tracer);
}

/* Continues a line that leaves the ray's face through an end of the edge that the walk has
 * reached. */
static enum halt pass_vertex(struct tracer *tracer, const struct gd__ray *ray, double edge,
                             double snap)
{
    const struct gd_mesh *mesh = tracer->mesh;
    const struct gd__surface_ray *walk = &tracer->walk;
    struct gd_point vertex =
        gd__point_of_vertex(mesh->origin[walk->side ^ !(walk->t < 0.5 * edge)]);
    struct gd__local corner = corner_of(mesh, ray->side, vertex.element);
    double run = hypot(corner.x - ray->x, corner.y - ray->y);
    if (line_rest(&tracer->line) < run - snap)
        return end_in_face(tracer, ray, snap_of_end(tracer, edge));
    tracer->back = gd__turn_in_face(mesh, &vertex, walk->side ^ 1, walk->dx, walk->dy);
    bool is_end = line_rest(&tracer->line) <= run + snap;
    return transport_trace_append(tracer, vertex, mesh->side_face[ray->side],
                                  is_end ? line_rest(&tracer->line) : run,
                                  is_end ? HALT_END : HALT_VERTEX);
}

/* Continues after the walk has left the ray's face: appends the crossing, a vertex, or the end of
 * the line. */
static inline enum halt transport_trace_pass(struct tracer *tracer, const struct gd__ray *ray,
                                             const struct gd__face_crossing *passage)
{
    const struct gd__surface_ray *walk = &tracer->walk;
    /* near its start, the line is accurate enough to determine on which side of a vertex it
       passes */
    double gone = tracer->line.gone + passage->run;
    double snap =
        GD_TOL_HIT * fmin(passage->edge, gone) + GD_TOL_PLACE * passage->edge + drift(tracer);
    if (!(walk->t > snap && walk->t < passage->edge - snap))
        return pass_vertex(tracer, ray, passage->edge, snap);
    double end_snap = snap_of_end(tracer, passage->edge);
    if (line_rest(&tracer->line) <= passage->run + end_snap)
        return end_in_face(tracer, ray, end_snap);
    struct gd_point point = gd__point_within_side(walk->side, walk->t / passage->edge);
    return transport_trace_append(
        tracer, point, tracer->meetings.mesh ? tracer->mesh->side_face[walk->side ^ 1] : GD_NONE,
        passage->run, HALT_NONE);
}

/* --- rays ------------------------------------------------------------------------------------- */

/* Crosses one face. Reads one record of the mesh and prefetches both possible next records. */
static inline enum halt hop(struct tracer *tracer)
{
    const struct gd_mesh *mesh = tracer->mesh;
    const struct gd__surface_ray *walk = &tracer->walk;
    const struct gd_side *s = &mesh->side[walk->side];
    if (s->left == GD_NONE) return HALT_BORDER;
    __builtin_prefetch(&mesh->side[s->left]);
    __builtin_prefetch(&mesh->side[s->right]);
    struct gd__ray ray = {walk->side, walk->t, 0, walk->dx, walk->dy};
    struct gd__face_crossing passage = gd__surface_ray_cross(s, &tracer->walk);
    enum halt halt = transport_trace_pass(tracer, &ray, &passage);
    if (halt == HALT_LIMIT) /* the last point is the beginning of the ray */
        tracer->back = gd__turn_in_face(mesh, line_last(&tracer->line), ray.side, -ray.dx, -ray.dy);
    return halt;
}

/* Computes the side by which a ray that starts inside a face leaves the face. */
static struct gd__face_crossing leave_from_inside(const struct gd_mesh *mesh,
                                                  const struct gd__ray *ray,
                                                  struct gd__surface_ray *walk)
{
    struct gd__face_crossing passage = {0, INFINITY};
    double x = ray->x, y = ray->y, dx = ray->dx, dy = ray->dy;
    uint32_t side = ray->side;
    for (int k = 0; k < 3; k++) {
        const struct gd_side *s = &mesh->side[side];
        double run = dy < 0 ? fmax(y, 0) / -dy : INFINITY;
        if (run < passage.run) {
            passage = (struct gd__face_crossing){s->length, run};
            *walk = (struct gd__surface_ray){side ^ 1, s->length - (x + run * dx), -dx, -dy};
        }
        /* transforms to the frame of the next side, from the destination to the apex */
        double ux = -s->right_x, uy = -s->right_y, rx = x - s->length, ry = y, ex = dx, ey = dy;
        x = rx * ux + ry * uy, y = ry * ux - rx * uy;
        dx = ex * ux + ey * uy, dy = ey * ux - ex * uy;
        side = gd__side_next(mesh, side);
    }
    return passage;
}

/* Starts a ray from the last point in the direction of a turn, and crosses the first face. */
static enum halt depart(struct tracer *tracer, double turn)
{
    const struct gd_mesh *mesh = tracer->mesh;
    const struct gd_point *point = line_last(&tracer->line);
    struct gd__ray ray = gd__turn_ray(mesh, point, turn);
    struct gd__face_crossing passage;
    if (point->kind == GD_POINT_FACE) {
        passage = leave_from_inside(mesh, &ray, &tracer->walk);
    } else {
        tracer->walk = (struct gd__surface_ray){ray.side, ray.x, ray.dx, fmax(ray.dy, 0)};
        passage = gd__surface_ray_cross(&mesh->side[ray.side], &tracer->walk);
    }
    return transport_trace_pass(tracer, &ray, &passage);
}

/* --- the boundary ----------------------------------------------------------------------------- */

/* Slides along a boundary side from `at` to its end, forward or backward. */
static enum halt transport_trace_slide(struct tracer *tracer, uint32_t side, double at,
                                       bool forward)
{
    const struct gd_mesh *mesh = tracer->mesh;
    double edge = mesh->side[side].length, run = forward ? edge - at : at,
           rest = line_rest(&tracer->line);
    uint32_t face = mesh->side_face[side ^ 1];
    double snap = snap_of_end(tracer, edge);
    if (rest < run - snap) {
        double part = (forward ? at + rest : at - rest) / edge;
        struct gd_point end = gd__point_of_edge(mesh, side >> 1, side & 1 ? 1 - part : part);
        tracer->back = gd__turn_in_face(mesh, &end, side ^ 1, forward ? 1 : -1, 0);
        return transport_trace_append(tracer, end, face, rest, HALT_END);
    }
    struct gd_point vertex = gd__point_of_vertex(mesh->origin[forward ? side ^ 1 : side]);
    tracer->back = forward ? 0 : mesh->total_angle[vertex.element];
    bool is_end = rest <= run + snap;
    return transport_trace_append(tracer, vertex, face, is_end ? rest : run,
                                  is_end ? HALT_END : HALT_VERTEX);
}

/* Returns true if the line reaches the boundary at such a small angle that its end, or the vertex
 * ahead, is on the boundary edge up to rounding. The line then continues along the edge, because
 * the position where it crosses the edge is undetermined. */
static bool grazes(const struct tracer *tracer)
{
    const struct gd__surface_ray *walk = &tracer->walk;
    double edge = tracer->mesh->side[walk->side].length,
           ahead = walk->dx > 0 ? edge - walk->t : walk->t;
    return fmin(ahead, line_rest(&tracer->line)) * walk->dy <= GD_TOL_HIT * edge + drift(tracer);
}

static enum halt at_border(struct tracer *tracer)
{
    const struct gd__surface_ray *walk = &tracer->walk;
    bool leans = fabs(walk->dx) > GD_TOL_HIT;
    bool stops = tracer->options->boundary_rule == GD_BOUNDARY_RULE_STOP;
    if (!leans || (stops && !grazes(tracer))) return HALT_STOP;
    return transport_trace_slide(tracer, walk->side, walk->t, walk->dx > 0);
}

static enum halt at_vertex(struct tracer *tracer)
{
    uint32_t vertex = line_last(&tracer->line)->element, side;
    double turn;
    bool forward;
    if (gd__straight_on(tracer->mesh, vertex, tracer->back, tracer->options, &turn))
        return depart(tracer, turn);
    if (tracer->options->boundary_rule == GD_BOUNDARY_RULE_STOP) return HALT_STOP;
    if (!gd__straight_slide(tracer->mesh, vertex, tracer->back, &side, &forward)) return HALT_STOP;
    return transport_trace_slide(tracer, side, forward ? 0 : tracer->mesh->side[side].length,
                                 forward);
}

static inline enum halt go_on(struct tracer *tracer)
{
    if (tracer->halt == HALT_NONE) return hop(tracer);
    if (tracer->halt == HALT_BORDER)
        tracer->back = gd__turn_in_face(tracer->mesh, line_last(&tracer->line),
                                        tracer->walk.side ^ 1, tracer->walk.dx, tracer->walk.dy);
    double back = tracer->back;
    enum halt halt = tracer->halt == HALT_VERTEX ? at_vertex(tracer) : at_border(tracer);
    if (halt == HALT_LIMIT) tracer->back = back; /* the line still ends at the point of the halt */
    return halt;
}

static enum gd_trace_end transport_trace_end_of(enum halt halt)
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

static void transport_trace_finish(struct tracer *tracer, struct gd_trace *out)
{
    const struct line *line = &tracer->line;
    const struct gd_mesh *mesh = tracer->mesh;
    const struct gd_point *last = line_last(line);
    struct gd_direction back = gd__turn_direction(mesh, last, tracer->back);
    *out = (struct gd_trace){
        .path = {(line->gone + line->carry) * mesh->unit, line->count, line->points},
        .direction = gd_direction_opposite(mesh, last, &back),
        .end = transport_trace_end_of(tracer->halt)};
}

/* Initialises a tracer at the start of its line, and crosses the first face. */
static enum gd_status open(struct tracer *tracer, const struct gd_trace_request *request,
                           struct gd_detail *detail)
{
    const struct gd_point *start = request->start;
    double length = request->length;
    if (!(isfinite(length) && length >= 0))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the length is %.17g; it must be a finite number, 0 or more", length);
    enum gd_status status =
        gd_direction_at_angle(tracer->mesh, start, request->ahead->angle, &tracer->ahead, detail);
    if (status) return status;
    uint64_t limit = tracer->options->step_limit ? tracer->options->step_limit : GD_TRACE_STEPS;
    tracer->line.limit = limit < UINT32_MAX - 1 ? (uint32_t)limit : UINT32_MAX - 1;
    tracer->line.length = length / tracer->mesh->unit;
    tracer->halt = HALT_END;
    if (!line_append(&tracer->line, start, 0)) status = tracer->line.status;
    if (!status && tracer->options->stop_at_self_intersection)
        status = meetings_open(&tracer->meetings, tracer->mesh, start, tracer->line.control);
    if (status) return gd_fail_status(detail, status);
    if (length > 0)
        tracer->halt = depart(tracer, gd__turn_of_angle(tracer->mesh, start, tracer->ahead.angle));
    return GD_OK;
}

enum gd_status gd_trace_follow(const struct gd_mesh *mesh, const struct gd_trace_request *request,
                               const struct gd_control *control, struct gd_trace *out,
                               struct gd_detail *detail)
{
    static const struct gd_trace_options usual = {0};
    struct tracer tracer = {.mesh = mesh,
                            .options = request->options ? request->options : &usual,
                            .line = {.control = control}};
    enum gd_status status = open(&tracer, request, detail);
    while (!status && tracer.halt < HALT_END) tracer.halt = go_on(&tracer);
    if (!status && tracer.line.status) status = gd_fail_status(detail, tracer.line.status);
    if (status)
        free(tracer.line.points);
    else
        transport_trace_finish(&tracer, out);
    if (!status && !(request->length > 0)) out->direction = tracer.ahead;
    gd__arena_free(&tracer.meetings.arena);
    return status;
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
