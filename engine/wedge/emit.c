#include "mesh/segment.h"
#include "wedge/wavefront.h"

/* Emission: what a pseudo-source sees at once. A seed sees its face (or the two faces of its edge, or the fan of its vertex); a segment what lies
 * before and behind it at right angles; a saddle or
 * boundary vertex only the shadow cone behind it, where a path that bends there is locally shortest: at least pi on both sides of the ray
 * that came in. */

static void deliver_one(struct gd__wavefront *front, const struct gd__receiver *to, const struct gd__window *window)
{
    if (!front->status) front->status = gd__children_reserve(&front->work->left, &front->work->pool, 1);
    if (front->status) return;
    gd__windows_put(&front->work->left.at, 0, window);
    front->work->left.count = 1;
    gd__wavefront_deliver(front, to, &front->work->left);
}

/* --- vertices ------------------------------------------------------------------------------------------------------------ */

/* Angle of the ray from `vertex` back along its last leg, in its fan. */
static double incoming_angle(const struct gd__wavefront *front, uint32_t vertex)
{
    const struct gd_mesh *mesh = front->mesh;
    struct gd__birth birth = front->birth[vertex];
    if (birth.side != GD_NONE) { /* between p -> origin and p -> destination of the side opposite to p = vertex */
        const struct gd_side *s = &mesh->side[birth.side];
        double px = s->left_length * s->left_x, py = s->left_length * s->left_y;
        double rx = birth.x - px, ry = -birth.y - py, ox = -px, oy = -py;
        if (birth.source != GD_NONE && gd__source_is_linear(birth.source)) rx = birth.x, ry = -birth.y;
        uint32_t entry = mesh->fan_first[vertex], first = gd__side_previous(mesh, birth.side);
        while (mesh->fan[entry].side != first) entry++;
        return mesh->fan[entry].angle + atan2(ox * ry - oy * rx, ox * rx + oy * ry);
    }
    uint32_t edge = GD_NONE;
    if (birth.source >= mesh->vertex_count) edge = front->seeds[birth.source - mesh->vertex_count].point.element;
    for (uint32_t i = mesh->fan_first[vertex]; i < mesh->fan_first[vertex + 1]; i++) {
        uint32_t side = mesh->fan[i].side;
        if (edge != GD_NONE ? side >> 1 == edge : mesh->fan[i].tip == birth.source) return mesh->fan[i].angle;
    }
    return mesh->total_angle[vertex]; /* the last boundary edge of the fan */
}

static void reach_along_edge(struct gd__wavefront *front, uint32_t from, uint32_t to, double length)
{
    struct gd__birth birth = {.side = GD_NONE, .source = from};
    gd__wavefront_reach(front, to, front->distance[from] + length, birth);
}

/* Casts a window through the face of a fan entry, the part of it between the angles from and to (both from the entry's own side). */
static void emit_through_face(struct gd__wavefront *front, uint32_t vertex, const struct gd_fan *fan, double from,
                              double to, double opening)
{
    const struct gd_mesh *mesh = front->mesh;
    const struct gd_side *s = &mesh->side[fan->side];
    double length = s->right_length, px = s->left_length * s->left_x, py = s->left_length * s->left_y;
    double ax = px - s->length, b0 = 0,
           b1 = length; /* (ax, py): destination -> apex; the window's side runs the other way */
    double x = -(px * s->right_x + py * s->right_y),
           y = py * s->length / length; /* twice the area over the edge: no cancellation */
    if (gd__window_grazes(x, y, length)) return;
    bool cap =
        y <= GD_TOL_CAP *
                 length; /* the vertex lies almost on the edge: see all of it, as its ends would not tell the angle */
    if (from > 0 && !cap) b1 = length * (1 - sin(from) * s->length / (cos(from) * py - sin(from) * ax));
    if (to < opening && !cap) b0 = length * (1 - sin(to) * s->length / (cos(to) * py - sin(to) * ax));
    if (b0 < 0) b0 = 0;
    if (b1 > length) b1 = length;
    if (b1 - b0 <= GD_TOL_WIDTH * length) return;
    struct gd__window window = {.b0 = b0, .b1 = b1, .x = x, .y = y, .sigma = front->distance[vertex], .source = vertex};
    uint32_t apex = fan + 1 < mesh->fan + mesh->fan_first[vertex + 1] ? fan[1].tip : mesh->origin[s->right];
    struct gd__receiver receiver = {s->right,
                                    length,
                                    front->distance[apex],
                                    front->distance[fan->tip],
                                    gd__wavefront_rest(front, apex),
                                    gd__wavefront_rest(front, fan->tip),
                                    front->falls};
    deliver_one(front, &receiver, &window);
}

