#include "guide/guide.h"

#include <math.h>
#include <stdlib.h>

#include "base/tolerance.h"
#include "base/prefetch.h"
#include "kernel/kernel.h"

/* Number of hops from ring to ring. Each ring makes the bound a little worse, which is a reason
 * against a smaller spacing. With a larger spacing, the straight lines from ring to ring follow the
 * surface less well. */
#define SPACING 6
#define LEAST   3 /* least number of hops between a vertex and the ring that gives its bound */
/* Rings are computed only if the other lower bounds are below the search's bound by more than this
 * part of the bound. Otherwise rings cost more than they save. */
#define GAP   0.02
#define AHEAD 8 /* records are prefetched this number of vertices ahead */
/* Largest length of an edge, relative to the bound. With longer edges, floats would be too
 * imprecise. */
#define COARSE 1e3

/* This value of `hops` means that no path within the bound passes the vertex. */
#define OUT_OF_THE_WAY GD_NONE

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

/* --- bounds by a ring ------------------------------------------------------------------------- */

static struct gd__place place_of(const struct gd__guide *guide, uint32_t vertex)
{
    const struct gd_vec3 *p = &guide->mesh->position[vertex], *target = &guide->target.position;
    double scale = 1 / guide->rings.bound;
    return (struct gd__place){(float)((p->x - target->x) * scale),
                              (float)((p->y - target->y) * scale),
                              (float)((p->z - target->z) * scale)};
}

/* Returns a lower bound of the distance from a point to the target, computed from one ring and
 * divided by the search's bound. On the part of an edge between two such points, the linear
 * interpolation of their results is also a lower bound, if this part is not longer than `own`. */
static float by_ring(const struct gd__rings *rings, uint32_t number, struct gd__place p, float own)
{
    const struct gd__ring_group *group = rings->group;
    return gd__kernel_in_use()->ring(group + rings->ring[number], group + rings->ring[number + 1],
                                     p, own) -
           rings->slack;
}

/* Returns the number of the ring that gives the best bound for a vertex which is `hops` edges away
 * from the target. A ring that is too close to the vertex gives a bad bound. */
static uint32_t ring_for(uint32_t hops)
{
    return hops < LEAST ? 0 : (hops - LEAST) / SPACING;
}

static double distance_of_bound(const struct gd__guide *guide, float lower)
{
    return guide->rings.bound * (1 - GD_TOL_BOUND) * (double)lower - guide->margin;
}

double gd__rings_lower(const struct gd__guide *guide, uint32_t vertex)
{
    uint32_t hops = guide->rings.hops[vertex];
    if (hops == 0 || hops == OUT_OF_THE_WAY) return GD__FAR;
    return distance_of_bound(
        guide, by_ring(&guide->rings, ring_for(hops - 1), place_of(guide, vertex), 0));
}

/* --- vertices that paths may pass ------------------------------------------------------------- */

/* Rings under construction. */
struct growth {
    struct gd__guide *guide;
    struct gd__anchor from;
    /* hops of the outermost vertices, which are marked[first] to marked[marked_count - 1] */
    uint32_t hops;
    uint32_t first;
};

static double square(struct gd_vec3 a, struct gd_vec3 b)
{
    struct gd_vec3 way = gd_vec3_sub(a, b);
    return gd_vec3_dot(way, way);
}

/* Returns the length of the longest edge at a vertex. Computes it from positions, because loading
 * the records of sides would cause cache misses. */
static double longest_edge_at(const struct gd_mesh *mesh, uint32_t vertex)
{
    double longest = 0;
    for (uint32_t i = mesh->fan_first[vertex]; i < gd__neighbours_end(mesh, vertex); i++) {
        double edge =
            square(mesh->position[vertex], mesh->position[gd__neighbour(mesh, vertex, i)]);
        longest = edge > longest ? edge : longest;
    }
    return sqrt(longest);
}

/* Returns true if no path within the bound passes through a face of the vertex. `whole` is a lower
 * bound of the length of paths that pass the vertex. No point of these faces is farther from the
 * vertex than the length of the longest edge at the vertex. */
static bool is_too_long(const struct gd__guide *guide, uint32_t vertex, double whole)
{
    return whole > guide->rings.bound &&
           whole > guide->rings.bound + 2 * longest_edge_at(guide->mesh, vertex);
}

