#include "base/prefetch.h"
#include "wavefront/polyline_vertex.h"

/* Seeds: the first windows of each source. A point emits into its face (or the two faces of its
 * edge, or the fan of its vertex). A segment emits to both sides at right angles. A joint is a
 * point where segments of a curve end. It emits only into directions at an angle of 90 degrees or
 * more to each of these segments. In other directions, a point of a segment is nearer. */

#define ARRAYS       6 /* number of arrays in struct gd__windows */
#define BLOCKS_AHEAD 2
#define EDGES_AHEAD  12 /* number of seeds ahead, see prefetch_seeds */
#define FACES_AHEAD  6

/* --- points ----------------------------------------------------------------------------------- */

/* Prefetches the cache lines to which a later window will be written. Most windows are the first of
 * their list, and their block of the pool is not in the cache. */
GD__PREFETCH prefetch_block(const struct gd__pool *pool)
{
    /* bytes of an array in a block for one window: two groups */
    const size_t array = 2 * GD__WINDOWS_GROUP * sizeof(double);
    /* the address may be beyond the end of the chunk; prefetching it is harmless */
    uintptr_t block = (uintptr_t)pool->cursor + 2 * BLOCKS_AHEAD * GD__LIST_POOL_ITEM;
    for (size_t i = 0; i < ARRAYS; i++) __builtin_prefetch((const void *)(block + i * array), 1);
}

/* Offers a side the window of a seed. */
static inline __attribute__((always_inline)) void
seed_side(struct gd__wavefront *front, uint32_t side, const struct gd__window *window)
{
    prefetch_block(&front->work->pool);
    gd__wavefront_offer(front, side, front->mesh->side[side].length, window);
}

/* Emits a window from a seed through a part of `side`, a side of the seed's face. If the seed lies
 * almost on the side, the window covers the whole side, because the ends of a part would not
 * determine the angle. */
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

/* Returns the vector from a point in the frame of `side` to the apex. */
static struct gd__local to_apex(const struct gd_side *s, struct gd__local at)
{
    return (struct gd__local){s->left_length * s->left_x - at.x, s->left_length * s->left_y - at.y};
}

/* Returns the vector from a point of a face to the apex of `side`, computed from the weights of the
 * side's ends. The vector has full precision, no matter how near the point is to the apex. */
static struct gd__local to_apex_of_face(const struct gd_side *s, double origin, double destination)
{
    double px = s->left_length * s->left_x, py = s->left_length * s->left_y;
    return (struct gd__local){origin * px + destination * (px - s->length),
                              (origin + destination) * py};
}

/* Offers the straight path from the seed to the apex of `side`, a side of the seed's face, unless a
 * segment is nearer to the apex. */
static void seed_apex(struct gd__wavefront *front, uint32_t seed, uint32_t side,
                      struct gd__local at, struct gd__local way,
                      const struct gd__segment_directions *directions)
{
    if (gd__is_ahead(directions, way)) return;
    struct gd__predecessor predecessor = {
        .x = at.x, .y = -at.y, .side = side, .source = front->mesh->vertex_count + seed};
    gd__wavefront_reach(front, gd__side_apex(front->mesh, side),
                        front->seeds[seed].offset + sqrt(way.x * way.x + way.y * way.y),
                        predecessor);
}

/* Returns true if no segment ends at the seed. */
static bool is_apart(const struct gd__joint *joint)
{
    return !joint->segment[0] && !joint->segment[1];
}

static void seed_face(struct gd__wavefront *front, struct gd__segment_cache *cache, uint32_t seed)
{
    const struct gd_mesh *mesh = front->mesh;
    const struct gd_point *point = &front->seeds[seed].point;
    const uint32_t *sides = mesh->face_side[point->element];
    const struct gd__joint joint = gd__joint_of(front, cache, seed);
    struct gd__local at[3];
    struct gd__segment_directions directions[3];
    for (int k = 0; k < 3; k++) {
        at[k] = gd__side_local(&mesh->side[sides[k]], point->weight[(k + 1) % 3],
                               point->weight[(k + 2) % 3]);
        directions[k] = gd__directions_in_face(&joint, k);
    }
    /* if the joint is straight, its segments offer the corners their distances */
    if (gd__is_straight(&directions[0])) return;
    struct gd__polar polar;
    bool is_beside = is_apart(&joint) && gd__polar_beside(mesh, point, &polar);
    for (int k = 0; k < 3; k++) {
        const struct gd_side *s = &mesh->side[sides[k]];
        struct gd__local way =
            is_apart(&joint)
                ? to_apex_of_face(s, point->weight[k], point->weight[(k + 1) % 3])
                /* this is rounded in the same way as the paths from the joint's segments */
                : to_apex(s, at[k]);
        seed_apex(front, seed, sides[k], at[k], way, &directions[k]);
    }
    for (int k = 0; k < 3; k++) {
        if (is_beside && gd__side_apex(mesh, sides[k]) != polar.vertex) continue;
        struct gd__local origin = {-at[k].x, -at[k].y},
                         destination = {mesh->side[sides[k]].length - at[k].x, -at[k].y};
        seed_across(front, seed, sides[k], at[k],
                    gd__part_behind(&directions[k], origin, destination));
    }
    if (is_beside) gd__emit_beside(front, seed, &polar);
}

