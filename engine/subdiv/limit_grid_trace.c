/* Traces on a limit grid: crosses triangles as a surface ray does (transport/surface_ray.h), but
 * computes the record (struct gd_side) of each triangle from its corners. At a vertex, lists the
 * triangles around the vertex and continues the line by the rules of transport/straight.c. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/pace.h"
#include "base/tolerance.h"
#include "mesh/triangle.h"
#include "subdiv/limit_grid.h"
#include "transport/surface_ray.h"

enum { RING_MOST = 64, RING_STEP = 64 };

/* A triangle to the left of an edge, with its record. Its third corner is `apex`. */
struct view {
    struct gd__grid_edge edge;
    int32_t apex[2];
    struct gd_vec3 p, q, r; /* positions of the edge's ends and of the apex */
    struct gd_side side;
    struct gd_vec3 along, across; /* axes of the edge's frame */
};

/* State of a trace after a step. GOES_ON: the trace is not complete. ENDS: the requested length is
 * reached. STOPS: the boundary is reached. LIMIT: the limit on points is reached, or the call
 * failed (`status`). NEEDS_MESH: this file does not handle the case, so the caller must trace on
 * the mesh. */
enum halt { GOES_ON, ENDS, STOPS, LIMIT, NEEDS_MESH };

struct tracing {
    const struct gd_limit_grid *grid;
    const struct gd_limit_grid_request *request;
    struct gd__pace *pace;
    struct gd_limit_path path;
    uint32_t capacity, limit;
    /* the length so far is gone + carry; `carry` collects the rounding errors of `gone` */
    double gone, carry;
    struct view view;
    struct gd__surface_ray ray; /* a ray that enters the view's triangle across its edge */
    enum gd_status status;
};

static double rest(const struct tracing *t)
{
    return t->request->length - t->gone - t->carry;
}

static void go(struct tracing *t, double run)
{
    double sum = t->gone + run;
    t->carry += fabs(t->gone) >= fabs(run) ? (t->gone - sum) + run : (run - sum) + t->gone;
    t->gone = sum;
}

/* --- triangles -------------------------------------------------------------------------------- */

/* Computes the triangle to the left of an edge. Returns ENDS if the edge is on the boundary and has
 * no such triangle, NEEDS_MESH if the triangle has no area. */
static enum halt view_edge(const struct gd_limit_grid *grid, const struct gd__grid_edge *edge,
                           struct view *out)
{
    struct view v = {.edge = *edge};
    if (!gd__grid_settle(grid, &v.edge)) return ENDS;
    gd__grid_apex(grid, &v.edge, v.apex);
    v.p = gd__grid_position(grid, v.edge.face, v.edge.p);
    v.q = gd__grid_position(grid, v.edge.face, v.edge.q);
    v.r = gd__grid_position(grid, v.edge.face, v.apex);
    struct gd__triangle t =
        gd__triangle_measure(gd_vec3_sub(v.q, v.p), gd_vec3_sub(v.r, v.q), gd_vec3_sub(v.p, v.r));
    if (!(gd__triangle_flatness(&t) >= GD_TOL_FLAT)) return NEEDS_MESH;
    double left = 1 / (t.length[0] * t.length[2]), right = 1 / (t.length[0] * t.length[1]);
    v.side = (struct gd_side){.length = t.length[0],
                              .left_length = t.length[2],
                              .right_length = t.length[1],
                              .left_x = -gd_vec3_dot(t.edge[0], t.edge[2]) * left,
                              .left_y = t.double_area * left,
                              .right_x = -gd_vec3_dot(t.edge[0], t.edge[1]) * right,
                              .right_y = -t.double_area * right,
                              .left = 0,
                              .right = 1};
    *out = v;
    return GOES_ON;
}

static void set_axes(struct view *v)
{
    struct gd_vec3 along = gd_vec3_unit(gd_vec3_sub(v->q, v->p)), up = gd_vec3_sub(v->r, v->p);
    v->along = along;
    v->across = gd_vec3_unit(gd_vec3_along(up, -gd_vec3_dot(up, along), along));
}

static struct gd_vec3 direction_in(struct view *v, double dx, double dy)
{
    set_axes(v);
    return gd_vec3_along(gd_vec3_scale(v->along, dx), dy, v->across);
}

/* --- the path --------------------------------------------------------------------------------- */

