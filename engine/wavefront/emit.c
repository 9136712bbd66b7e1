#include "wavefront/wavefront.h"

/* Emission from a vertex, or from a seed beside a vertex, into the vertex' fan. A seed at a vertex
 * emits into the whole fan. A saddle or boundary vertex emits only into its shadow cone: the
 * directions at an angle of at least pi from the incoming ray on both sides. A path that bends at
 * the vertex is locally shortest only in these directions. A seed beside a vertex emits windows
 * that pass the vertex on both sides. Two rays from the vertex limit these windows. */

/* The emitter: a vertex, or a seed beside it. */
struct emitter {
    uint32_t source;
    double sigma;
};

/* A part of the face of a fan entry. It lies between two angles at the vertex, which are measured
 * from the entry's side. `opening` is the angle of the whole face. */
struct sector {
    double from, to, opening;
};

/* --- vertices --------------------------------------------------------------------------------- */

/* Returns true if `source` is a seed beside the vertex. Sets `out` to the seed's polar coordinates
 * about the vertex. */
static bool is_beside(const struct gd__wavefront *front, uint32_t vertex, uint32_t source,
                      struct gd__polar *out)
{
    if (source < front->mesh->vertex_count || source == GD_NONE || gd__source_is_linear(source))
        return false;
    const struct gd__seed *seed = &front->seeds[source - front->mesh->vertex_count];
    return gd__polar_beside(front->mesh, &seed->point, out) && out->vertex == vertex;
}

/* Returns the angle, in the fan of `vertex`, of the ray from the vertex back along the last leg of
 * its shortest path. */
static double incoming_angle(const struct gd__wavefront *front, uint32_t vertex)
{
    const struct gd_mesh *mesh = front->mesh;
    struct gd__predecessor predecessor = *gd__wavefront_predecessor(front, vertex);
    struct gd__polar beside;
    if (is_beside(front, vertex, predecessor.source, &beside)) return beside.angle;
    /* The ray lies between the directions p -> origin and p -> destination, where p is the vertex,
     * and origin and destination are the ends of the side opposite to p. */
    if (predecessor.side != GD_NONE) {
        const struct gd_side *s = &mesh->side[predecessor.side];
        double px = s->left_length * s->left_x, py = s->left_length * s->left_y;
        double rx = predecessor.x - px, ry = -predecessor.y - py, ox = -px, oy = -py;
        if (predecessor.source != GD_NONE && gd__source_is_linear(predecessor.source))
            rx = predecessor.x, ry = -predecessor.y;
        uint32_t entry = mesh->fan_first[vertex], first = gd__side_previous(mesh, predecessor.side);
        while (mesh->fan[entry].side != first) entry++;
        return mesh->fan[entry].angle + atan2(ox * ry - oy * rx, ox * rx + oy * ry);
    }
    uint32_t edge = GD_NONE;
    if (predecessor.source >= mesh->vertex_count)
        edge = front->seeds[predecessor.source - mesh->vertex_count].point.element;
    for (uint32_t i = mesh->fan_first[vertex]; i < mesh->fan_first[vertex + 1]; i++) {
        uint32_t side = mesh->fan[i].side;
        if (edge != GD_NONE ? side >> 1 == edge : mesh->fan[i].tip == predecessor.source)
            return mesh->fan[i].angle;
    }
    return mesh->total_angle[vertex]; /* the last boundary edge of the fan */
}

static void reach_along_edge(struct gd__wavefront *front, uint32_t from, uint32_t to, double length)
{
    struct gd__predecessor predecessor = {.side = GD_NONE, .source = from};
    gd__wavefront_reach(front, to, front->distance[from] + length, predecessor);
}

/* Returns the point where the ray from the vertex at this angle meets the opposite edge of the
 * entry's face, as a distance from the apex. */
static double place_of_ray(const struct gd_side *s, double angle)
{
    double py = s->left_length * s->left_y, ax = s->left_length * s->left_x - s->length;
    return s->right_length * (1 - sin(angle) * s->length / (cos(angle) * py - sin(angle) * ax));
}

/* Casts a window through a sector of an entry's face to the edge opposite to the vertex. The
 * emitter lies at `at` in the frame of the entry's side. The side that receives the window runs in
 * the opposite direction to the face's side on this edge. */