/* Emits from a point of an edge into the face of `side`, a side of this edge, through the face's
 * other two sides. Skips a side that ends at `vertex`, which may be GD_NONE. */
static void seed_half_edge(struct gd__wavefront *front, uint32_t seed, uint32_t side, double t,
                           uint32_t vertex, const struct gd__segment_directions *directions)
{
    const struct gd_mesh *mesh = front->mesh;
    if (gd__side_is_boundary(mesh, side)) return;
    const struct gd_side *s = &mesh->side[side];
    struct gd__local origin = {-t, 0}, destination = {s->length - t, 0},
                     apex = to_apex(s, (struct gd__local){t, 0});
    /* the barycentric weights of origin, destination and apex are 1 - u, u, 0 */
    double u = t / s->length;
    uint32_t next = gd__side_next(mesh, side), previous = gd__side_previous(mesh, side);
    if (mesh->origin[next] != vertex)
        seed_across(front, seed, next, gd__side_local(&mesh->side[next], 0, 1 - u),
                    gd__part_behind(directions, destination, apex));
    if (mesh->origin[side] != vertex)
        seed_across(front, seed, previous, gd__side_local(&mesh->side[previous], 1 - u, u),
                    gd__part_behind(directions, apex, origin));
}

/* Offers the straight paths from a point of an edge to two corners of the face of `side`: all
 * except the side's destination. */
static void seed_corners(struct gd__wavefront *front, uint32_t seed, uint32_t side, double t,
                         const struct gd__segment_directions *directions)
{
    struct gd__predecessor predecessor = {.side = GD_NONE,
                                          .source = front->mesh->vertex_count + seed};
    if (!gd__is_ahead(directions, (struct gd__local){-t, 0}))
        gd__wavefront_reach(front, front->mesh->origin[side], front->seeds[seed].offset + t,
                            predecessor);
    if (gd__side_is_boundary(front->mesh, side)) return;
    const struct gd__local at = {t, 0};
    seed_apex(front, seed, side, at, to_apex(&front->mesh->side[side], at), directions);
}

