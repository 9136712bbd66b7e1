#include "base/prefetch.h"
#include "wavefront/polyline_vertex.h"

/* Seeds: what a source sees at once. A point sees its face (or the two faces of its edge, or the
 * fan of its vertex); a segment what lies before and behind it at right angles; a joint, where
 * segments of a curve end, only what lies behind them. */

#define ARRAYS       6 /* of struct gd__windows */
#define BLOCKS_AHEAD 2
#define EDGES_AHEAD  12 /* seeds: see prefetch_seeds */
#define FACES_AHEAD  6

/* --- points ----------------------------------------------------------------------------------- */

/* Most windows begin a list, in a block of the pool that nobody has seen for long: asks for the
 * lines that one some windows on will fill. */
GD__ASKING prefetch_block(const struct gd__pool *pool)
{
    /* of a block for one window: two groups */
    const size_t array = 2 * GD__WINDOWS_GROUP * sizeof(double);
    /* perhaps beyond the chunk */
    uintptr_t block = (uintptr_t)pool->cursor + 2 * BLOCKS_AHEAD * GD__LIST_POOL_ITEM;
    for (size_t i = 0; i < ARRAYS; i++) __builtin_prefetch((const void *)(block + i * array), 1);
}

/* Offers a side a seed's window. */
static inline __attribute__((always_inline)) void
seed_side(struct gd__wavefront *front, uint32_t side, const struct gd__window *window)
{
    prefetch_block(&front->work->pool);
    gd__wavefront_offer(front, side, window);
}

/* Sends the seed's window out of its face across a part of `side` (a side of that face). A seed
 * that lies almost on the side sees all of it, as the ends of a part would not tell the angle. */
static void seed_across(struct gd__wavefront *front, uint32_t seed, uint32_t side,
                        struct gd__local at, struct gd__part part)
{
    double length = front->mesh->side[side].length;
    if (at.y <= GD_TOL_CAP * length) part = (struct gd__part){0, 1};
    if (part.to - part.from <= GD_TOL_WIDTH || gd__window_grazes(length - at.x, at.y, length))
        return;
    struct gd__window window = {.b0 = part.to < 1 ? length * (1 - part.to) : 0,
                                .b1 = part.from > 0 ? length * (1 - part.from) : length,
                                .x = length - at.x,
                                .y = at.y,
                                .sigma = front->seeds[seed].offset,
                                .source = front->mesh->vertex_count + seed};
    seed_side(front, side ^ 1, &window);
}

/* From a place in the frame of `side` to the apex. */
static struct gd__local to_apex(const struct gd_side *s, struct gd__local at)
{
    return (struct gd__local){s->left_length * s->left_x - at.x, s->left_length * s->left_y - at.y};
}

/* From a point of a face to the apex of `side`, by the weights of the side's ends: exact to its
 * last digits however near the apex is. */
static struct gd__local to_apex_of_face(const struct gd_side *s, double origin, double destination)
{
    double px = s->left_length * s->left_x, py = s->left_length * s->left_y;
    return (struct gd__local){origin * px + destination * (px - s->length),
                              (origin + destination) * py};
}

/* Straight to the apex of `side`, a side of the seed's face, unless a segment is nearer. */
static void seed_apex(struct gd__wavefront *front, uint32_t seed, uint32_t side,
                      struct gd__local at, struct gd__local way, const struct gd__spread *spread)
{
    if (gd__is_ahead(spread, way)) return;
    struct gd__predecessor predecessor = {
        .x = at.x, .y = -at.y, .side = side, .source = front->mesh->vertex_count + seed};
    gd__wavefront_reach(front, gd__side_apex(front->mesh, side),
                        front->seeds[seed].offset + sqrt(way.x * way.x + way.y * way.y),
                        predecessor);
}

/* No segment ends at the seed. */
static bool is_apart(const struct gd__joint *joint)
{
    return !joint->segment[0] && !joint->segment[1];
}

