#include "tests/samples/remesh.h"

#include <math.h>
#include <stdlib.h>

#include "gd/vec.h"
#include "tests/samples/random.h"
#include "tests/samples/surface.h"
#include "tests/samples/transform.h"

/* --- a heap of edges by cost; stale entries are skipped when popped --------------------------- */

struct candidate {
    double cost;
    uint32_t slot;
    uint32_t age[2]; /* ages of both ends when the candidate was queued */
};

struct decimation {
    struct surface *surface;
    const struct remeshing *remeshing;
    uint64_t seed;
    uint32_t *age; /* number of moves of each vertex */
    struct candidate *heap;
    size_t count, capacity;
    bool failed; /* out of memory */
};

static void push(struct decimation *d, struct candidate candidate)
{
    if (d->count == d->capacity) {
        struct candidate *grown = realloc(d->heap, 2 * d->capacity * sizeof *grown);
        if (!grown) {
            d->failed = true;
            return;
        }
        d->heap = grown;
        d->capacity *= 2;
    }
    size_t at = d->count++;
    for (; at > 0 && d->heap[(at - 1) / 2].cost > candidate.cost; at = (at - 1) / 2)
        d->heap[at] = d->heap[(at - 1) / 2];
    d->heap[at] = candidate;
}

static struct candidate pop(struct decimation *d)
{
    struct candidate top = d->heap[0], last = d->heap[--d->count];
    size_t at = 0;
    for (size_t child; (child = 2 * at + 1) < d->count; at = child) {
        if (child + 1 < d->count && d->heap[child + 1].cost < d->heap[child].cost) child++;
        if (d->heap[child].cost >= last.cost) break;
        d->heap[at] = d->heap[child];
    }
    d->heap[at] = last;
    return top;
}

/* --- decimation ------------------------------------------------------------------------------- */

/* Returns the factor by which edges near the slot's edge are to be shorter than in other places. */
static double density(const struct decimation *d, uint32_t slot)
{
    uint32_t vertex = d->surface->corners[slot];
    const double *p = d->surface->positions[vertex];
    double wave = sin(3 * p[0] + 1) * sin(3 * p[1] + 2) + 0.5 * sin(4 * p[2]);
    struct rng rng = {d->seed + vertex};
    return exp(d->remeshing->contrast * wave + d->remeshing->noise * rng_between(&rng, -1, 1));
}

static void push_edge(struct decimation *d, uint32_t slot)
{
    uint32_t a = d->surface->corners[slot], b = surface_destination(d->surface, slot);
    double cost = surface_length(d->surface, slot) * density(d, slot);
    push(d, (struct candidate){.cost = cost, .slot = slot, .age = {d->age[a], d->age[b]}});
}

static bool is_current(const struct decimation *d, const struct candidate *candidate)
{
    uint32_t a = d->surface->corners[candidate->slot];
    return a != GD_NONE && d->age[a] == candidate->age[0] &&
           d->age[surface_destination(d->surface, candidate->slot)] == candidate->age[1];
}

static void push_around(struct decimation *d, uint32_t vertex)
{
    uint32_t first = d->surface->outgoing[vertex], slot = first;
    do push_edge(d, slot);
    while ((slot = surface_turn(d->surface, slot)) != first);
}

static enum gd_status decimate(struct surface *surface, const struct remeshing *remeshing,
                               uint64_t seed)
{
    struct decimation d = {
        .surface = surface, .remeshing = remeshing, .seed = seed, .capacity = 1024};
    d.age = calloc(surface->vertex_count + (size_t)1, sizeof *d.age);
    d.heap = malloc(d.capacity * sizeof *d.heap);
    d.failed = !d.age || !d.heap;
    for (uint32_t slot = 0; slot < 3 * surface->face_slots && !d.failed; slot++)
        if (slot < surface->twin[slot]) push_edge(&d, slot);
    while (!d.failed && surface->faces > remeshing->faces && d.count) {
        struct candidate candidate = pop(&d);
        if (!is_current(&d, &candidate)) continue;
        uint32_t kept = surface->corners[candidate.slot];
        if (!surface_collapse(surface, candidate.slot)) continue;
        d.age[kept]++;
        push_around(&d, kept);
    }
    free(d.age);
    free(d.heap);
    if (d.failed) return GD_NO_MEMORY;
    return surface->faces == remeshing->faces ? GD_OK : GD_INVALID_ARGUMENT;
}

/* --- smoothing -------------------------------------------------------------------------------- */

static struct gd_vec3 position_of(const struct surface *surface, uint32_t vertex)
{
    const double *p = surface->positions[vertex];
    return (struct gd_vec3){p[0], p[1], p[2]};
}

/* Returns twice the triangle's area vector. */
static struct gd_vec3 area_vector(struct gd_vec3 a, struct gd_vec3 b, struct gd_vec3 c)
{
    return gd_vec3_cross(gd_vec3_sub(b, a), gd_vec3_sub(c, a));
}