static enum halt append(struct tracing *t, const struct gd__face_place *place,
                        struct gd_vec3 position)
{
    t->status = gd__array_extend(&t->path.steps, &t->capacity, t->path.step_count + 1ULL,
                                 sizeof *t->path.steps, t->pace->control);
    if (t->status) return LIMIT;
    t->path.steps[t->path.step_count++] =
        (struct gd_limit_step){gd__place_of(t->grid->surface, place), position, t->gone + t->carry};
    return GOES_ON;
}

/* Appends the point a + part (b - a) of an edge. */
static enum halt append_on_edge(struct tracing *t, uint32_t face, const int32_t a[2],
                                const int32_t b[2], double part)
{
    double cells = t->grid->cells;
    struct gd_vec3 from = gd__grid_position(t->grid, face, a),
                   to = gd__grid_position(t->grid, face, b);
    const struct gd__face_place place = {face, (a[0] + part * (b[0] - a[0])) / cells,
                                         (a[1] + part * (b[1] - a[1])) / cells};
    return append(t, &place, gd_vec3_along(from, part, gd_vec3_sub(to, from)));
}

/* Ends the line in the view's triangle, at the place (x, y) in the frame of the triangle's edge. */
static enum halt end_at(struct tracing *t, double x, double y)
{
    const struct view *v = &t->view;
    double px = v->side.left_length * v->side.left_x, py = v->side.left_length * v->side.left_y;
    double r = fmin(fmax(y / py, 0), 1), q = fmin(fmax((x - r * px) / v->side.length, 0), 1 - r);
    double cells = t->grid->cells, p = 1 - q - r;
    const int32_t *a = v->edge.p, *b = v->edge.q, *c = v->apex;
    const struct gd__face_place place = {v->edge.face, (p * a[0] + q * b[0] + r * c[0]) / cells,
                                         (p * a[1] + q * b[1] + r * c[1]) / cells};
    struct gd_vec3 position = gd_vec3_along(gd_vec3_scale(v->p, p), q, v->q);
    go(t, rest(t));
    enum halt halt = append(t, &place, gd_vec3_along(position, r, v->r));
    return halt ? halt : ENDS;
}

/* --- vertices --------------------------------------------------------------------------------- */

/* The triangles around a vertex, counter-clockwise. View k is to the left of the edge from the
 * vertex to its neighbour k, and `begin` is the angle of this edge from neighbour 0. */
struct ring {
    uint32_t count;
    struct view views[RING_MOST];
    double begin[RING_MOST + 1];
};

static bool is_same_edge(const struct gd__grid_edge *a, const struct gd__grid_edge *b)
{
    return a->face == b->face && memcmp(a->p, b->p, sizeof a->p) == 0 &&
           memcmp(a->q, b->q, sizeof a->q) == 0;
}

static struct gd__grid_edge edge_of(uint32_t face, const int32_t p[2], const int32_t q[2])
{
    return (struct gd__grid_edge){face, {p[0], p[1]}, {q[0], q[1]}};
}

/* Lists the triangles around the vertex where an edge begins. Returns NEEDS_MESH for a boundary
 * vertex. */
static enum halt make_ring(const struct gd_limit_grid *grid, struct gd__grid_edge edge,
                           struct ring *ring)
{
    ring->count = 0;
    ring->begin[0] = 0;
    do {
        struct view *view = &ring->views[ring->count];
        if (ring->count == RING_MOST || view_edge(grid, &edge, view) != GOES_ON) return NEEDS_MESH;
        ring->begin[ring->count + 1] =
            ring->begin[ring->count] + atan2(view->side.left_y, view->side.left_x);
        edge = edge_of(view->edge.face, view->edge.p, view->apex);
        ring->count++;
    } while (gd__grid_settle(grid, &edge) && !is_same_edge(&edge, &ring->views[0].edge));
    return is_same_edge(&edge, &ring->views[0].edge) ? GOES_ON : NEEDS_MESH;
}

/* Starts the ray at the vertex of a ring, at an angle from neighbour 0. */
static void leave_ring(struct tracing *t, const struct ring *ring, double angle)
{
    double total = ring->begin[ring->count];
    uint32_t k = 0;
    if (angle >= total) angle -= total;
    while (k + 1 < ring->count && ring->begin[k + 1] <= angle) k++;
    angle -= ring->begin[k];
    t->view = ring->views[k];
    t->ray = (struct gd__surface_ray){0, 0, cos(angle), fmax(sin(angle), 0)};
}