/* The same, if `rest` is a lower bound of the distance from the vertex to the target. */
static bool is_out_of_the_way(const struct growth *growth, uint32_t vertex, double rest)
{
    const struct gd__guide *guide = growth->guide;
    return is_too_long(guide, vertex, gd__guide_line(guide, vertex, &growth->from) + rest);
}

/* Returns true if the sum of the straight lines to both ends is within the bound. Uses no square
 * root. */
static bool is_between(const struct growth *growth, uint32_t vertex)
{
    const struct gd__guide *guide = growth->guide;
    const struct gd_vec3 p = guide->mesh->position[vertex];
    double a = square(p, growth->from.position), b = square(p, guide->target.position),
           rest = guide->rings.bound * guide->rings.bound - a - b;
    return rest >= 0 && 4 * a * b <= rest * rest;
}

static enum gd_status make_room_to_mark(struct gd__guide *guide, uint32_t vertices)
{
    struct gd__rings *rings = &guide->rings;
    return gd__guide_make_room(guide, &rings->marked, rings->marked_count + vertices,
                               &rings->marked_capacity, sizeof *rings->marked);
}

/* Marks an unmarked vertex. There must be room. Branchless, because a branch would be mispredicted
 * half of the time. */
static inline void mark_vertex(const struct growth *growth, uint32_t vertex)
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
    uint32_t first = mesh->fan_first[vertex], end = gd__neighbours_end(mesh, vertex);
    enum gd_status status = gd__guide_step(growth->guide);
    if (!status) status = make_room_to_mark(growth->guide, end - first);
    if (status) return status;
    for (uint32_t i = first; i < end; i++) mark_vertex(growth, gd__neighbour(mesh, vertex, i));
    return GD_OK;
}

/* Marks as OUT_OF_THE_WAY the outermost vertices that no path within the bound passes. Uses
 * straight lines as lower bounds. */
static enum gd_status leave_out_of_the_way(const struct growth *growth)
{
    struct gd__guide *guide = growth->guide;
    struct gd__rings *rings = &guide->rings;
    enum gd_status status = GD_OK;
    for (uint32_t i = growth->first; i < rings->marked_count && !status; i++) {
        uint32_t vertex = rings->marked[i];
        status = gd__guide_step(guide);
        if (i + AHEAD < rings->marked_count)
            __builtin_prefetch(&guide->mesh->position[rings->marked[i + AHEAD]]);
        if (!is_between(growth, vertex) &&
            is_out_of_the_way(growth, vertex, gd__guide_line(guide, vertex, &guide->target)))
            rings->hops[vertex] = OUT_OF_THE_WAY;
    }
    return status;
}

/* Prefetches the fan of the vertex `near`, which is needed soon, and the index of the fan of the
 * vertex `far`, which is needed after that. */
GD__PREFETCH prefetch_fan(const struct gd_mesh *mesh, uint32_t near, uint32_t far)
{
    __builtin_prefetch(&mesh->fan_first[far]);
    __builtin_prefetch(&mesh->fan[mesh->fan_first[near]]);
    __builtin_prefetch(&mesh->fan[mesh->fan_first[near] + 4]);
}

/* Extends the region by one hop. */
static enum gd_status grow_ring(struct growth *growth)
{
    const struct gd__rings *rings = &growth->guide->rings;
    uint32_t first = growth->first, end = rings->marked_count;
    enum gd_status status = GD_OK;
    growth->first = end;
    growth->hops++;
    for (uint32_t i = first; i < end && !status; i++) {
        if (i + AHEAD < end)
            prefetch_fan(growth->guide->mesh, rings->marked[i + AHEAD / 2],
                         rings->marked[i + AHEAD]);
        if (rings->hops[rings->marked[i]] != OUT_OF_THE_WAY)
            status = mark_neighbours(growth, rings->marked[i]);
    }
    return status ? status : leave_out_of_the_way(growth);
}

/* --- rings ------------------------------------------------------------------------------------ */

