#include "mesh/segment.h"
#include "wedge/wavefront.h"

#define ARRAYS       6 /* of struct gd__windows */
#define BLOCKS_AHEAD 2

/* Seeds: what a source sees at once. A point sees its face (or the two faces of its edge, or the fan of its vertex); a segment what lies before and
 * behind it at right angles. A joint, where segments of a curve end, sees only what lies behind the ends of all of them: in any other direction a
 * place of one of them is nearer (first variation of length). */

/* --- joints -------------------------------------------------------------------------------------------------------------- */

/* A segment as it lies on the surface. */
struct laid {
    uint32_t seed; /* GD_NONE: none yet */
    struct gd__home home;
    struct gd__chord chord[3]; /* across a face: in the frames of its sides */
};

/* The two segments laid last: a segment of a curve is asked for three times in a row, by itself and by its ends. */
struct laying {
    struct laid last[2];
};

static const struct laid *lay(const struct gd__wavefront *front, struct laying *laying, uint32_t seed)
{
    struct laid *laid = &laying->last[seed / 2 % 2];
    const struct gd__seed *s = &front->seeds[seed];
    if (laid->seed == seed) return laid;
    laid->seed = seed;
    laid->home = (struct gd__home){GD_NONE, GD_NONE};
    if (gd__segment_home(front->mesh, &s->point, &s->end, &laid->home) && laid->home.face != GD_NONE)
        gd__chords(front->mesh, laid->home.face, &s->point, &s->end, laid->chord);
    return laid;
}

static bool is_laid(const struct laid *laid)
{
    return laid->home.edge != GD_NONE || laid->home.face != GD_NONE;
}

/* The segments that end at a point, which stand next to it in the list of seeds (gd_curve_seeds). */
struct joint {
    const struct laid *segment[2];
    double turned[2]; /* 1: the segment goes off from here, -1: it comes here */
    int count;
};

static struct joint joint_of(const struct gd__wavefront *front, struct laying *laying, uint32_t seed)
{
    const struct gd__seed *at = &front->seeds[seed];
    struct joint joint = {.count = 0};
    for (uint32_t i = seed ? seed - 1 : 1; i <= seed + 1 && i < front->seed_count; i += 2) {
        const struct gd__seed *s = &front->seeds[i];
        if (!s->is_segment || s->offset != at->offset) continue;
        bool goes = gd_point_equal(&s->point, &at->point);
        if (!goes && !gd_point_equal(&s->end, &at->point)) continue;
        joint.turned[joint.count] = goes ? 1 : -1;
        joint.segment[joint.count] = lay(front, laying, i);
        joint.count += is_laid(joint.segment[joint.count]);
    }
    return joint;
}

/* Where the segments of a joint go off from it, in the frame of a side: unit vectors. */
struct spread {
    struct gd__local along[2];
    int count;
};

static struct gd__local turned(struct gd__local along, double by)
{
    return (struct gd__local){by * along.x, by * along.y};
}

static double along(struct gd__local direction, struct gd__local v)
{
    return direction.x * v.x + direction.y * v.y;
}

/* Whether one of the segments is nearer to a place, at `v` from the joint, than the joint is, and by more than rounding. */
static bool is_ahead(const struct spread *spread, struct gd__local v)
{
    double beside = GD_TOL_ONWARD * (fabs(v.x) + fabs(v.y));
    for (int i = 0; i < spread->count; i++)
        if (along(spread->along[i], v) > beside) return true;
    return false;
}

/* Two segments that go on straight: what lies behind both is a line. */
static bool is_straight(const struct spread *spread)
{
    const struct gd__local *a = &spread->along[0], *b = &spread->along[1];
    return spread->count == 2 && along(*a, *b) < 0 && fabs(a->x * b->y - a->y * b->x) <= GD_TOL_ONWARD;
}

/* A part of a side, in parts of its length from its origin. */
struct part {
    double from, to;
};