static void emit_through_face(struct gd__wavefront *front, const struct emitter *emitter,
                              const struct gd_fan *fan, struct sector sector, struct gd__local at)
{
    const struct gd_side *s = &front->mesh->side[fan->side];
    double length = s->right_length, px = s->left_length * s->left_x,
           py = s->left_length * s->left_y;
    double b0 = 0, b1 = length;
    double x = -(px * s->right_x + py * s->right_y) + (at.x * s->right_x + at.y * s->right_y),
           /* height = twice the area / length of the edge; this avoids cancellation */
        y = py * s->length / length + (at.x * s->right_y - at.y * s->right_x);
    if (gd__window_grazes(x, y, length)) return;
    /* If the vertex lies almost on the edge, the window covers the whole edge, because the ends of
     * a part would not determine the angle. */
    bool cap = y <= GD_TOL_CAP * length;
    if (sector.from > 0 && !cap) b1 = place_of_ray(s, sector.from);
    if (sector.to < sector.opening && !cap) b0 = place_of_ray(s, sector.to);
    if (b0 < 0) b0 = 0;
    if (b1 > length) b1 = length;
    if (b1 - b0 <= GD_TOL_WIDTH * length) return;
    struct gd__window window = {
        .b0 = b0, .b1 = b1, .x = x, .y = y, .sigma = emitter->sigma, .source = emitter->source};
    gd__wavefront_offer(front, s->right, length, &window);
}

/* Emits into the directions [from, to] of the fan, 0 <= from <= to. The fan of an interior vertex
 * is periodic: `to` may exceed the total angle. */
static void emit_cone(struct gd__wavefront *front, uint32_t vertex, double from, double to)
{
    const struct gd_mesh *mesh = front->mesh;
    uint32_t first = mesh->fan_first[vertex], end = mesh->fan_first[vertex + 1];
    double total = mesh->total_angle[vertex];
    bool interior = mesh->vertex_kind[vertex] != GD_VERTEX_BOUNDARY;
    const struct emitter emitter = {vertex, front->distance[vertex]};
    for (int lap = 0; lap < (interior ? 2 : 1); lap++) {
        double turn = lap * total;
        for (uint32_t i = first; i < end; i++) {
            double begin = mesh->fan[i].angle + turn,
                   stop = (i + 1 < end ? mesh->fan[i + 1].angle : total) + turn;
            if (stop < from - GD_TOL_CONE) continue;
            if (begin > to + GD_TOL_CONE) break;
            const struct gd_fan *fan = &mesh->fan[i];
            if (interior && begin >= from - GD_TOL_CONE)
                reach_along_edge(front, vertex, fan->tip, mesh->side[fan->side].length);
            if (stop <= from || begin >= to) continue;
            emit_through_face(front, &emitter, fan,
                              (struct sector){from - begin, to - begin, stop - begin},
                              (struct gd__local){0, 0});
        }
    }
}

/* Offers the distance of a boundary vertex along all of its edges. This is correct even for edges
 * outside the cone, because each edge is a path. */
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

/* Returns true if the vertex is a seed and no other seed is nearer to it. */
static bool is_seed_vertex(const struct gd__wavefront *front, uint32_t vertex)
{
    const struct gd__predecessor *predecessor = gd__wavefront_predecessor(front, vertex);
    uint32_t vertices = front->mesh->vertex_count;
    return predecessor->source >= vertices && predecessor->source != GD_NONE &&
           predecessor->side == GD_NONE &&
           front->seeds[predecessor->source - vertices].point.kind == GD_POINT_VERTEX;
}