/* Adds a group whose lanes are all empty. */
static enum gd_status add_group(struct gd__guide *guide)
{
    struct gd__rings *rings = &guide->rings;
    enum gd_status status = gd__guide_make_room(guide, &rings->group, rings->group_count,
                                                &rings->group_capacity, sizeof *rings->group);
    if (status) return status;
    struct gd__ring_group *group = &rings->group[rings->group_count++];
    for (int i = 0; i < GD__RING_LANES; i++) {
        group->x[i] = group->y[i] = group->z[i] = group->lower[i] = GD__RING_NOWHERE;
        group->part[i] = 0;
    }
    return GD_OK;
}

/* Adds a point to a ring that has `count` points. */
static enum gd_status put_ring_point(struct gd__guide *guide, uint32_t *points, struct gd__place p,
                                     float lower, float part)
{
    uint32_t lane = (*points)++ % GD__RING_LANES;
    enum gd_status status = lane == 0 ? add_group(guide) : GD_OK;
    if (status) return status;
    struct gd__ring_group *group = &guide->rings.group[guide->rings.group_count - 1];
    group->x[lane] = p.x;
    group->y[lane] = p.y;
    group->z[lane] = p.z;
    group->lower[lane] = lower;
    group->part[lane] = part;
    return GD_OK;
}

/* Closes a ring, which consists of the groups since the end of the last ring. */
static enum gd_status close_ring(struct gd__guide *guide)
{
    struct gd__rings *rings = &guide->rings;
    enum gd_status status = gd__guide_make_room(guide, &rings->ring, rings->count + 1,
                                                &rings->capacity, sizeof *rings->ring);
    if (!status) rings->ring[++rings->count] = rings->group_count;
    return status;
}

static enum gd_status open_hops(struct gd__guide *guide)
{
    struct gd__rings *rings = &guide->rings;
    uint32_t vertices = guide->mesh->vertex_count;
    if (vertices <= rings->vertices) return GD_OK;
    enum gd_status status =
        gd_control_afford(guide->control, gd__guide_held(guide) + vertices * sizeof *rings->hops);
    if (status) return status;
    uint32_t *hops = calloc(vertices, sizeof *hops);
    if (!hops) return GD_NO_MEMORY;
    free(rings->hops);
    rings->hops = hops;
    rings->vertices = vertices;
    return GD_OK;
}

/* Adds the first ring, which is the target itself. */
static enum gd_status begin_rings(struct gd__guide *guide)
{
    struct gd__rings *rings = &guide->rings;
    enum gd_status status = open_hops(guide);
    if (!status)
        status = gd__guide_make_room(guide, &rings->ring, 0, &rings->capacity, sizeof *rings->ring);
    if (status) return status;
    rings->ring[0] = 0;
    status = put_ring_point(guide, &(uint32_t){0}, (struct gd__place){0, 0, 0}, 0, 0);
    return status ? status : close_ring(guide);
}

/* Returns half of the length of the edge from an outermost vertex to another vertex, or 0 if the
 * other vertex is not outermost or is out of the way. */
static float half_edge(const struct growth *growth, uint32_t vertex, uint32_t other)
{
    const struct gd_mesh *mesh = growth->guide->mesh;
    if (growth->guide->rings.hops[other] != 1 + growth->hops) return 0;
    return (float)(0.5 * gd_vec3_distance(mesh->position[vertex], mesh->position[other]) /
                   growth->guide->rings.bound);
}

static float longest_half_edge(const struct growth *growth, uint32_t vertex)
{
    const struct gd_mesh *mesh = growth->guide->mesh;
    float longest = 0;
    for (uint32_t i = mesh->fan_first[vertex]; i < gd__neighbours_end(mesh, vertex); i++)
        longest = fmaxf(longest, half_edge(growth, vertex, gd__neighbour(mesh, vertex, i)));
    return longest;
}

/* Adds the middles of the edges from an outermost vertex to outermost vertices with higher
 * numbers. */