/* Emits into the directions [from, to] of the fan, 0 <= from <= to; an interior fan goes round (to may exceed the total angle). */
static void emit_cone(struct gd__wavefront *front, uint32_t vertex, double from, double to)
{
    const struct gd_mesh *mesh = front->mesh;
    uint32_t first = mesh->fan_first[vertex], end = mesh->fan_first[vertex + 1];
    double total = mesh->total_angle[vertex];
    bool interior = mesh->vertex_kind[vertex] != GD_VERTEX_BOUNDARY;
    for (int lap = 0; lap < (interior ? 2 : 1); lap++) {
        double turn = lap * total;
        for (uint32_t i = first; i < end; i++) {
            double begin = mesh->fan[i].angle + turn, stop = (i + 1 < end ? mesh->fan[i + 1].angle : total) + turn;
            if (stop < from - GD_TOL_CONE) continue;
            if (begin > to + GD_TOL_CONE) break;
            const struct gd_fan *fan = &mesh->fan[i];
            if (interior && begin >= from - GD_TOL_CONE)
                reach_along_edge(front, vertex, fan->tip, mesh->side[fan->side].length);
            if (stop <= from || begin >= to) continue;
            emit_through_face(front, vertex, fan, from - begin, to - begin, stop - begin);
        }
    }
}

/* A boundary vertex offers its distance along all of its edges: always true, and the cone's edge cases need no care. */
static void reach_all_neighbours(struct gd__wavefront *front, uint32_t vertex)
{
    const struct gd_mesh *mesh = front->mesh;
    for (uint32_t i = mesh->fan_first[vertex]; i < mesh->fan_first[vertex + 1]; i++) {
        uint32_t side = mesh->fan[i].side, last = gd__side_previous(mesh, side);
        reach_along_edge(front, vertex, mesh->fan[i].tip, mesh->side[side].length);
        if (gd__side_is_boundary(mesh, last ^ 1))
            reach_along_edge(front, vertex, mesh->origin[last], mesh->side[last].length);
    }
}

static void emit_vertex(struct gd__wavefront *front, uint32_t vertex)
{
    const struct gd_mesh *mesh = front->mesh;
    double total = mesh->total_angle[vertex];
    front->emitted[vertex] = front->distance[vertex];
    front->effort.vertices_emitted++;
    bool boundary = mesh->vertex_kind[vertex] == GD_VERTEX_BOUNDARY,
         is_seed = front->birth[vertex].source >= mesh->vertex_count && front->birth[vertex].source != GD_NONE &&
                   front->birth[vertex].side == GD_NONE &&
                   front->seeds[front->birth[vertex].source - mesh->vertex_count].point.kind == GD_POINT_VERTEX;
    if (boundary || is_seed) reach_all_neighbours(front, vertex);
    if (is_seed || front->methods.no_cone) {
        emit_cone(front, vertex, 0, total);
        return;
    }
    double in = incoming_angle(front, vertex);
    if (boundary) {
        if (in + M_PI < total) emit_cone(front, vertex, in + M_PI, total);
        if (in - M_PI > 0) emit_cone(front, vertex, 0, in - M_PI);
    } else {
        double from = in + M_PI < total ? in + M_PI : in + M_PI - total;
        emit_cone(front, vertex, from, from + total - 2 * M_PI);
    }
}

/* The other wavefront of a domain emits from common vertices itself. Of the others it has to know the distance, as windows of theirs may come to it. */
void gd__emit_vertex(struct gd__wavefront *front, uint32_t vertex)
{
    struct gd__domain *domain = front->domain;
    if (!domain) {
        emit_vertex(front, vertex);
        return;
    }
    if (!gd__domain_has_vertex(domain, vertex)) return;
    domain->is_common = gd__domain_shares_vertex(domain, vertex);
    if (!domain->is_common) gd__wavefront_tell(front, vertex);
    if (!front->status) emit_vertex(front, vertex);
    domain->is_common = false;
}

/* --- seeds --------------------------------------------------------------------------------------------------------------- */

/* Offers a side a seed's window. */
static void seed_side(struct gd__wavefront *front, uint32_t side, const struct gd__window *window)
{
    struct gd__receiver to = gd__wavefront_receiver(front, side);
    deliver_one(front, &to, window);
}