static void seed_face(struct gd__wavefront *front, struct gd__laying *laying, uint32_t seed)
{
    const struct gd_mesh *mesh = front->mesh;
    const struct gd_point *point = &front->seeds[seed].point;
    const uint32_t *sides = mesh->face_side[point->element];
    const struct gd__joint joint = gd__joint_of(front, laying, seed);
    struct gd__local at[3];
    struct gd__spread spread[3];
    for (int k = 0; k < 3; k++) {
        at[k] = gd__side_local(&mesh->side[sides[k]], point->weight[(k + 1) % 3],
                               point->weight[(k + 2) % 3]);
        spread[k] = gd__spread_in_face(&joint, k);
    }
    if (gd__is_straight(&spread[0])) return; /* its segments see the corners beside it, too */
    struct gd__polar polar;
    bool is_beside = is_apart(&joint) && gd__polar_beside(mesh, point, &polar);
    for (int k = 0; k < 3; k++) {
        const struct gd_side *s = &mesh->side[sides[k]];
        struct gd__local way =
            is_beside ? to_apex_of_face(s, point->weight[k], point->weight[(k + 1) % 3])
                      /* rounded as its segments' ways are */
                      : to_apex(s, at[k]);
        seed_apex(front, seed, sides[k], at[k], way, &spread[k]);
    }
    for (int k = 0; k < 3; k++) {
        if (is_beside && gd__side_apex(mesh, sides[k]) != polar.vertex) continue;
        struct gd__local origin = {-at[k].x, -at[k].y},
                         destination = {mesh->side[sides[k]].length - at[k].x, -at[k].y};
        seed_across(front, seed, sides[k], at[k], gd__part_behind(&spread[k], origin, destination));
    }
    if (is_beside) gd__emit_beside(front, seed, &polar);
}

/* From a point of an edge across the two other sides of the face of one of its sides, but for those
 * that end in `vertex`, which may be GD_NONE. */
static void seed_half_edge(struct gd__wavefront *front, uint32_t seed, uint32_t side, double t,
                           uint32_t vertex, const struct gd__spread *spread)
{
    const struct gd_mesh *mesh = front->mesh;
    if (gd__side_is_boundary(mesh, side)) return;
    const struct gd_side *s = &mesh->side[side];
    struct gd__local origin = {-t, 0}, destination = {s->length - t, 0},
                     apex = to_apex(s, (struct gd__local){t, 0});
    double u = t / s->length; /* weights 1 - u, u, 0 of origin, destination, apex */
    uint32_t next = gd__side_next(mesh, side), previous = gd__side_previous(mesh, side);
    if (mesh->origin[next] != vertex)
        seed_across(front, seed, next, gd__side_local(&mesh->side[next], 0, 1 - u),
                    gd__part_behind(spread, destination, apex));
    if (mesh->origin[side] != vertex)
        seed_across(front, seed, previous, gd__side_local(&mesh->side[previous], 1 - u, u),
                    gd__part_behind(spread, apex, origin));
}

/* From a point of an edge to the corners of the face of one of its sides, but for the side's
 * destination. */
static void seed_corners(struct gd__wavefront *front, uint32_t seed, uint32_t side, double t,
                         const struct gd__spread *spread)
{
    struct gd__predecessor predecessor = {.side = GD_NONE,
                                          .source = front->mesh->vertex_count + seed};
    if (!gd__is_ahead(spread, (struct gd__local){-t, 0}))
        gd__wavefront_reach(front, front->mesh->origin[side], front->seeds[seed].offset + t,
                            predecessor);
    if (gd__side_is_boundary(front->mesh, side)) return;
    const struct gd__local at = {t, 0};
    seed_apex(front, seed, side, at, to_apex(&front->mesh->side[side], at), spread);
}

static void seed_edge(struct gd__wavefront *front, struct gd__laying *laying, uint32_t seed)
{
    const struct gd_point *point = &front->seeds[seed].point;
    uint32_t side = 2 * point->element;
    double length = front->mesh->side[side].length, t = point->weight[0] * length;
    const struct gd__joint joint = gd__joint_of(front, laying, seed);
    const struct gd__spread spread = gd__spread_from_edge(front->mesh, &joint, side);
    if (gd__is_straight(&spread)) return; /* as in a face */
    const struct gd__spread other = gd__spread_from_other_side(spread);
    struct gd__polar polar = {.vertex = GD_NONE};
    bool is_beside = is_apart(&joint) && gd__polar_beside(front->mesh, point, &polar);
    /* rounded as its segments' ends are */
    double rest = is_beside ? gd__edge_rest(point) * length : length - t;
    seed_corners(front, seed, side, t, &spread);
    seed_corners(front, seed, side ^ 1, rest, &other);
    seed_half_edge(front, seed, side, t, polar.vertex, &spread);
    seed_half_edge(front, seed, side ^ 1, rest, polar.vertex, &other);
    if (is_beside) gd__emit_beside(front, seed, &polar);
}