/* Computes the angle of the continuation that lies in the plane of the line and the normal, as
 * transport/straight.c does. Returns false if there is no such continuation. */
static bool leave_by_normal(const struct ring *ring, struct gd_vec3 back, struct gd_vec3 normal,
                            double *out)
{
    struct gd_vec3 across = gd_vec3_cross(back, normal),
                   ahead = gd_vec3_sub(gd_vec3_scale(normal, gd_vec3_dot(back, normal)), back);
    double best = 0;
    if (!(gd_vec3_length(across) > GD_TOL_HIT)) return false;
    for (uint32_t k = 0; k < ring->count; k++) {
        const struct view *v = &ring->views[k];
        struct gd_vec3 w = gd_vec3_sub(v->q, v->p), u = gd_vec3_sub(v->r, v->q);
        double s = -gd_vec3_dot(across, w) / gd_vec3_dot(across, u);
        if (!(s >= -GD_TOL_HIT && s <= 1 + GD_TOL_HIT)) continue;
        struct gd_vec3 x = gd_vec3_along(w, s, u);
        double cosine = gd_vec3_dot(x, ahead) / (gd_vec3_length(x) * gd_vec3_length(ahead));
        if (!(cosine > best)) continue;
        best = cosine;
        *out = ring->begin[k] + atan2(gd_vec3_length(gd_vec3_cross(w, x)), gd_vec3_dot(w, x));
    }
    return best > 0;
}

/* Continues the line through corner k of the view's triangle (corner 0 is p, 1 is q, 2 is the
 * apex). The line arrives there in the direction (dx, dy) of the view's frame. */
static enum halt go_through(struct tracing *t, int k, double dx, double dy)
{
    struct view *v = &t->view;
    const int32_t *corners[3] = {v->edge.p, v->edge.q, v->apex};
    const struct gd__grid_edge edge = edge_of(v->edge.face, corners[k], corners[(k + 1) % 3]);
    const double cells = t->grid->cells;
    const struct gd__face_place local = {edge.face, edge.p[0] / cells, edge.p[1] / cells};
    struct gd_vec3 back = direction_in(v, -dx, -dy);
    struct ring ring;
    struct gd_limit_jet jet;
    if (make_ring(t->grid, edge, &ring)) return NEEDS_MESH;
    struct view *first = &ring.views[0];
    set_axes(first);
    double turn = atan2(gd_vec3_dot(back, first->across), gd_vec3_dot(back, first->along));
    double out = fmin(fmax(turn, 0), ring.begin[1]) + 0.5 * ring.begin[ring.count];
    if (t->request->vertex_rule == GD_VERTEX_RULE_NORMAL) {
        const struct gd_limit_point place = gd__place_of(t->grid->surface, &local);
        t->status = gd_limit_evaluate(t->grid->surface, &place, &jet, NULL);
        if (t->status) return LIMIT;
        if (!isnan(jet.normal.x)) leave_by_normal(&ring, back, jet.normal, &out);
    }
    leave_ring(t, &ring, out);
    return GOES_ON;
}

/* --- one triangle ----------------------------------------------------------------------------- */

/* The passage of a line through the view's triangle. The line begins at (x, y) in the direction
 * (dx, dy) of the view's frame. After the length `run` it reaches the edge by which it leaves the
 * triangle. `edge` is the length of this edge. */
struct passage {
    double x, y, dx, dy, run, edge;
};

static double drift(const struct tracing *t)
{
    return GD_TOL_DRIFT * t->gone;
}

static double snap_of_end(const struct tracing *t, double edge)
{
    return GD_TOL_HIT * fmin(edge, t->request->length) + drift(t);
}

/* Returns true if the path has reached its limit on points. Sets the path's direction in this
 * case. */
static bool is_full(struct tracing *t, const struct passage *way)
{
    if (t->path.step_count < t->limit) return false;
    t->path.direction = direction_in(&t->view, way->dx, way->dy);
    return true;
}

/* Ends the line inside the triangle, or on the edge along which it runs. For an end elsewhere on
 * the border, returns NEEDS_MESH. */