/* Sends the seed's window out of its face across `side` (a side of that face). */
static void seed_across(struct gd__wavefront *front, uint32_t seed, uint32_t side, struct gd__local at)
{
    double length = front->mesh->side[side].length;
    if (gd__window_grazes(length - at.x, at.y, length)) return;
    struct gd__window window = {.b0 = 0,
                                .b1 = length,
                                .x = length - at.x,
                                .y = at.y,
                                .sigma = front->seeds[seed].offset,
                                .source = front->mesh->vertex_count + seed};
    seed_side(front, side ^ 1, &window);
}

/* Straight to the apex of `side`, a side of the seed's face. */
static void seed_apex(struct gd__wavefront *front, uint32_t seed, uint32_t side, struct gd__local at)
{
    const struct gd_side *s = &front->mesh->side[side];
    double dx = at.x - s->left_length * s->left_x, dy = at.y - s->left_length * s->left_y;
    struct gd__birth birth = {.x = at.x, .y = -at.y, .side = side, .source = front->mesh->vertex_count + seed};
    gd__wavefront_reach(front, gd__side_apex(front->mesh, side), front->seeds[seed].offset + sqrt(dx * dx + dy * dy),
                        birth);
}

static void seed_face(struct gd__wavefront *front, uint32_t seed)
{
    const struct gd_mesh *mesh = front->mesh;
    const struct gd_point *point = &front->seeds[seed].point;
    const uint32_t *sides = mesh->face_side[point->element];
    struct gd__local at[3];
    for (int k = 0; k < 3; k++) {
        at[k] = gd__side_local(&mesh->side[sides[k]], point->weight[(k + 1) % 3], point->weight[(k + 2) % 3]);
        seed_apex(front, seed, sides[k], at[k]);
    }
    for (int k = 0; k < 3; k++) seed_across(front, seed, sides[k], at[k]);
}

/* From a point of an edge into the face of one of its sides: the apex and the two other sides. */
static void seed_half_edge(struct gd__wavefront *front, uint32_t seed, uint32_t side, double t)
{
    const struct gd_mesh *mesh = front->mesh;
    if (gd__side_is_boundary(mesh, side)) return;
    seed_apex(front, seed, side, (struct gd__local){t, 0});
    double u = t / mesh->side[side].length; /* weights 1 - u, u, 0 of origin, destination, apex */
    uint32_t next = gd__side_next(mesh, side), previous = gd__side_previous(mesh, side);
    seed_across(front, seed, next, gd__side_local(&mesh->side[next], 0, 1 - u));
    seed_across(front, seed, previous, gd__side_local(&mesh->side[previous], 1 - u, u));
}

static void seed_edge(struct gd__wavefront *front, uint32_t seed)
{
    const struct gd_mesh *mesh = front->mesh;
    const struct gd_point *point = &front->seeds[seed].point;
    uint32_t side = 2 * point->element;
    double length = mesh->side[side].length, t = point->weight[0] * length, offset = front->seeds[seed].offset;
    struct gd__birth birth = {.side = GD_NONE, .source = mesh->vertex_count + seed};
    gd__wavefront_reach(front, mesh->origin[side], offset + t, birth);
    gd__wavefront_reach(front, mesh->origin[side ^ 1], offset + (length - t), birth);
    seed_half_edge(front, seed, side, t);
    seed_half_edge(front, seed, side ^ 1, length - t);
}

/* A seed at a vertex makes the vertex a pseudo-source, whatever its kind. */
static void seed_vertex(struct gd__wavefront *front, uint32_t seed)
{
    uint32_t vertex = front->seeds[seed].point.element;
    struct gd__birth birth = {.side = GD_NONE, .source = front->mesh->vertex_count + seed};
    gd__wavefront_reach(front, vertex, front->seeds[seed].offset, birth);
    if (front->birth[vertex].source == birth.source) gd__emit_vertex(front, vertex);
}

/* --- segments ------------------------------------------------------------------------------------------------------------ */

static uint32_t linear_source(const struct gd__wavefront *front, uint32_t seed)
{
    return GD__SOURCE_LINEAR | (front->mesh->vertex_count + seed);
}

/* A segment along an edge goes off to both of its sides. */
static void seed_along_edge(struct gd__wavefront *front, uint32_t seed, uint32_t edge)
{
    const struct gd__seed *s = &front->seeds[seed];
    const struct gd_mesh *mesh = front->mesh;
    double length = mesh->side[2 * edge].length, a = gd__edge_parameter(mesh, edge, &s->point),
           b = gd__edge_parameter(mesh, edge, &s->end);
    struct gd__window w = {.b0 = fmin(a, b), .b1 = fmax(a, b), .y = 1, .sigma = s->offset};
    w.source = linear_source(front, seed);
    struct gd__window mirrored = gd__window_mirrored(&w, length);
    if (!gd__side_is_boundary(mesh, 2 * edge)) seed_side(front, 2 * edge, &w);
    if (!gd__side_is_boundary(mesh, 2 * edge + 1)) seed_side(front, 2 * edge + 1, &mirrored);
}

