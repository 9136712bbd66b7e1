#include "wedge/rings.h"

#include <math.h>
#include <stdlib.h>

#include "base/tolerance.h"
#include "wedge/asking.h"
#include "wedge/guide.h"
#include "wedge/kernel.h"

#define SPACING 12   /* hops from ring to ring: nearer ones lose more, farther ones cut through the surface */
#define LEAST   6    /* hops from a vertex to the ring that it is measured by */
#define GAP     0.08 /* of the bound that lower bounds miss of the way: with less, rings cost more than they save */
#define AHEAD   8    /* vertices: whose records are asked for before they are looked at */
#define COARSE  1e3  /* edges so many times longer than the bound: floats would tell nothing */

#define OUT_OF_THE_WAY GD_NONE /* in place of hops: no way within the bound passes the vertex by */

size_t gd__rings_held(const struct gd__rings *rings)
{
    return rings->capacity * sizeof *rings->ring + rings->group_capacity * sizeof *rings->group +
           rings->vertices * sizeof *rings->hops + rings->marked_capacity * sizeof *rings->marked;
}

void gd__rings_clean(struct gd__rings *rings)
{
    for (uint32_t i = 0; i < rings->marked_count; i++) rings->hops[rings->marked[i]] = 0;
    rings->count = rings->group_count = rings->marked_count = 0;
}

void gd__rings_destroy(struct gd__rings *rings)
{
    free(rings->ring);
    free(rings->group);
    free(rings->hops);
    free(rings->marked);
    *rings = (struct gd__rings){0};
}

/* --- bounds by a ring ---------------------------------------------------------------------------------------------------- */

static struct gd__place place_of(const struct gd__guide *guide, uint32_t vertex)
{
    const struct gd_vec3 *p = &guide->mesh->position[vertex], *target = &guide->target.position;
    double scale = 1 / guide->rings.bound;
    return (struct gd__place){(float)((p->x - target->x) * scale), (float)((p->y - target->y) * scale),
                              (float)((p->z - target->z) * scale)};
}

/* How far below its chord a distance in space may lie on an edge that is at least so far away. */
static float sag(float edge, float away)
{
    return away > 0.25f * edge ? edge * edge / (8 * away) : 0.5f * edge;
}

/* Lower bound of the way to the target from a place by a ring, over the bound; and, as a linear function, from edges between such places, none longer than
 * `own`. */
static float by_ring(const struct gd__rings *rings, uint32_t number, struct gd__place p, float own)
{
    const struct gd__ring *ring = &rings->ring[number];
    struct gd__ring_way least = gd__kernel_in_use()->ring(rings->group + ring->first, rings->group + ring[1].first, p);
    float clear = least.away - 0.5f * ring->longest - own; /* between any points of the edges */
    return least.way - sag(ring->longest, clear) - sag(own, clear) - rings->slack;
}

/* The ring that tells most of a vertex of so many hops: not so near that much is lost. */
static uint32_t ring_for(uint32_t hops)
{
    return hops < LEAST ? 0 : (hops - LEAST) / SPACING;
}

static double measured(const struct gd__guide *guide, float lower)
{
    return guide->rings.bound * (1 - GD_TOL_BOUND) * (double)lower - guide->margin;
}

double gd__rings_lower(const struct gd__guide *guide, uint32_t vertex)
{
    uint32_t hops = guide->rings.hops[vertex];
    if (hops == 0 || hops == OUT_OF_THE_WAY) return GD__FAR;
    return measured(guide, by_ring(&guide->rings, ring_for(hops - 1), place_of(guide, vertex), 0));
}

/* --- which vertices ways may pass by ------------------------------------------------------------------------------------- */

/* Rings on their way outwards. */
struct growth {
    struct gd__guide *guide;
    struct gd__anchor from;
    uint32_t hops;  /* of the outermost vertices, which are */
    uint32_t first; /* marked [first, marked_count) */
};

static double longest_edge_at(const struct gd_mesh *mesh, uint32_t vertex)
{
    double longest = 0;
    for (uint32_t i = mesh->fan_first[vertex]; i < mesh->fan_first[vertex + 1]; i++) {
        const struct gd_side *s = &mesh->side[mesh->fan[i].side];
        longest = fmax(longest, fmax(s->length, s->left_length));
    }
    return longest;
}

/* Whether no way within the bound passes through a face of the vertex, from which the rest is no shorter than `rest`: within a face it is an edge's length away
 * at the most. */
static bool is_out_of_the_way(const struct growth *growth, uint32_t vertex, double rest)
{
    const struct gd__guide *guide = growth->guide;
    double whole = gd__guide_line(guide, vertex, &growth->from) + rest;
    return whole > guide->rings.bound && whole > guide->rings.bound + 2 * longest_edge_at(guide->mesh, vertex);
}

static double square(const struct gd_vec3 *a, const struct gd_vec3 *b)
{
    double x = a->x - b->x, y = a->y - b->y, z = a->z - b->z;
    return x * x + y * y + z * z;
}

