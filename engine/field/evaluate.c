#include "field/layout.h"

#include <stdlib.h>

/* Distances of one field at many points. Most of a query is waiting for memory that nobody asked
 * for in time. So the points are taken in the order in which the mesh keeps its faces, where
 * neighbours share what they read, and in blocks: while one block is evaluated, the next ones ask
 * for what they will need, one step after the other, as each step needs what the one before it
 * asked for. */

enum {
    BLOCK = 16,         /* points */
    STEPS = 4,          /* by which a block is ahead when it is opened */
    RING = 8,           /* blocks in work; a power of two, more than STEPS */
    CHECK_INTERVAL = 64 /* blocks */
};

/* --- the order -------------------------------------------------------------------------------- */

/* Where points lie on the surface, as the mesh keeps it: one of so many places. Elements of each
 * kind are numbered along it. */
struct places {
    uint32_t count;
    double per_element[3];
};

static struct places places_of(const struct gd_mesh *mesh, uint32_t points)
{
    uint32_t count = mesh->face_count < points ? mesh->face_count : points;
    return (struct places){.count = count,
                           .per_element = {[GD_POINT_VERTEX] = (double)count / mesh->vertex_count,
                                           [GD_POINT_EDGE] = (double)count / mesh->edge_count,
                                           [GD_POINT_FACE] = (double)count / mesh->face_count}};
}

static inline uint32_t place_of(const struct places *places, const struct gd_point *point)
{
    return (uint32_t)(point->element * places->per_element[point->kind]);
}

/* Counting sort: `order` becomes the points' numbers by place, those of one place as they came;
 * `start`: count + 1 of the places. */
static void sort_points(const struct places *places, const struct gd_point *points, uint32_t count,
                        uint32_t *start, uint32_t *order)
{
    for (uint32_t i = 0; i <= places->count; i++) start[i] = 0;
    for (uint32_t i = 0; i < count; i++) start[place_of(places, &points[i]) + 1]++;
    for (uint32_t i = 0; i < places->count; i++) start[i + 1] += start[i];
    for (uint32_t i = 0; i < count; i++) order[start[place_of(places, &points[i])]++] = i;
}

/* --- blocks ----------------------------------------------------------------------------------- */

struct batch {
    const struct gd_field *field;
    const struct gd_point *points;
    uint32_t count;
    const uint32_t *order;
    double *distance; /* in that order */
};

/* All zero is empty. */
struct block {
    uint32_t count, faces;
    const struct gd_point *point[BLOCK];
    uint32_t face[BLOCK]; /* in which they lie, so many; without neighbours that are the same */
    uint32_t side[3 * BLOCK];
};

static void open_block(const struct batch *batch, uint32_t number, struct block *block)
{
    uint64_t first = (uint64_t)number * BLOCK,
             left = first < batch->count ? batch->count - first : 0;
    block->count = left < BLOCK ? (uint32_t)left : BLOCK;
    block->faces = 0;
    for (uint32_t i = 0; i < block->count; i++) {
        const struct gd_point *point = block->point[i] = &batch->points[batch->order[first + i]];
        __builtin_prefetch(point);
        __builtin_prefetch((const char *)(point + 1) - 1);
    }
}

/* The face of a point that asks: for an edge's point the first one, for a vertex, whose distance is
 * at hand, GD_NONE. */
static inline uint32_t face_of(const struct gd_mesh *mesh, const struct gd_point *point)
{
    if (point->kind == GD_POINT_FACE) return point->element;
    if (point->kind == GD_POINT_VERTEX) return GD_NONE;
    uint32_t face = mesh->side_face[2 * point->element];
    return face != GD_NONE ? face : mesh->side_face[2 * point->element + 1];
}

static void ask_for_faces(const struct gd_mesh *mesh, struct block *block)
{
    uint32_t last = GD_NONE;
    for (uint32_t i = 0; i < block->count; i++) {
        uint32_t face = face_of(mesh, block->point[i]);
        if (face == last || face == GD_NONE) continue;
        block->face[block->faces++] = last = face;
        __builtin_prefetch(mesh->face_side[face]);
    }
}

static void ask_for_sides(const struct gd_field *field, struct block *block)
{
    const struct gd_mesh *mesh = field->mesh;
    for (uint32_t i = 0; i < 3 * block->faces; i++) {
        uint32_t side = block->side[i] = mesh->face_side[block->face[i / 3]][i % 3];
        __builtin_prefetch(&mesh->side[side]);
        __builtin_prefetch(&mesh->origin[side]);
        __builtin_prefetch(&field->newest[side >> 1]);
    }
}

/* GCC takes a function that does nothing but prefetch for one without effects and leaves its calls
 * out, unless it is inlined first. */
static inline __attribute__((always_inline)) void ask_for_chunks(const struct gd_field *field,
                                                                 const struct block *block)
{
    for (uint32_t i = 0; i < 3 * block->faces; i++) {
        uint32_t newest = field->newest[block->side[i] >> 1];
        __builtin_prefetch(&field->distance[field->mesh->origin[block->side[i]]]);
        if (newest != GD_NONE) __builtin_prefetch(gd__field_chunk(field, newest));
    }
}

static void evaluate_block(const struct batch *batch, uint32_t number, const struct block *block)
{
    const struct gd_field *field = batch->field;
    for (uint32_t i = 0; i < block->count; i++) {
        struct gd__way way;
        gd__field_way(field, block->point[i], &way);
        batch->distance[(uint64_t)number * BLOCK + i] = way.distance > field->reach ? NAN
                                                        : way.kind == GD__LEG_NONE
                                                            ? INFINITY
                                                            : way.distance * field->mesh->unit;
    }
}

/* --- the batch -------------------------------------------------------------------------------- */

static enum gd_status evaluate(const struct batch *batch, const struct gd_control *control)
{
    enum gd_status status = GD_OK;
    struct block blocks[RING] = {0};
    uint32_t end = batch->count / BLOCK + 1 + STEPS;
    for (uint32_t n = 0; n < end && !status; n++) {
        open_block(batch, n, &blocks[n % RING]);
        ask_for_faces(batch->field->mesh, &blocks[(n - 1) % RING]);
        ask_for_sides(batch->field, &blocks[(n - 2) % RING]);
        ask_for_chunks(batch->field, &blocks[(n - 3) % RING]);
        if (n >= STEPS) evaluate_block(batch, n - STEPS, &blocks[(n - STEPS) % RING]);
        if (n % CHECK_INTERVAL == 0) status = gd_control_check(control, (double)n / end);
    }
    return status;
}

enum gd_status gd_field_distances(const struct gd_field *field, const struct gd_point *points,
                                  uint32_t count, const struct gd_control *control, double *out)
{
    if (!count) return GD_OK;
    struct places places = places_of(field->mesh, count);
    size_t bytes = sizeof(double) * count + sizeof(uint32_t) * ((size_t)count + places.count + 1);
    enum gd_status status = gd_control_afford(control, bytes);
    if (status) return status;
    double *distance = malloc(bytes);
    if (!distance) return GD_NO_MEMORY;
    uint32_t *order = (uint32_t *)(distance + count), *start = order + count;
    sort_points(&places, points, count, start, order);
    status = evaluate(&(struct batch){field, points, count, order, distance}, control);
    for (uint32_t i = 0; i < count && !status; i++) out[order[i]] = distance[i];
    free(distance);
    return status;
}