/* Out of the segment's face across side k: the part of the edge that lies at right angles to the chord. */
static void seed_strip_across(struct gd__wavefront *front, uint32_t seed, uint32_t side, const struct gd__chord *chord)
{
    double length = front->mesh->side[side].length, away = fabs(chord->along.x);
    if (away <= GD_TOL_GRAZING) return;
    double slope = chord->along.y / chord->along.x, turned = chord->along.x < 0 ? -1 : 1;
    double ends[2];
    for (int i = 0; i < 2; i++) {
        double x = chord->from.x + i * chord->length * chord->along.x,
               y = chord->from.y + i * chord->length * chord->along.y;
        ends[i] = length - (x + y * slope);
    }
    struct gd__window w = {.b0 = fmax(fmin(ends[0], ends[1]), 0),
                           .b1 = fmin(fmax(ends[0], ends[1]), length),
                           .x = turned * chord->along.y,
                           .y = away,
                           .source = linear_source(front, seed)};
    w.sigma = front->seeds[seed].offset + away * (chord->from.y + (length - chord->from.x) * slope);
    if (w.b1 - w.b0 > GD_TOL_WIDTH * length) seed_side(front, side ^ 1, &w);
}

/* A segment's end is a seed of its own: up to rounding the segment is as near, and must not come before it. */
static bool is_end(const struct gd__wavefront *front, uint32_t seed, uint32_t vertex)
{
    const struct gd_point *ends[2] = {&front->seeds[seed].point, &front->seeds[seed].end};
    for (int i = 0; i < 2; i++)
        if (ends[i]->kind == GD_POINT_VERTEX && ends[i]->element == vertex) return true;
    return false;
}

/* Straight to the apex of `side`, where its perpendicular meets the chord. */
static void seed_apex_from_chord(struct gd__wavefront *front, uint32_t seed, uint32_t side,
                                 const struct gd__chord *chord)
{
    const struct gd_side *s = &front->mesh->side[side];
    struct gd__local apex = {s->left_length * s->left_x, s->left_length * s->left_y};
    double foot = gd__chord_foot(chord, apex), height = gd__chord_height(chord, apex), left = height > 0 ? 1 : -1;
    if (!(foot > 0 && foot < chord->length) || height == 0 || is_end(front, seed, gd__side_apex(front->mesh, side)))
        return;
    struct gd__birth birth = {
        .x = left * chord->along.y, .y = left * chord->along.x, .side = side, .source = linear_source(front, seed)};
    gd__wavefront_reach(front, gd__side_apex(front->mesh, side), front->seeds[seed].offset + fabs(height), birth);
}

static void seed_segment(struct gd__wavefront *front, uint32_t seed)
{
    const struct gd__seed *s = &front->seeds[seed];
    struct gd__home home;
    if (!gd__segment_home(front->mesh, &s->point, &s->end, &home)) {
        front->status = GD_INVALID_ARGUMENT;
        return;
    }
    if (home.edge != GD_NONE) {
        seed_along_edge(front, seed, home.edge);
        return;
    }
    struct gd__chord chord[3];
    const uint32_t *side = front->mesh->face_side[home.face];
    for (int k = 0; k < 3; k++) chord[k] = gd__chord(front->mesh, home.face, k, &s->point, &s->end);
    for (int k = 0; k < 3; k++) seed_apex_from_chord(front, seed, side[k], &chord[k]);
    for (int k = 0; k < 3; k++) seed_strip_across(front, seed, side[k], &chord[k]);
}

void gd__emit_seeds(struct gd__wavefront *front)
{
    for (uint32_t i = 0; i < front->seed_count && !front->status; i++) {
        if (front->seeds[i].is_segment) {
            seed_segment(front, i);
            continue;
        }
        if (front->domain) front->domain->is_common = front->seeds[i].point.kind != GD_POINT_VERTEX;
        switch (front->seeds[i].point.kind) {
        case GD_POINT_VERTEX:
            seed_vertex(front, i);
            break;
        case GD_POINT_EDGE:
            seed_edge(front, i);
            break;
        case GD_POINT_FACE:
            seed_face(front, i);
            break;
        }
    }
    if (front->domain) front->domain->is_common = false;
}