/* Keeps what is not ahead, where its ends are so far ahead of a joint. */
static void keep_behind(struct part *part, double first, double last)
{
    if (first <= 0 && last <= 0) return;
    double crossing = first > 0 && last > 0 ? 1 : first / (first - last);
    if (first > 0)
        part->from = part->from > crossing ? part->from : crossing;
    else
        part->to = part->to < crossing ? part->to : crossing;
}

/* What of the side from `origin` to `destination`, as seen from a joint, lies behind all its segments. */
static struct part part_behind(const struct spread *spread, struct gd__local origin, struct gd__local destination)
{
    struct part part = {0, 1};
    for (int i = 0; i < spread->count; i++)
        keep_behind(&part, along(spread->along[i], origin), along(spread->along[i], destination));
    return part;
}

/* --- points -------------------------------------------------------------------------------------------------------------- */

/* Most windows begin a list, in a block of the pool that nobody has seen for long: asks for the lines that one some windows on will fill. Inlined, as GCC
 * takes a function that does nothing else for one without effects. */
static inline __attribute__((always_inline)) void prefetch_block(const struct gd__pool *pool)
{
    const size_t array = 2 * GD__WINDOWS_GROUP * sizeof(double); /* of a block for one window: two groups */
    for (size_t i = 0; i < ARRAYS; i++)
        __builtin_prefetch(pool->cursor + 2 * BLOCKS_AHEAD * GD__LIST_POOL_ITEM + i * array, 1);
}

/* Offers a side a seed's window. */
static void seed_side(struct gd__wavefront *front, uint32_t side, const struct gd__window *window)
{
    prefetch_block(&front->work->pool);
    struct gd__receiver to = gd__wavefront_receiver(front, side);
    gd__wavefront_offer(front, &to, window);
}