static void reach_vertex(struct gd__wavefront *front, uint32_t seed)
{
    struct gd__predecessor predecessor = {.side = GD_NONE,
                                          .source = front->mesh->vertex_count + seed};
    gd__wavefront_reach(front, front->seeds[seed].point.element, front->seeds[seed].offset,
                        predecessor);
}

/* A seed at a vertex makes the vertex a pseudo-source, whatever its kind, unless another is
 * nearer. */
static void seed_vertex(struct gd__wavefront *front, uint32_t seed)
{
    uint32_t vertex = front->seeds[seed].point.element;
    if (front->distance[vertex] < GD__FAR &&
        gd__wavefront_predecessor(front, vertex)->source == front->mesh->vertex_count + seed)
        gd__emit_vertex(front, vertex);
}

/* --- segments --------------------------------------------------------------------------------- */

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
    struct gd__window w = {.b0 = a < b ? a : b, .b1 = a < b ? b : a, .y = 1, .sigma = s->offset};
    w.source = linear_source(front, seed);
    struct gd__window mirrored = gd__window_mirrored(&w, length);
    if (!gd__side_is_boundary(mesh, 2 * edge)) seed_side(front, 2 * edge, &w);
    if (!gd__side_is_boundary(mesh, 2 * edge + 1)) seed_side(front, 2 * edge + 1, &mirrored);
}

/* Out of the segment's face across a side of it: the part of the edge that lies at right angles to
 * the chord. */
static void seed_strip_across(struct gd__wavefront *front, uint32_t seed, uint32_t side,
                              const struct gd__chord *chord)
{
    double length = front->mesh->side[side].length, away = fabs(chord->along.x);
    if (away <= GD_TOL_GRAZING) return;
    double inverse = 1 / chord->along.x, slope = chord->along.y * inverse,
           turned = copysign(1, chord->along.x);
    double from = length - (chord->from.x + chord->from.y * slope),
           to = length - (chord->to.x + chord->to.y * slope), b0 = from < to ? from : to,
           b1 = from < to ? to : from;
    struct gd__window w = {.b0 = b0 > 0 ? b0 : 0,
                           .b1 = b1 < length ? b1 : length,
                           .x = turned * chord->along.y,
                           .y = away,
                           .source = linear_source(front, seed)};
    w.sigma = front->seeds[seed].offset + away * (chord->from.y + (length - chord->from.x) * slope);
    if (w.b1 - w.b0 > GD_TOL_WIDTH * length) seed_side(front, side ^ 1, &w);
}

/* A segment's end is a seed of its own: up to rounding the segment is as near, and must not come
 * before it. */
static bool is_end(const struct gd__wavefront *front, uint32_t seed, uint32_t vertex)
{
    const struct gd_point *ends[2] = {&front->seeds[seed].point, &front->seeds[seed].end};
    for (int i = 0; i < 2; i++)
        if (ends[i]->kind == GD_POINT_VERTEX && ends[i]->element == vertex) return true;
    return false;
}

/* Straight to the apex of `side`, where its perpendicular meets the chord, be it by rounding: at
 * the end of a segment that goes on straight. */
static void seed_apex_from_chord(struct gd__wavefront *front, uint32_t seed, uint32_t side,
                                 const struct gd__chord *chord)
{
    const struct gd_side *s = &front->mesh->side[side];
    struct gd__local apex = {s->left_length * s->left_x, s->left_length * s->left_y};
    double foot = gd__chord_foot(chord, apex), height = gd__chord_height(chord, apex),
           left = copysign(1, height);
    double beside =
        GD_TOL_ONWARD * fabs(height) + GD_TOL_ONWARD_ROUNDING * (s->length + s->left_length);
    bool is_seen = (foot > -beside) & (foot < chord->length + beside) & (height != 0);
    if (!is_seen || is_end(front, seed, gd__side_apex(front->mesh, side))) return;
    struct gd__predecessor predecessor = {.x = left * chord->along.y,
                                          .y = left * chord->along.x,
                                          .side = side,
                                          .source = linear_source(front, seed)};
    gd__wavefront_reach(front, gd__side_apex(front->mesh, side),
                        front->seeds[seed].offset + fabs(height), predecessor);
}