static enum gd_status put_middles(const struct growth *growth, uint32_t *points, uint32_t vertex,
                                  struct gd__place p)
{
    struct gd__guide *guide = growth->guide;
    const struct gd_mesh *mesh = guide->mesh;
    enum gd_status status = GD_OK;
    for (uint32_t i = mesh->fan_first[vertex]; i < gd__neighbours_end(mesh, vertex) && !status;
         i++) {
        uint32_t other = gd__neighbour(mesh, vertex, i);
        float half = other > vertex ? half_edge(growth, vertex, other) : 0;
        if (half == 0) continue;
        struct gd__place q = place_of(guide, other),
                         middle = {0.5f * (p.x + q.x), 0.5f * (p.y + q.y), 0.5f * (p.z + q.z)};
        status = put_ring_point(guide, points, middle,
                                by_ring(&guide->rings, guide->rings.count - 1, middle, half), half);
    }
    return status;
}

/* Adds a vertex and its edges to the ring, unless a bound from the previous ring proves that the
 * vertex is out of the way. */
static enum gd_status put_vertex(struct growth *growth, uint32_t *points, uint32_t vertex)
{
    struct gd__guide *guide = growth->guide;
    struct gd__rings *rings = &guide->rings;
    struct gd__place p = place_of(guide, vertex);
    if (is_too_long(guide, vertex, gd__guide_whole(guide, vertex))) {
        rings->hops[vertex] = OUT_OF_THE_WAY;
        return GD_OK;
    }
    float half = longest_half_edge(growth, vertex),
          lower = by_ring(rings, rings->count - 1, p, half);
    if (is_out_of_the_way(growth, vertex, distance_of_bound(guide, lower))) {
        rings->hops[vertex] = OUT_OF_THE_WAY;
        return GD_OK;
    }
    enum gd_status status = put_ring_point(guide, points, p, lower, half);
    if (!status) status = put_middles(growth, points, vertex, p);
    return status ? status : gd__guide_step(guide);
}

/* Adds a ring of the outermost vertices, except those that are out of the way. */
static enum gd_status add_ring(struct growth *growth)
{
    struct gd__rings *rings = &growth->guide->rings;
    uint32_t points = 0;
    enum gd_status status = GD_OK;
    for (uint32_t i = growth->first; i < rings->marked_count && !status; i++) {
        if (i + AHEAD < rings->marked_count && growth->guide->landmark)
            __builtin_prefetch(growth->guide->landmark +
                               (size_t)GD__LANDMARKS_MOST * rings->marked[i + AHEAD]);
        if (i + AHEAD < rings->marked_count)
            prefetch_fan(growth->guide->mesh, rings->marked[i + AHEAD / 2],
                         rings->marked[i + AHEAD]);
        if (rings->hops[rings->marked[i]] != OUT_OF_THE_WAY)
            status = put_vertex(growth, &points, rings->marked[i]);
    }
    return status ? status : close_ring(growth->guide);
}

static enum gd_status draw_rings(struct growth *growth)
{
    struct gd__guide *guide = growth->guide;
    struct gd__rings *rings = &guide->rings;
    enum gd_status status = begin_rings(guide);
    if (!status) status = make_room_to_mark(guide, 4);
    for (int k = 0; k < 4 && guide->target.corner[k] != GD_NONE && !status; k++)
        mark_vertex(growth, guide->target.corner[k]);
    if (!status) status = leave_out_of_the_way(growth);
    while (growth->first < rings->marked_count && !status) {
        if (growth->hops && growth->hops % SPACING == 0) status = add_ring(growth);
        if (!status) status = grow_ring(growth);
    }
    return status;
}

enum gd_status gd__rings_draw(struct gd__guide *guide, const struct gd_point *from, double bound)
{
    struct growth growth = {.guide = guide, .from = gd__anchor(guide->mesh, from)};
    struct gd__rings *rings = &guide->rings;
    double coarseness = 1 + 2 * guide->mesh->summary.edge_length.max / guide->mesh->unit / bound,
           sure = GD__FAR;
    gd__rings_clean(rings);
    gd__guide_reset_lower(guide);
    for (int k = 0; k < 4 && growth.from.corner[k] != GD_NONE; k++)
        sure = fmin(sure, gd__guide_lower(guide, growth.from.corner[k]) + growth.from.leg[k]);
    if (!(bound > 0) || sure > bound * (1 - GAP) || coarseness > COARSE) return GD_OK;
    rings->bound = bound;
    rings->slack = (float)(GD_TOL_RING * coarseness);
    enum gd_status status = draw_rings(&growth);
    if (status) gd__rings_clean(rings);
    gd__guide_reset_lower(guide);
    return status;
}