static void seed_edge(struct gd__wavefront *front, struct gd__segment_cache *cache, uint32_t seed)
{
    const struct gd_point *point = &front->seeds[seed].point;
    uint32_t side = 2 * point->element;
    double length = front->mesh->side[side].length, t = point->weight[0] * length;
    const struct gd__joint joint = gd__joint_of(front, cache, seed);
    const struct gd__segment_directions directions =
        gd__directions_from_edge(front->mesh, &joint, side);
    /* if the joint is straight, its segments offer the corners their distances */
    if (gd__is_straight(&directions)) return;
    const struct gd__segment_directions other = gd__directions_from_other_side(directions);
    struct gd__polar polar = {.vertex = GD_NONE};
    bool is_beside = is_apart(&joint) && gd__polar_beside(front->mesh, point, &polar);
    /* length - t is rounded in the same way as the ends of the joint's segments */
    double rest = is_apart(&joint) ? gd__edge_rest(point) * length : length - t;
    seed_corners(front, seed, side, t, &directions);
    seed_corners(front, seed, side ^ 1, rest, &other);
    seed_half_edge(front, seed, side, t, polar.vertex, &directions);
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

/* The vertex of a seed becomes a pseudo-source, even if it is a convex vertex, unless another seed
 * is nearer. */
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

/* Emits from a segment along an edge to both sides of the edge. */
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

/* Emits from a segment across a side of its face, at right angles to the chord. The window covers
 * the part of the side that the perpendiculars to the chord reach. */
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

/* Returns true if the vertex is an end of the segment. The end is a separate seed. Up to rounding,
 * the segment is equally near to the vertex, but must not replace this seed. */
static bool is_end(const struct gd__wavefront *front, uint32_t seed, uint32_t vertex)
{
    const struct gd_point *ends[2] = {&front->seeds[seed].point, &front->seeds[seed].end};
    for (int i = 0; i < 2; i++)
        if (ends[i]->kind == GD_POINT_VERTEX && ends[i]->element == vertex) return true;
    return false;
}

/* Offers the apex of `side` the straight path at right angles to the chord. If the next segment
 * continues straight, the foot of the perpendicular may lie outside both chords by rounding, so a
 * tolerance is added. */
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

static void seed_segment(struct gd__wavefront *front, struct gd__segment_cache *cache,
                         uint32_t seed)
{
    const struct gd__placed_segment *placed = gd__segment_cache_get(front, cache, seed);
    if (placed->face == GD_NONE) {
        seed_along_edge(front, seed, placed->edge);
        return;
    }
    const uint32_t *side = front->mesh->face_side[placed->face];
    for (int k = 0; k < 3; k++) {
        seed_apex_from_chord(front, seed, side[k], &placed->chord[k]);
        seed_strip_across(front, seed, side[k], &placed->chord[k]);
    }
}

/* --- all seeds -------------------------------------------------------------------------------- */

/* Returns side 0 of the edge on which a seed lies or begins, or GD_NONE if there is no such
 * edge. */
static uint32_t side_of_seed(const struct gd__wavefront *front, uint32_t seed)
{
    if (seed >= front->seed_count || front->seeds[seed].point.kind != GD_POINT_EDGE) return GD_NONE;
    return 2 * front->seeds[seed].point.element;
}

/* Prefetches the data for windows that leave across `side` or through the face before it. */
GD__PREFETCH prefetch_way_out(const struct gd__wavefront *front, uint32_t side)
{
    __builtin_prefetch(&front->mesh->side[side ^ 1]);
    __builtin_prefetch(&front->mesh->origin[side]);
    if (!front->paged) __builtin_prefetch(&front->lists[side]);
}

/* Prefetches data of two later joints. For the farther joint, this is its edge. For the nearer
 * joint, these are the two faces of its edge. */
GD__PREFETCH prefetch_seeds(const struct gd__wavefront *front, uint32_t seed)
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

/* Locates and prefetches data for later joints and segments. */
static inline void look_ahead(const struct gd__wavefront *front, struct gd__segment_cache *cache,
                              uint32_t joint)
{
    uint32_t segment = joint + 1 + 2 * GD__SEGMENTS_AHEAD;
    prefetch_seeds(front, joint);
    if (segment < front->seed_count && front->seeds[segment].is_segment)
        gd__segment_cache_get(front, cache, segment);
}

static void emit_seed(struct gd__wavefront *front, struct gd__segment_cache *cache, uint32_t seed)
{
    if (front->seeds[seed].is_segment) {
        seed_segment(front, cache, seed);
        return;
    }
    if (front->seeds[seed].point.kind == GD_POINT_EDGE)
        seed_edge(front, cache, seed);
    else
        seed_face(front, cache, seed);
}

static bool is_at_vertex(const struct gd__seed *seed)
{
    return !seed->is_segment && seed->point.kind == GD_POINT_VERTEX;
}

/* Seeds at vertices emit last, when the nearest seed of each vertex is known. Otherwise a vertex
 * could cast a window with a distance that decreases later. The window would then be dropped as
 * stale. This would leave a gap if the window had removed other windows in ties. */
void gd__emit_seeds(struct gd__wavefront *front)
{
    struct gd__segment_cache cache;
    gd__segment_cache_clear(&cache);
    for (uint32_t i = 0; i < front->seed_count && !front->status; i++)
        if (is_at_vertex(&front->seeds[i])) reach_vertex(front, i);
    for (uint32_t i = 0; i < front->seed_count && !front->status; i++) {
        if (!front->seeds[i].is_segment) look_ahead(front, &cache, i);
        if (!is_at_vertex(&front->seeds[i])) emit_seed(front, &cache, i);
    }
    for (uint32_t i = 0; i < front->seed_count && !front->status; i++)
        if (is_at_vertex(&front->seeds[i])) seed_vertex(front, i);
}