static enum halt end_inside(struct tracing *t, const struct passage *way, double run)
{
    if (is_full(t, way)) return LIMIT;
    double left = rest(t), y = way->y + left * way->dy, snap = snap_of_end(t, way->edge);
    bool is_along = fabs(way->dy) <= GD_TOL_HIT && y <= snap;
    if (!(left < run - snap && (y > snap || is_along))) return NEEDS_MESH;
    t->path.direction = direction_in(&t->view, way->dx, way->dy);
    return end_at(t, way->x + left * way->dx, y);
}

/* Continues a line that leaves the triangle through an end of the edge that the ray has reached. */
static enum halt pass_vertex(struct tracing *t, const struct passage *way, double snap)
{
    const struct view *v = &t->view;
    bool begins = t->ray.t < 0.5 * way->edge;
    int k = t->ray.side == 0 ? (begins ? 0 : 2) : (begins ? 2 : 1);
    double x = k == 0   ? 0
               : k == 1 ? v->side.length
                        : v->side.left_length * v->side.left_x,
           y = k == 2 ? v->side.left_length * v->side.left_y : 0;
    double run = hypot(x - way->x, y - way->y);
    const int32_t *corners[3] = {v->edge.p, v->edge.q, v->apex};
    if (rest(t) <= run + snap) return end_inside(t, way, run);
    if (is_full(t, way)) return LIMIT;
    go(t, run);
    enum halt halt = append_on_edge(t, v->edge.face, corners[k], corners[k], 0);
    return halt ? halt : go_through(t, k, way->dx, way->dy);
}

/* Handles a ray that has reached the boundary. The path stops there. If it may have to follow the
 * boundary, returns NEEDS_MESH. */
static enum halt meet_boundary(struct tracing *t, const struct passage *way)
{
    double ahead = t->ray.dx > 0 ? way->edge - t->ray.t : t->ray.t;
    bool leans = fabs(t->ray.dx) > GD_TOL_HIT;
    if (leans && fmin(ahead, rest(t)) * t->ray.dy <= GD_TOL_HIT * way->edge + drift(t))
        return NEEDS_MESH; /* the line may follow the boundary */
    t->path.direction = direction_in(&t->view, way->dx, way->dy);
    return STOPS;
}

static enum halt pass(struct tracing *t, const struct passage *way)
{
    const struct view *v = &t->view;
    double snap =
        GD_TOL_HIT * fmin(way->edge, t->gone + way->run) + GD_TOL_PLACE * way->edge + drift(t);
    if (!(t->ray.t > snap && t->ray.t < way->edge - snap)) return pass_vertex(t, way, snap);
    if (rest(t) <= way->run + snap_of_end(t, way->edge)) return end_inside(t, way, way->run);
    if (is_full(t, way)) return LIMIT;
    const int32_t *from = t->ray.side == 0 ? v->edge.p : v->apex,
                  *to = t->ray.side == 0 ? v->apex : v->edge.q;
    const struct gd__grid_edge edge = edge_of(v->edge.face, from, to);
    go(t, way->run);
    enum halt halt = append_on_edge(t, edge.face, edge.p, edge.q, t->ray.t / way->edge);
    if (halt) return halt;
    struct view next;
    halt = view_edge(t->grid, &edge, &next);
    if (halt) return halt == ENDS ? meet_boundary(t, way) : halt;
    t->view = next;
    return GOES_ON;
}

static enum halt cross(struct tracing *t)
{
    struct passage way = {.x = t->ray.t, .dx = t->ray.dx, .dy = t->ray.dy};
    struct gd__face_crossing crossing = gd__surface_ray_cross(&t->view.side, &t->ray);
    way.run = crossing.run;
    way.edge = crossing.edge;
    return pass(t, &way);
}

/* --- the start -------------------------------------------------------------------------------- */

/* A small mesh around the start: triangle k has the corners 0, k + 1 and k + 2 of a ring, or is one
 * of the two triangles of an edge. */
struct patch {
    double points[RING_MOST + 1][3];
    uint32_t faces[RING_MOST][3];
    uint32_t point_count, face_count;
};

static void put_point(struct patch *patch, struct gd_vec3 p)
{
    double *out = patch->points[patch->point_count++];
    out[0] = p.x, out[1] = p.y, out[2] = p.z;
}

/* Projects the direction of the request to the surface at a place of face 0 of the patch. out->face
 * is the face into which the projected direction leads. */
