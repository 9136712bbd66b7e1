#include "field/layout.h"

#include <stdlib.h>

#include "base/prefetch.h"

/* Distances of one field at many points. Most of a query's time is memory latency. Therefore points
 * are sorted in the mesh's order of faces, where neighbours share data, and evaluated in blocks.
 * While one block is evaluated, the data of the next blocks is prefetched, one pointer indirection
 * at a time. */

enum {
    BLOCK = 16,         /* points */
    STEPS = 4,          /* a block is evaluated this many blocks after it was opened */
    RING = 8,           /* blocks in progress; a power of two, more than STEPS */
    CHECK_INTERVAL = 64 /* blocks */
};

/* --- the order -------------------------------------------------------------------------------- */

/* Buckets for sorting points. The bucket of a vertex, an edge or a face is proportional to its
 * number. */
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

/* Sorts points by bucket, stably (counting sort). Writes the numbers of the points to `order`;
 * `start` is scratch with an entry for each bucket and one more. */
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
    double *distance; /* entry i: the distance of point order[i] */
};

/* An all-zero struct is empty. */
struct block {
    uint32_t count, faces;
    const struct gd_point *point[BLOCK];
    uint32_t face[BLOCK]; /* the faces of the points of a block, without repeated neighbours */
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

/* Returns the face in which a point is evaluated. For a point of an edge this is the edge's first
 * face. For a vertex it is GD_NONE, because the distance of a vertex is stored. */
static inline uint32_t face_of(const struct gd_mesh *mesh, const struct gd_point *point)
{
    if (point->kind == GD_POINT_FACE) return point->element;
    if (point->kind == GD_POINT_VERTEX) return GD_NONE;
    uint32_t face = mesh->side_face[2 * point->element];
    return face != GD_NONE ? face : mesh->side_face[2 * point->element + 1];
}

static void prefetch_faces(const struct gd_mesh *mesh, struct block *block)
{
    uint32_t last = GD_NONE;
    for (uint32_t i = 0; i < block->count; i++) {
        uint32_t face = face_of(mesh, block->point[i]);
        if (face == last || face == GD_NONE) continue;
        block->face[block->faces++] = last = face;
        __builtin_prefetch(mesh->face_side[face]);
    }
}

static void prefetch_sides(const struct gd_field *field, struct block *block)
{
    const struct gd_mesh *mesh = field->mesh;
    for (uint32_t i = 0; i < 3 * block->faces; i++) {
        uint32_t side = block->side[i] = mesh->face_side[block->face[i / 3]][i % 3];
        __builtin_prefetch(&mesh->side[side]);
        __builtin_prefetch(&mesh->origin[side]);
        __builtin_prefetch(&field->newest[side >> 1]);
    }
}

/* Prefetches the newest chunks and the origins' distances of a block's sides. */
GD__PREFETCH prefetch_chunks(const struct gd_field *field, const struct block *block)
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
        struct gd__leg_key way;
        gd__field_leg_key(field, block->point[i], &way);
        batch->distance[(uint64_t)number * BLOCK + i] = way.distance > field->reach ? NAN
                                                        : way.kind == GD__LEG_NONE
                                                            ? INFINITY
                                                            : way.distance * field->mesh->unit;
    }
}

/* --- the batch -------------------------------------------------------------------------------- */

static enum gd_status evaluate_batch(const struct batch *batch, const struct gd_control *control)
{
    enum gd_status status = GD_OK;
    struct block blocks[RING] = {0};
    uint32_t end = batch->count / BLOCK + 1 + STEPS;
    for (uint32_t n = 0; n < end && !status; n++) {
        open_block(batch, n, &blocks[n % RING]);
        prefetch_faces(batch->field->mesh, &blocks[(n - 1) % RING]);
        prefetch_sides(batch->field, &blocks[(n - 2) % RING]);
        prefetch_chunks(batch->field, &blocks[(n - 3) % RING]);
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
    status = evaluate_batch(&(struct batch){field, points, count, order, distance}, control);
    for (uint32_t i = 0; i < count && !status; i++) out[order[i]] = distance[i];
    free(distance);
    return status;
}