/* Whether straight lines to both ends are within the bound: without a root. */
static bool is_between(const struct growth *growth, uint32_t vertex)
{
    const struct gd__guide *guide = growth->guide;
    const struct gd_vec3 *p = &guide->mesh->position[vertex];
    double a = square(p, &growth->from.position), b = square(p, &guide->target.position),
           rest = guide->rings.bound * guide->rings.bound - a - b;
    return rest >= 0 && 4 * a * b <= rest * rest;
}

static enum gd_status make_room_to_mark(struct gd__guide *guide, uint32_t vertices)
{
    struct gd__rings *rings = &guide->rings;
    return gd__guide_make_room(guide, (void **)&rings->marked, rings->marked_count + vertices, &rings->marked_capacity,
                               sizeof *rings->marked);
}

/* Marks a vertex that is not yet; there is room. Without a branch, which would be as good as random. */
static inline void mark(const struct growth *growth, uint32_t vertex)
{
    struct gd__rings *rings = &growth->guide->rings;
    uint32_t hops = rings->hops[vertex];
    rings->marked[rings->marked_count] = vertex;
    rings->marked_count += hops == 0;
    rings->hops[vertex] = hops ? hops : 1 + growth->hops;
}

static enum gd_status mark_neighbours(const struct growth *growth, uint32_t vertex)
{
    const struct gd_mesh *mesh = growth->guide->mesh;
    uint32_t first = mesh->fan_first[vertex], end = mesh->fan_first[vertex + 1];
    enum gd_status status = gd__guide_step(growth->guide);
    if (!status) status = make_room_to_mark(growth->guide, end - first + 1);
    if (status) return status;
    for (uint32_t i = first; i < end; i++) mark(growth, mesh->fan[i].tip);
    if (mesh->vertex_kind[vertex] == GD_VERTEX_BOUNDARY) mark(growth, gd__side_apex(mesh, mesh->fan[end - 1].side));
    return GD_OK;
}

/* Which of the outermost vertices no way within the bound passes by, as straight lines tell it. */
static enum gd_status leave_out_of_the_way(const struct growth *growth)
{
    struct gd__guide *guide = growth->guide;
    struct gd__rings *rings = &guide->rings;
    enum gd_status status = GD_OK;
    for (uint32_t i = growth->first; i < rings->marked_count && !status; i++) {
        uint32_t vertex = rings->marked[i];
        status = gd__guide_step(guide);
        if (i + AHEAD < rings->marked_count) __builtin_prefetch(&guide->mesh->position[rings->marked[i + AHEAD]]);
        if (!is_between(growth, vertex) &&
            is_out_of_the_way(growth, vertex, gd__guide_line(guide, vertex, &guide->target)))
            rings->hops[vertex] = OUT_OF_THE_WAY;
    }
    return status;
}

/* Asks for the fan of a vertex that comes up, and where that of a farther one begins. */
GD__ASKING prefetch_fan(const struct gd_mesh *mesh, uint32_t near, uint32_t far)
{
    __builtin_prefetch(&mesh->fan_first[far]);
    __builtin_prefetch(&mesh->fan[mesh->fan_first[near]]);
}

/* One hop farther. */
static enum gd_status grow(struct growth *growth)
{
    const struct gd__rings *rings = &growth->guide->rings;
    uint32_t first = growth->first, end = rings->marked_count;
    enum gd_status status = GD_OK;
    growth->first = end;
    growth->hops++;
    for (uint32_t i = first; i < end && !status; i++) {
        if (i + AHEAD < end) prefetch_fan(growth->guide->mesh, rings->marked[i + AHEAD / 2], rings->marked[i + AHEAD]);
        if (rings->hops[rings->marked[i]] != OUT_OF_THE_WAY) status = mark_neighbours(growth, rings->marked[i]);
    }
    return status ? status : leave_out_of_the_way(growth);
}

/* --- drawing ------------------------------------------------------------------------------------------------------------- */

/* A group of which no lane is taken. */
static enum gd_status add_group(struct gd__guide *guide)
{
    struct gd__rings *rings = &guide->rings;
    enum gd_status status = gd__guide_make_room(guide, (void **)&rings->group, rings->group_count,
                                                &rings->group_capacity, sizeof *rings->group);
    if (status) return status;
    struct gd__ring_group *group = &rings->group[rings->group_count++];
    for (int i = 0; i < GD__RING_LANES; i++)
        group->x[i] = group->y[i] = group->z[i] = group->lower[i] = GD__RING_NOWHERE;
    return GD_OK;
}

static void put(struct gd__rings *rings, uint32_t lane, struct gd__place p, float lower)
{
    struct gd__ring_group *group = &rings->group[rings->group_count - 1];
    group->x[lane] = p.x;
    group->y[lane] = p.y;
    group->z[lane] = p.z;
    group->lower[lane] = lower;
}