/* Sends the seed's window out of its face across a part of `side` (a side of that face). */
static void seed_across(struct gd__wavefront *front, uint32_t seed, uint32_t side, struct gd__local at,
                        struct part part)
{
    double length = front->mesh->side[side].length;
    if (part.to - part.from <= GD_TOL_WIDTH || gd__window_grazes(length - at.x, at.y, length)) return;
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

/* Straight to the apex of `side`, a side of the seed's face, unless a segment is nearer. */
static void seed_apex(struct gd__wavefront *front, uint32_t seed, uint32_t side, struct gd__local at,
                      const struct spread *spread)
{
    struct gd__local way = to_apex(&front->mesh->side[side], at);
    if (is_ahead(spread, way)) return;
    struct gd__birth birth = {.x = at.x, .y = -at.y, .side = side, .source = front->mesh->vertex_count + seed};
    gd__wavefront_reach(front, gd__side_apex(front->mesh, side),
                        front->seeds[seed].offset + sqrt(way.x * way.x + way.y * way.y), birth);
}

/* In the frame of side k of the face that the joint lies in. */
static struct spread spread_in_face(const struct joint *joint, int k)
{
    struct spread spread = {.count = joint->count};
    for (int i = 0; i < joint->count; i++)
        spread.along[i] = turned(joint->segment[i]->chord[k].along, joint->turned[i]);
    return spread;
}

static void seed_face(struct gd__wavefront *front, struct laying *laying, uint32_t seed)
{
    const struct gd_mesh *mesh = front->mesh;
    const struct gd_point *point = &front->seeds[seed].point;
    const uint32_t *sides = mesh->face_side[point->element];
    const struct joint joint = joint_of(front, laying, seed);
    struct gd__local at[3];
    struct spread spread[3];
    for (int k = 0; k < 3; k++) {
        at[k] = gd__side_local(&mesh->side[sides[k]], point->weight[(k + 1) % 3], point->weight[(k + 2) % 3]);
        spread[k] = spread_in_face(&joint, k);
        seed_apex(front, seed, sides[k], at[k], &spread[k]);
    }
    for (int k = 0; k < 3 && !is_straight(&spread[0]); k++) {
        struct gd__local origin = {-at[k].x, -at[k].y}, destination = {mesh->side[sides[k]].length - at[k].x, -at[k].y};
        seed_across(front, seed, sides[k], at[k], part_behind(&spread[k], origin, destination));
    }
}

/* In the frame of one side of an edge, in which the face across is laid beside its own. */
static struct gd__local direction_from_edge(const struct gd__wavefront *front, uint32_t side, const struct laid *laid)
{
    const struct gd_mesh *mesh = front->mesh;
    const struct gd__seed *s = &front->seeds[laid->seed];
    if (laid->home.edge != GD_NONE) {
        uint32_t edge = laid->home.edge;
        double x = gd__edge_parameter(mesh, edge, &s->end) - gd__edge_parameter(mesh, edge, &s->point);
        return (struct gd__local){copysign(1, side & 1 ? -x : x), 0};
    }
    const uint32_t *sides = mesh->face_side[laid->home.face];
    int k = gd__place_of_edge(sides, side >> 1);
    return turned(laid->chord[k].along, 1 - 2 * (double)(sides[k] != side));
}

static struct spread spread_from_edge(const struct gd__wavefront *front, struct laying *laying, uint32_t seed,
                                      uint32_t side)
{
    const struct joint joint = joint_of(front, laying, seed);
    struct spread spread = {.count = joint.count};
    for (int i = 0; i < joint.count; i++)
        spread.along[i] = turned(direction_from_edge(front, side, joint.segment[i]), joint.turned[i]);
    return spread;
}

static struct spread seen_from_other_side(struct spread spread)
{
    for (int i = 0; i < spread.count; i++) spread.along[i] = turned(spread.along[i], -1);
    return spread;
}

/* From a point of an edge across the two other sides of the face of one of its sides. */
static void seed_half_edge(struct gd__wavefront *front, uint32_t seed, uint32_t side, double t,
                           const struct spread *spread)
{
    const struct gd_mesh *mesh = front->mesh;
    if (gd__side_is_boundary(mesh, side)) return;
    const struct gd_side *s = &mesh->side[side];
    struct gd__local origin = {-t, 0}, destination = {s->length - t, 0}, apex = to_apex(s, (struct gd__local){t, 0});
    double u = t / s->length; /* weights 1 - u, u, 0 of origin, destination, apex */
    uint32_t next = gd__side_next(mesh, side), previous = gd__side_previous(mesh, side);
    seed_across(front, seed, next, gd__side_local(&mesh->side[next], 0, 1 - u), part_behind(spread, destination, apex));
    seed_across(front, seed, previous, gd__side_local(&mesh->side[previous], 1 - u, u),
                part_behind(spread, apex, origin));
}

/* From a point of an edge to the corners of the face of one of its sides, but for the side's destination. */
static void seed_corners(struct gd__wavefront *front, uint32_t seed, uint32_t side, double t,
                         const struct spread *spread)
{
    struct gd__birth birth = {.side = GD_NONE, .source = front->mesh->vertex_count + seed};
    if (!is_ahead(spread, (struct gd__local){-t, 0}))
        gd__wavefront_reach(front, front->mesh->origin[side], front->seeds[seed].offset + t, birth);
    if (!gd__side_is_boundary(front->mesh, side)) seed_apex(front, seed, side, (struct gd__local){t, 0}, spread);
}

static void seed_edge(struct gd__wavefront *front, struct laying *laying, uint32_t seed)
{
    const struct gd_point *point = &front->seeds[seed].point;
    uint32_t side = 2 * point->element;
    double length = front->mesh->side[side].length, t = point->weight[0] * length;
    const struct spread spread = spread_from_edge(front, laying, seed, side), other = seen_from_other_side(spread);
    seed_corners(front, seed, side, t, &spread);
    seed_corners(front, seed, side ^ 1, length - t, &other);
    if (is_straight(&spread)) return;
    seed_half_edge(front, seed, side, t, &spread);
    seed_half_edge(front, seed, side ^ 1, length - t, &other);
}

/* A seed at a vertex makes the vertex a pseudo-source, whatever its kind. */
static void seed_vertex(struct gd__wavefront *front, uint32_t seed)
{
    uint32_t vertex = front->seeds[seed].point.element;
    struct gd__birth birth = {.side = GD_NONE, .source = front->mesh->vertex_count + seed};
    gd__wavefront_reach(front, vertex, front->seeds[seed].offset, birth);
    if (!front->status && gd__wavefront_birth(front, vertex)->source == birth.source) gd__emit_vertex(front, vertex);
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
    struct gd__window w = {.b0 = a < b ? a : b, .b1 = a < b ? b : a, .y = 1, .sigma = s->offset};
    w.source = linear_source(front, seed);
    struct gd__window mirrored = gd__window_mirrored(&w, length);
    if (!gd__side_is_boundary(mesh, 2 * edge)) seed_side(front, 2 * edge, &w);
    if (!gd__side_is_boundary(mesh, 2 * edge + 1)) seed_side(front, 2 * edge + 1, &mirrored);
}

/* Out of the segment's face across a side of it: the part of the edge that lies at right angles to the chord. */
static void seed_strip_across(struct gd__wavefront *front, uint32_t seed, uint32_t side, const struct gd__chord *chord)
{
    double length = front->mesh->side[side].length, away = fabs(chord->along.x);
    if (away <= GD_TOL_GRAZING) return;
    double slope = chord->along.y / chord->along.x, turned = copysign(1, chord->along.x);
    double from = length - (chord->from.x + chord->from.y * slope), to = from - chord->length / chord->along.x,
           b0 = from < to ? from : to, b1 = from < to ? to : from;
    struct gd__window w = {.b0 = b0 > 0 ? b0 : 0,
                           .b1 = b1 < length ? b1 : length,
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
    double foot = gd__chord_foot(chord, apex), height = gd__chord_height(chord, apex), left = copysign(1, height);
    bool is_seen = (foot > 0) & (foot < chord->length) & (height != 0);
    if (!is_seen || is_end(front, seed, gd__side_apex(front->mesh, side))) return;
    struct gd__birth birth = {
        .x = left * chord->along.y, .y = left * chord->along.x, .side = side, .source = linear_source(front, seed)};
    gd__wavefront_reach(front, gd__side_apex(front->mesh, side), front->seeds[seed].offset + fabs(height), birth);
}

static void seed_segment(struct gd__wavefront *front, struct laying *laying, uint32_t seed)
{
    const struct laid *laid = lay(front, laying, seed);
    if (laid->home.edge != GD_NONE) {
        seed_along_edge(front, seed, laid->home.edge);
    } else if (laid->home.face != GD_NONE) {
        const uint32_t *side = front->mesh->face_side[laid->home.face];
        for (int k = 0; k < 3; k++) seed_apex_from_chord(front, seed, side[k], &laid->chord[k]);
        for (int k = 0; k < 3; k++) seed_strip_across(front, seed, side[k], &laid->chord[k]);
    } else {
        front->status = GD_INVALID_ARGUMENT;
    }
}

/* --- all ----------------------------------------------------------------------------------------------------------------- */

static void emit_seed(struct gd__wavefront *front, struct laying *laying, uint32_t seed)
{
    if (front->seeds[seed].is_segment) {
        seed_segment(front, laying, seed);
        return;
    }
    if (front->domain) front->domain->is_common = front->seeds[seed].point.kind != GD_POINT_VERTEX;
    switch (front->seeds[seed].point.kind) {
    case GD_POINT_VERTEX:
        seed_vertex(front, seed);
        break;
    case GD_POINT_EDGE:
        seed_edge(front, laying, seed);
        break;
    case GD_POINT_FACE:
        seed_face(front, laying, seed);
        break;
    }
}

void gd__emit_seeds(struct gd__wavefront *front)
{
    struct laying laying;
    for (int i = 0; i < 2; i++) laying.last[i].seed = GD_NONE;
    for (uint32_t i = 0; i < front->seed_count && !front->status; i++) emit_seed(front, &laying, i);
    if (front->domain) front->domain->is_common = false;
}