/* Returns whether both faces keep their orientation if the edge is flipped, up to 60 degrees. */
static bool flips_flat(const struct surface *surface, uint32_t slot)
{
    uint32_t twin = surface->twin[slot];
    struct gd_vec3 a = position_of(surface, surface->corners[slot]),
                   b = position_of(surface, surface->corners[twin]),
                   c = position_of(surface, surface_apex(surface, slot)),
                   d = position_of(surface, surface_apex(surface, twin));
    struct gd_vec3 normal = gd_vec3_add(area_vector(a, b, c), area_vector(b, a, d)),
                   one = area_vector(d, b, c), two = area_vector(c, a, d);
    double size = gd_vec3_length(normal);
    return gd_vec3_dot(one, normal) > 0.5 * gd_vec3_length(one) * size &&
           gd_vec3_dot(two, normal) > 0.5 * gd_vec3_length(two) * size;
}

/* Returns whether a flip brings valences closer to six in the sum of squares. */
static bool evens_valences(const struct surface *surface, uint32_t slot)
{
    uint32_t twin = surface->twin[slot];
    return surface_valence(surface, surface->corners[slot]) +
               surface_valence(surface, surface->corners[twin]) >
           surface_valence(surface, surface_apex(surface, slot)) +
               surface_valence(surface, surface_apex(surface, twin)) + 2;
}

static double cotangent(struct gd_vec3 at, struct gd_vec3 a, struct gd_vec3 b)
{
    return gd_vec3_dot(gd_vec3_sub(a, at), gd_vec3_sub(b, at)) /
           gd_vec3_length(area_vector(at, a, b));
}

/* Returns whether the angles opposite to the edge sum to more than pi. */
static bool is_not_delaunay(const struct surface *surface, uint32_t slot)
{
    uint32_t twin = surface->twin[slot];
    struct gd_vec3 a = position_of(surface, surface->corners[slot]),
                   b = position_of(surface, surface->corners[twin]);
    return cotangent(position_of(surface, surface_apex(surface, slot)), a, b) +
               cotangent(position_of(surface, surface_apex(surface, twin)), a, b) <
           -1e-9;
}

static void flip_where(struct surface *surface,
                       bool (*wanted)(const struct surface *surface, uint32_t slot))
{
    for (uint32_t slot = 0; slot < 3 * surface->face_slots; slot++) {
        if (surface->corners[slot] == GD_NONE || slot > surface->twin[slot]) continue;
        if (wanted(surface, slot) && flips_flat(surface, slot))
            (void)surface_flip(surface, slot); /* an edge that can't be flipped stays */
    }
}

/* Moves the vertex to the centroid of its faces, within its tangent plane. */
static void relax_vertex(struct surface *surface, uint32_t vertex)
{
    struct gd_vec3 at = position_of(surface, vertex), sum = {0, 0, 0}, normal = {0, 0, 0};
    uint32_t first = surface->outgoing[vertex], slot = first;
    double total = 0;
    do {
        struct gd_vec3 b = gd_vec3_sub(position_of(surface, surface_destination(surface, slot)),
                                       at),
                       c = gd_vec3_sub(position_of(surface, surface_apex(surface, slot)), at);
        struct gd_vec3 area = gd_vec3_cross(b, c);
        double weight = gd_vec3_length(area);
        sum = gd_vec3_along(sum, weight / 3, gd_vec3_add(b, c));
        normal = gd_vec3_add(normal, area);
        total += weight;
    } while ((slot = surface_turn(surface, slot)) != first);
    struct gd_vec3 step = gd_vec3_scale(sum, 1 / total);
    step = gd_vec3_along(step, -gd_vec3_dot(step, normal) / gd_vec3_dot(normal, normal), normal);
    double *p = surface->positions[vertex];
    p[0] += step.x, p[1] += step.y, p[2] += step.z;
}

static void even_out(struct surface *surface, uint32_t passes)
{
    for (uint32_t pass = 0; pass < passes; pass++) {
        flip_where(surface, pass % 2 ? is_not_delaunay : evens_valences);
        for (uint32_t v = 0; v < surface->vertex_count; v++)
            if (surface->outgoing[v] != GD_NONE) relax_vertex(surface, v);
    }
    if (passes) flip_where(surface, is_not_delaunay);
}

static double mean_edge(const struct gd_polygons *mesh)
{
    double sum = 0;
    for (uint32_t slot = 0; slot < 3 * mesh->polygon_count; slot++) {
        const double *a = mesh->positions[mesh->corners[slot]],
                     *b = mesh->positions[mesh->corners[slot % 3 == 2 ? slot - 2 : slot + 1]];
        sum += sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]) +
                    (b[2] - a[2]) * (b[2] - a[2]));
    }
    return sum / (3.0 * mesh->polygon_count);
}

enum gd_status sample_remesh(struct gd_polygons *mesh, const struct remeshing *remeshing,
                             uint64_t seed)
{
    struct surface surface;
    enum gd_status status = surface_start(mesh, &surface);
    if (status == GD_OK) {
        status = decimate(&surface, remeshing, seed);
        if (status == GD_OK) even_out(&surface, remeshing->passes);
        surface_finish(&surface, mesh);
    }
    if (status == GD_OK)
        sample_jitter(mesh, remeshing->roughness * mean_edge(mesh), seed);
    else
        gd_polygons_free(mesh);
    return status;
}