/* The groups from the end of the ring before up to here are a ring. */
static enum gd_status close_ring(struct gd__guide *guide, float longest)
{
    struct gd__rings *rings = &guide->rings;
    enum gd_status status =
        gd__guide_make_room(guide, (void **)&rings->ring, rings->count + 1, &rings->capacity, sizeof *rings->ring);
    if (status) return status;
    rings->ring[rings->count++].longest = longest;
    rings->ring[rings->count].first = rings->group_count;
    return GD_OK;
}

static enum gd_status open_hops(struct gd__guide *guide)
{
    struct gd__rings *rings = &guide->rings;
    uint32_t vertices = guide->mesh->vertex_count;
    if (vertices <= rings->vertices) return GD_OK;
    enum gd_status status = gd_control_afford(guide->control, gd__guide_held(guide) + vertices * sizeof *rings->hops);
    if (status) return status;
    uint32_t *hops = calloc(vertices, sizeof *hops);
    if (!hops) return GD_NO_MEMORY;
    free(rings->hops);
    rings->hops = hops;
    rings->vertices = vertices;
    return GD_OK;
}

/* The target is a ring of its own. */
static enum gd_status begin(struct gd__guide *guide)
{
    struct gd__rings *rings = &guide->rings;
    enum gd_status status = open_hops(guide);
    if (!status) status = gd__guide_make_room(guide, (void **)&rings->ring, 0, &rings->capacity, sizeof *rings->ring);
    if (!status) status = add_group(guide);
    if (status) return status;
    rings->ring[0].first = 0;
    put(rings, 0, (struct gd__place){0, 0, 0}, 0);
    return close_ring(guide, 0);
}

/* Of the edges between the outermost vertices. */
static float longest_edge_between(const struct growth *growth)
{
    const struct gd_mesh *mesh = growth->guide->mesh;
    const struct gd__rings *rings = &growth->guide->rings;
    double longest = 0;
    for (uint32_t i = growth->first; i < rings->marked_count; i++) {
        uint32_t vertex = rings->marked[i];
        if (rings->hops[vertex] == OUT_OF_THE_WAY) continue;
        for (uint32_t k = mesh->fan_first[vertex]; k < mesh->fan_first[vertex + 1]; k++)
            if (rings->hops[mesh->fan[k].tip] == 1 + growth->hops)
                longest = fmax(longest, mesh->side[mesh->fan[k].side].length);
    }
    return (float)(longest / rings->bound);
}

/* The outermost vertices become a ring, but for those that it shows to be out of the way. */
static enum gd_status add_ring(struct growth *growth)
{
    struct gd__guide *guide = growth->guide;
    struct gd__rings *rings = &guide->rings;
    float longest = longest_edge_between(growth);
    uint32_t lane = 0, last = rings->count - 1;
    enum gd_status status = GD_OK;
    for (uint32_t i = growth->first; i < rings->marked_count && !status; i++) {
        uint32_t vertex = rings->marked[i];
        if (rings->hops[vertex] == OUT_OF_THE_WAY) continue;
        struct gd__place p = place_of(guide, vertex);
        float lower = by_ring(rings, last, p, longest);
        if (is_out_of_the_way(growth, vertex, measured(guide, lower))) {
            rings->hops[vertex] = OUT_OF_THE_WAY;
            continue;
        }
        if (lane == 0) status = add_group(guide);
        if (!status) put(rings, lane, p, lower);
        if (!status) status = gd__guide_step(guide);
        lane = (lane + 1) % GD__RING_LANES;
    }
    return status ? status : close_ring(guide, longest);
}

static enum gd_status draw(struct growth *growth)
{
    struct gd__guide *guide = growth->guide;
    struct gd__rings *rings = &guide->rings;
    enum gd_status status = begin(guide);
    if (!status) status = make_room_to_mark(guide, 4);
    for (int k = 0; k < 4 && guide->target.corner[k] != GD_NONE && !status; k++) mark(growth, guide->target.corner[k]);
    if (!status) status = leave_out_of_the_way(growth);
    while (growth->first < rings->marked_count && !status) {
        if (growth->hops && growth->hops % SPACING == 0) status = add_ring(growth);
        if (!status) status = grow(growth);
    }
    return status;
}

enum gd_status gd__rings_draw(struct gd__guide *guide, const struct gd_point *from, double bound)
{
    struct growth growth = {.guide = guide, .from = gd__anchor(guide->mesh, from)};
    struct gd__rings *rings = &guide->rings;
    double coarseness = 1 + 2 * guide->mesh->summary.edge_length.max / guide->mesh->unit / bound, sure = GD__FAR;
    gd__rings_clean(rings);
    gd__guide_ask_again(guide);
    for (int k = 0; k < 4 && growth.from.corner[k] != GD_NONE; k++)
        sure = fmin(sure, gd__guide_lower(guide, growth.from.corner[k]) + growth.from.leg[k]);
    if (!(bound > 0) || sure > bound * (1 - GAP) || coarseness > COARSE) return GD_OK;
    rings->bound = bound;
    rings->slack = (float)(GD_TOL_RING * coarseness);
    enum gd_status status = draw(&growth);
    if (status) gd__rings_clean(rings);
    gd__guide_ask_again(guide);
    return status;
}