static void seed_segment(struct gd__wavefront *front, struct gd__laying *laying, uint32_t seed)
{
    const struct gd__laid *laid = gd__lay(front, laying, seed);
    if (laid->face == GD_NONE) {
        seed_along_edge(front, seed, laid->edge);
        return;
    }
    const uint32_t *side = front->mesh->face_side[laid->face];
    for (int k = 0; k < 3; k++) {
        seed_apex_from_chord(front, seed, side[k], &laid->chord[k]);
        seed_strip_across(front, seed, side[k], &laid->chord[k]);
    }
}

/* --- all -------------------------------------------------------------------------------------- */

/* Side 0 of the edge that a seed lies on, or begins on; GD_NONE: that is none such. */
static uint32_t side_of_seed(const struct gd__wavefront *front, uint32_t seed)
{
    if (seed >= front->seed_count || front->seeds[seed].point.kind != GD_POINT_EDGE) return GD_NONE;
    return 2 * front->seeds[seed].point.element;
}

/* Asks for what windows on their way out across `side`, or the face before it, take. */
GD__ASKING prefetch_way_out(const struct gd__wavefront *front, uint32_t side)
{
    __builtin_prefetch(&front->mesh->side[side ^ 1]);
    __builtin_prefetch(&front->mesh->origin[side]);
    if (!front->near) __builtin_prefetch(&front->lists[side]);
}

/* Asks for the edge of a joint ahead, and then for the two faces there. */
GD__ASKING prefetch_seeds(const struct gd__wavefront *front, uint32_t seed)
{
    const struct gd_mesh *mesh = front->mesh;
    uint32_t far = side_of_seed(front, seed + EDGES_AHEAD),
             near = side_of_seed(front, seed + FACES_AHEAD);
    if (far != GD_NONE) {
        __builtin_prefetch(&mesh->side[far]);
        __builtin_prefetch(&mesh->side_face[far]);
        prefetch_way_out(front, far);
    }
    for (int k = 0; k < 2 && near != GD_NONE; k++, near ^= 1) {
        if (gd__side_is_boundary(mesh, near)) continue;
        prefetch_way_out(front, mesh->side[near].left);
        prefetch_way_out(front, mesh->side[near].right);
        __builtin_prefetch(&mesh->face_side[mesh->side_face[near]]);
    }
}

/* Makes ready what a joint, and the segment behind it, will take in a while. */
static inline void look_ahead(const struct gd__wavefront *front, struct gd__laying *laying,
                              uint32_t joint)
{
    uint32_t segment = joint + 1 + 2 * GD__LAID_AHEAD;
    prefetch_seeds(front, joint);
    if (segment < front->seed_count && front->seeds[segment].is_segment)
        gd__lay(front, laying, segment);
}

static void emit_seed(struct gd__wavefront *front, struct gd__laying *laying, uint32_t seed)
{
    if (front->seeds[seed].is_segment) {
        seed_segment(front, laying, seed);
        return;
    }
    if (front->partition) front->partition->is_common = true;
    if (front->seeds[seed].point.kind == GD_POINT_EDGE)
        seed_edge(front, laying, seed);
    else
        seed_face(front, laying, seed);
    if (front->partition) front->partition->is_common = false;
}

static bool is_at_vertex(const struct gd__seed *seed)
{
    return !seed->is_segment && seed->point.kind == GD_POINT_VERTEX;
}

/* Vertices emit last, once the nearest of their seeds is known: windows that a vertex has cast with
 * a distance that then falls are dropped, be they all that ties have left. */
void gd__emit_seeds(struct gd__wavefront *front)
{
    struct gd__laying laying;
    gd__laying_begin(&laying);
    for (uint32_t i = 0; i < front->seed_count && !front->status; i++)
        if (is_at_vertex(&front->seeds[i])) reach_vertex(front, i);
    for (uint32_t i = 0; i < front->seed_count && !front->status; i++) {
        if (!front->seeds[i].is_segment) look_ahead(front, &laying, i);
        if (!is_at_vertex(&front->seeds[i])) emit_seed(front, &laying, i);
    }
    for (uint32_t i = 0; i < front->seed_count && !front->status; i++)
        if (is_at_vertex(&front->seeds[i])) seed_vertex(front, i);
}