static enum halt project(struct tracing *t, struct patch *patch, const double weights[3],
                         struct gd_direction *out)
{
    const struct gd_polygons polygons = {.positions = patch->points,
                                         .position_count = patch->point_count,
                                         .polygon_count = patch->face_count,
                                         .corners = *patch->faces};
    struct gd_mesh *mesh;
    struct gd_point point;
    enum gd_status status = gd_mesh_build(&polygons, NULL, NULL, &mesh, NULL);
    if (status) {
        if (status == GD_NO_MEMORY) t->status = status;
        return t->status ? LIMIT : NEEDS_MESH;
    }
    status = gd_point_in_face(mesh, (struct gd_face){0}, weights, &point, NULL);
    if (!status) status = gd_direction_along(mesh, &point, t->request->direction, out, NULL);
    gd_mesh_release(mesh);
    return status ? NEEDS_MESH : GOES_ON;
}

/* Starts at a vertex, the first corner of a triangle. */
static enum halt start_at_vertex(struct tracing *t, const struct gd__grid_edge *edge)
{
    struct ring ring;
    struct patch patch = {.point_count = 0};
    struct gd_direction direction;
    if (make_ring(t->grid, *edge, &ring)) return NEEDS_MESH;
    put_point(&patch, ring.views[0].p);
    for (uint32_t k = 0; k < ring.count; k++) {
        put_point(&patch, ring.views[k].q);
        patch.faces[k][0] = 0, patch.faces[k][1] = k + 1;
        patch.faces[k][2] = k + 1 < ring.count ? k + 2 : 1;
    }
    patch.face_count = ring.count;
    enum halt halt = project(t, &patch, (const double[3]){1, 0, 0}, &direction);
    if (halt) return halt;
    struct view *view = &ring.views[direction.face.index];
    set_axes(view);
    leave_ring(t, &ring,
               ring.begin[direction.face.index] +
                   fmax(atan2(gd_vec3_dot(direction.xyz, view->across),
                              gd_vec3_dot(direction.xyz, view->along)),
                        0));
    return GOES_ON;
}

/* Starts on an edge, at the fraction `part` of it. */
static enum halt start_on_edge(struct tracing *t, const struct gd__grid_edge *edge, double part)
{
    const struct gd__grid_edge back = edge_of(edge->face, edge->q, edge->p);
    struct view views[2];
    struct patch patch = {.faces = {{0, 1, 2}, {1, 0, 3}}, .face_count = 2};
    struct gd_direction direction;
    if (view_edge(t->grid, edge, &views[0]) || view_edge(t->grid, &back, &views[1]))
        return NEEDS_MESH;
    put_point(&patch, views[0].p);
    put_point(&patch, views[0].q);
    for (int k = 0; k < 2; k++) put_point(&patch, views[k].r);
    enum halt halt = project(t, &patch, (const double[3]){1 - part, part, 0}, &direction);
    if (halt) return halt;
    uint32_t k = direction.face.index;
    t->view = views[k];
    set_axes(&t->view);
    t->ray = (struct gd__surface_ray){0, (k ? 1 - part : part) * t->view.side.length,
                                      gd_vec3_dot(direction.xyz, t->view.along),
                                      fmax(gd_vec3_dot(direction.xyz, t->view.across), 0)};
    return GOES_ON;
}

/* Crosses the triangle from a place inside it. Finds the edge by which the line leaves the
 * triangle, and uses the frame of the edge after it. */