void gd__emit_vertex(struct gd__wavefront *front, uint32_t vertex)
{
    const struct gd_mesh *mesh = front->mesh;
    double total = mesh->total_angle[vertex];
    *gd__wavefront_emitted(front, vertex) = front->distance[vertex];
    front->counts.vertices_emitted++;
    bool boundary = mesh->vertex_kind[vertex] == GD_VERTEX_BOUNDARY,
         is_seed = is_seed_vertex(front, vertex);
    if (boundary) reach_all_neighbours(front, vertex);
    if (is_seed || front->variant.no_cone) {
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

/* --- seeds beside a vertex -------------------------------------------------------------------- */

/* A seed beside a vertex, and the angles around the vertex into which it emits, in radians. At a
 * convex vertex, paths pass the vertex on both sides. They meet where they are equally long: at
 * half of the total angle from the seed. At other vertices, the cone ends at the angle pi on each
 * side, or at the boundary. */
struct beside {
    struct emitter emitter;
    struct gd__polar polar;
    double left, right; /* angles counter-clockwise and clockwise */
};

static struct beside beside_of(const struct gd__wavefront *front, uint32_t seed,
                               const struct gd__polar *polar)
{
    const struct gd_mesh *mesh = front->mesh;
    double total = mesh->total_angle[polar->vertex];
    struct beside b = {.emitter = {mesh->vertex_count + seed, front->seeds[seed].offset},
                       .polar = *polar,
                       .left = M_PI,
                       .right = M_PI};
    if (mesh->vertex_kind[polar->vertex] == GD_VERTEX_CONVEX) b.left = b.right = total / 2;
    if (mesh->vertex_kind[polar->vertex] == GD_VERTEX_BOUNDARY) {
        b.left = fmin(M_PI, total - polar->angle);
        b.right = fmin(M_PI, polar->angle);
    }
    return b;
}

/* Stores a wedge that covers a whole edge of the vertex. The seed sees the whole edge, and lies at
 * `at` in the frame of `side`, a side of the edge. The wedge is only for queries in the side's
 * face. Windows across this face are emitted directly, so the stored window is not propagated. */
static void store_edge(struct gd__wavefront *front, const struct beside *b, uint32_t side,
                       struct gd__local at)
{
    struct gd__window window = {.b1 = front->mesh->side[side].length,
                                .x = at.x,
                                .y = -at.y,
                                .sigma = b->emitter.sigma,
                                .source = b->emitter.source};
    if (window.y > 0) gd__store_window(front, side, &window);
}

/* Offers a neighbour of the vertex the straight path from the seed. `way` is the vector of this
 * path. The path starts at `at` in the frame of `side`, the side opposite to the neighbour. */
static void reach_neighbour(struct gd__wavefront *front, const struct beside *b, uint32_t side,
                            struct gd__local at, struct gd__local way)
{
    struct gd__predecessor predecessor = {
        .x = at.x, .y = -at.y, .side = side, .source = b->emitter.source};
    gd__wavefront_reach(front, gd__side_apex(front->mesh, side),
                        b->emitter.sigma + sqrt(way.x * way.x + way.y * way.y), predecessor);
}

/* Emits into the face of the fan entry that begins `ahead` radians counter-clockwise of the
 * seed. */
static void emit_to_left(struct gd__wavefront *front, const struct beside *b, uint32_t entry,
                         double ahead, double opening)
{
    const struct gd_fan *fan = &front->mesh->fan[entry];
    const struct gd_side *s = &front->mesh->side[fan->side];
    struct gd__local at = gd__polar_place(&b->polar, -ahead);
    struct gd__local way = {s->left_length * s->left_x - at.x, s->left_length * s->left_y - at.y};
    store_edge(front, b, fan->side, at);
    emit_through_face(front, &b->emitter, fan,
                      (struct sector){0, fmin(b->left - ahead, opening), opening}, at);
    if (ahead + opening <= b->left + GD_TOL_CONE) reach_neighbour(front, b, fan->side, at, way);
}

/* Emits into the face of the fan entry that ends `ahead` radians clockwise of the seed. */
static void emit_to_right(struct gd__wavefront *front, const struct beside *b, uint32_t entry,
                          double ahead, double opening)
{
    const struct gd_fan *fan = &front->mesh->fan[entry];
    const struct gd_side *s = &front->mesh->side[fan->side];
    uint32_t last = gd__side_previous(front->mesh, fan->side);
    struct gd__local at = gd__polar_place(&b->polar, opening + ahead),
                     turned = gd__polar_place(&b->polar, -ahead);
    turned.x = s->left_length - turned.x; /* now in the frame of the face's last side */
    store_edge(front, b, last, turned);
    emit_through_face(front, &b->emitter, fan,
                      (struct sector){fmax(0, opening - (b->right - ahead)), opening, opening}, at);
    if (ahead + opening <= b->right + GD_TOL_CONE)
        reach_neighbour(front, b, last, turned, (struct gd__local){s->length - at.x, at.y});
}

void gd__emit_beside(struct gd__wavefront *front, uint32_t seed, const struct gd__polar *polar)
{
    const struct gd_mesh *mesh = front->mesh;
    const struct beside b = beside_of(front, seed, polar);
    uint32_t first = mesh->fan_first[polar->vertex], end = mesh->fan_first[polar->vertex + 1];
    bool is_closed = mesh->vertex_kind[polar->vertex] != GD_VERTEX_BOUNDARY;
    double left = gd__fan_end(mesh, polar->vertex, polar->entry) - polar->angle,
           right = polar->angle - mesh->fan[polar->entry].angle;
    for (uint32_t i = polar->entry; left < b.left;) {
        i = i + 1 < end || !is_closed ? i + 1 : first;
        if (i == end) break;
        double opening = gd__fan_end(mesh, polar->vertex, i) - mesh->fan[i].angle;
        emit_to_left(front, &b, i, left, opening);
        left += opening;
    }
    for (uint32_t i = polar->entry; right < b.right;) {
        if (i == first && !is_closed) break;
        i = i > first ? i - 1 : end - 1;
        double opening = gd__fan_end(mesh, polar->vertex, i) - mesh->fan[i].angle;
        /* If `right` is 0, the seed lies on an edge of the entry's face, and seeds.c emits into
         * this face. */
        if (right > 0) emit_to_right(front, &b, i, right, opening);
        right += opening;
    }
}