static enum halt start_inside(struct tracing *t, uint32_t face, int32_t corners[3][2],
                              const double weights[3])
{
    struct view views[3], *v;
    double least = INFINITY;
    int leaves = -1;
    struct gd_vec3 at = {0, 0, 0}, d = t->request->direction;
    for (int k = 0; k < 3; k++)
        at = gd_vec3_along(at, weights[k], gd__grid_position(t->grid, face, corners[k]));
    for (int k = 0; k < 3; k++) {
        const struct gd__grid_edge edge = edge_of(face, corners[k], corners[(k + 1) % 3]);
        if (view_edge(t->grid, &edge, &views[k])) return NEEDS_MESH;
        v = &views[k];
        set_axes(v);
        double dy = gd_vec3_dot(d, v->across), y = gd_vec3_dot(gd_vec3_sub(at, v->p), v->across);
        if (dy < 0 && y / -dy < least) least = y / -dy, leaves = k;
    }
    if (leaves < 0) return NEEDS_MESH; /* the direction is normal to the triangle */
    v = &views[(leaves + 1) % 3];
    struct gd_vec3 from = gd_vec3_sub(at, v->p);
    struct passage way = {gd_vec3_dot(from, v->along),
                          gd_vec3_dot(from, v->across),
                          gd_vec3_dot(d, v->along),
                          gd_vec3_dot(d, v->across),
                          0,
                          v->side.left_length};
    double length = hypot(way.dx, way.dy), lx = v->side.left_x, ly = v->side.left_y;
    way.dx /= length, way.dy /= length;
    way.run = least * length;
    double x = way.x + way.run * way.dx, y = way.y + way.run * way.dy;
    t->view = *v;
    t->ray = (struct gd__surface_ray){0, x * lx + y * ly, lx * way.dx + ly * way.dy,
                                      lx * way.dy - ly * way.dx};
    return pass(t, &way);
}

static enum halt start(struct tracing *t, const struct gd__face_place *place)
{
    int32_t corners[3][2];
    double weights[3];
    int zeros = 0, largest = 0, zero = 0;
    gd__grid_triangle(t->grid, place, corners, weights);
    for (int k = 0; k < 3; k++) {
        if (weights[k] <= GD_TOL_ON_BORDER) weights[k] = 0, zero = k, zeros++;
        if (weights[k] > weights[largest]) largest = k;
    }
    int first = zeros == 2 ? largest : (zero + 1) % 3;
    const struct gd__grid_edge edge =
        edge_of(place->face, corners[first], corners[(first + 1) % 3]);
    struct gd_vec3 at = {0, 0, 0};
    double sum = weights[0] + weights[1] + weights[2];
    for (int k = 0; k < 3; k++) {
        weights[k] /= sum;
        at = gd_vec3_along(at, weights[k], gd__grid_position(t->grid, place->face, corners[k]));
    }
    enum halt halt = append(t, place, at);
    if (halt) return halt;
    if (zeros == 2) return start_at_vertex(t, &edge);
    if (zeros == 1) return start_on_edge(t, &edge, weights[(first + 1) % 3]);
    return start_inside(t, place->face, corners, weights);
}

/* --- public call ------------------------------------------------------------------------------ */

static enum gd_status check(const struct gd_limit_grid_request *request, struct gd_detail *detail)
{
    struct gd_vec3 d = request->direction;
    if (!(request->length >= 0 && request->length < INFINITY))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the length is %g: it must be at least 0 and finite", request->length);
    if (!gd_vec3_is_finite(d))
        return gd_fail(detail, GD_INVALID_ARGUMENT, "the direction must be finite");
    return GD_OK;
}

static enum gd_limit_end end_of(enum halt halt)
{
    return halt == ENDS    ? GD_LIMIT_END_LENGTH
           : halt == STOPS ? GD_LIMIT_END_BOUNDARY
                           : GD_LIMIT_END_STEPS;
}

enum gd_status gd_limit_grid_trace(const struct gd_limit_grid *grid,
                                   const struct gd_limit_grid_request *request,
                                   const struct gd_control *control, struct gd_limit_path *out,
                                   struct gd_detail *detail)
{
    struct gd_limit_point place = request->start;
    enum gd_status status = gd__place_check(grid->surface, &place, detail);
    if (!status) status = check(request, detail);
    if (status) return status;
    struct gd__pace pace = {.control = control, .count = GD__PACE_STEPS};
    struct tracing t = {.grid = grid,
                        .request = request,
                        .pace = &pace,
                        .limit = request->step_limit ? request->step_limit + 1 : GD_LIMIT_STEPS};
    const struct gd__face_place local = gd__face_place_of(grid->surface, &place);
    enum halt halt = request->length > 0 ? start(&t, &local) : NEEDS_MESH;
    while (halt == GOES_ON && gd__pace(&pace, 2)) halt = cross(&t);
    status = t.status ? t.status : pace.status;
    t.path.length = t.gone + t.carry;
    t.path.end = end_of(halt);
    if (status || halt == NEEDS_MESH) gd_limit_path_free(&t.path);
    if (!status) *out = t.path;
    return status ? gd_fail_status(detail, status) : GD_OK;
}
