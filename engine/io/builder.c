#include "io/builder.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/large.h"

/* Largest allowed value of a limit. A polygon of n corners counts as n - 2 triangles, so there are
 * at most 3 x 2^30 corners, and every index of a corner has at most 32 bits. */
#define LARGEST_LIMIT (UINT32_C(1) << 30)

#define SMALLEST_CAPACITY 64

/* Bytes of input between two checks of the control. Text is read at 100 bytes a microsecond or
 * more. */
#define LOOK_BYTES 65536

/* All doubles of at least this size are whole numbers. Larger indices are clamped to this value,
 * which fits in a 64-bit integer. */
#define LARGEST_WHOLE 0x1p53

static uint32_t effective_limit(uint32_t limit)
{
    return limit == 0 || limit > LARGEST_LIMIT ? LARGEST_LIMIT : limit;
}

struct gd__builder gd__builder_begin(const struct gd__scan *scan,
                                     const struct gd_read_options *limits)
{
    struct gd_read_options wanted = limits ? *limits : (struct gd_read_options){0};
    return (struct gd__builder){
        .scan = scan,
        .limits = {.max_faces = effective_limit(wanted.max_faces),
                   .max_vertices = effective_limit(wanted.max_vertices),
                   .skipped = wanted.skipped,
                   .control = wanted.control},
        .next_look = scan->at,
    };
}

void gd__builder_free(struct gd__builder *builder)
{
    free(builder->positions);
    free(builder->corners);
    free(builder->first);
    *builder = (struct gd__builder){0};
}

static enum gd_status no_memory(const struct gd__builder *builder)
{
    return gd_fail_status(builder->scan->detail, GD_NO_MEMORY);
}

/* Resizes the array whose pointer is stored at the address `array` to `wanted` items. Returns false
 * if there is no memory; the array is then unchanged. */
static bool resize(void *array, size_t *capacity, size_t wanted, size_t item)
{
    void *items;
    size_t bytes;
    memcpy(&items, array, sizeof items);
    if (__builtin_mul_overflow(wanted, item, &bytes)) return false;
    items = items ? realloc(items, bytes) : gd__large_array(wanted, item);
    if (!items) return false;
    memcpy(array, &items, sizeof items);
    *capacity = wanted;
    return true;
}

static size_t grown(size_t capacity)
{
    return capacity < SMALLEST_CAPACITY ? SMALLEST_CAPACITY : capacity + capacity / 2;
}

static bool resize_positions(struct gd__builder *builder, size_t capacity)
{
    return resize(&builder->positions, &builder->position_capacity, capacity,
                  sizeof *builder->positions);
}

static bool resize_corners(struct gd__builder *builder, size_t capacity)
{
    return resize(&builder->corners, &builder->corner_capacity, capacity, sizeof *builder->corners);
}

static bool resize_first(struct gd__builder *builder, size_t capacity)
{
    return resize(&builder->first, &builder->first_capacity, capacity, sizeof *builder->first);
}

struct gd__pace gd__builder_pace(const struct gd__builder *builder)
{
    return (struct gd__pace){.control = builder->limits.control, .fraction = builder->done};
}

static enum gd_status look(struct gd__builder *builder)
{
    const struct gd__scan *scan = builder->scan;
    size_t left = gd__scan_left(scan), size = (size_t)(scan->end - scan->begin);
    double done = (double)(size - left) / (double)size;
    builder->next_look = scan->at + (left < LOOK_BYTES ? left : LOOK_BYTES);
    if (done > builder->done) builder->done = done;
    return gd_control_check(builder->limits.control, builder->done);
}

enum gd_status gd__builder_look(struct gd__builder *builder)
{
    return builder->scan->at < builder->next_look ? GD_OK : look(builder);
}

static enum gd_status too_many_vertices(const struct gd__builder *builder, const char *at)
{
    return gd__scan_fail(builder->scan, at, GD_TOO_LARGE,
                         "more than %u vertices, the configured maximum",
                         builder->limits.max_vertices);
}

static enum gd_status too_many_faces(const struct gd__builder *builder, const char *at)
{
    return gd__scan_fail(builder->scan, at, GD_TOO_LARGE,
                         "more than %u triangles, the configured maximum",
                         builder->limits.max_faces);
}

enum gd_status gd__builder_reserve(struct gd__builder *builder, uint64_t positions,
                                   uint64_t polygons)
{
    const char *at = builder->scan->at;
    if (positions > builder->limits.max_vertices) return too_many_vertices(builder, at);
    if (polygons > builder->limits.max_faces) return too_many_faces(builder, at);
    if (positions > builder->position_capacity && !resize_positions(builder, positions))
        return no_memory(builder);
    if (3 * polygons > builder->corner_capacity && !resize_corners(builder, 3 * polygons))
        return no_memory(builder);
    return GD_OK;
}

enum gd_status gd__builder_add_position(struct gd__builder *builder, const double xyz[3],
                                        const char *at)
{
    if (!isfinite(xyz[0]) || !isfinite(xyz[1]) || !isfinite(xyz[2])) {
        return gd__scan_fail(builder->scan, at, GD_NON_FINITE,
                             "a coordinate of vertex %zu is not a finite number",
                             builder->position_count + builder->index_base);
    }
    if (builder->position_count == builder->limits.max_vertices)
        return too_many_vertices(builder, at);
    if (builder->position_count == builder->position_capacity &&
        !resize_positions(builder, grown(builder->position_capacity))) {
        return no_memory(builder);
    }
    double *position = builder->positions[builder->position_count++];
    for (int axis = 0; axis < 3; axis++) position[axis] = xyz[axis];
    return gd__builder_look(builder);
}

enum gd_status gd__builder_add_corner(struct gd__builder *builder, uint64_t vertex, const char *at)
{
    if (builder->corner_count == builder->corner_capacity &&
        !resize_corners(builder, grown(builder->corner_capacity))) {
        return no_memory(builder);
    }
    if (!builder->last_vertex_at || vertex > builder->last_vertex) {
        builder->last_vertex = vertex;
        builder->last_vertex_at = at;
    }
    builder->corners[builder->corner_count++] = vertex < GD_NONE ? (uint32_t)vertex : GD_NONE;
    return gd__builder_look(builder);
}

enum gd_status gd__builder_add_index(struct gd__builder *builder, double index, const char *at)
{
    if (index != floor(index))
        return gd__scan_fail(builder->scan, at, GD_SYNTAX,
                             "the vertex index %g is not a whole number", index);
    double number = fmin(fmax(index, -LARGEST_WHOLE), LARGEST_WHOLE);
    if (index < 0) return gd__builder_no_such_vertex(builder, (long long)number, at);
    return gd__builder_add_corner(builder, (uint64_t)number, at);
}

/* Allocates `first`, and fills it for the polygons that were closed so far, which are all
 * triangles. */
static bool begin_first(struct gd__builder *builder)
{
    if (!resize_first(builder, grown(builder->polygon_count))) return false;
    for (size_t polygon = 0; polygon < builder->polygon_count; polygon++)
        builder->first[polygon] = (uint32_t)(3 * polygon);
    return true;
}

/* Stores the first corner of the open polygon, unless all polygons are triangles. */
static bool keep_first(struct gd__builder *builder)
{
    bool triangle = builder->corner_count - builder->open == 3;
    if (!builder->first && triangle) return true;
    if (!builder->first && !begin_first(builder)) return false;
    if (builder->polygon_count == builder->first_capacity &&
        !resize_first(builder, grown(builder->first_capacity)))
        return false;
    builder->first[builder->polygon_count] = (uint32_t)builder->open;
    return true;
}

enum gd_status gd__builder_skip(struct gd__builder *builder, const char *at, enum gd_status status,
                                const char *format, ...)
{
    const struct gd__scan *scan = builder->scan;
    struct gd_mended *skipped = builder->limits.skipped;
    if (skipped) {
        /* gd__scan_place reads the input up to `at`, so it is called only for elements that are
           listed */
        uint64_t place = skipped->listed < GD_MENDED_LISTED ? gd__scan_place(scan, at) : 0;
        gd_mended_add(skipped, place < UINT32_MAX ? (uint32_t)place : UINT32_MAX, 0);
        return GD_OK;
    }
    char sentence[GD_DETAIL_TEXT];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(sentence, sizeof sentence, format, arguments);
    va_end(arguments);
    return gd__scan_fail(scan, at, status, "%s (repair=split skips it)", sentence);
}

enum gd_status gd__builder_close_polygon(struct gd__builder *builder, const char *at)
{
    size_t corners = builder->corner_count - builder->open;
    if (corners < 3) {
        builder->corner_count = builder->open;
        return gd__builder_skip(builder, at, GD_SYNTAX,
                                "a face has %zu corners; it needs at least three", corners);
    }
    builder->triangles += corners - 2;
    if (builder->triangles > builder->limits.max_faces) return too_many_faces(builder, at);
    if (!keep_first(builder)) return no_memory(builder);
    builder->polygon_count++;
    builder->open = builder->corner_count;
    return GD_OK;
}

enum gd_status gd__builder_no_such_vertex(const struct gd__builder *builder, long long number,
                                          const char *at)
{
    return gd__scan_fail(builder->scan, at, GD_INDEX,
                         "a face refers to vertex %lld, but there are only %zu, counted from %u",
                         number, builder->position_count, builder->index_base);
}

/* Appends the first corners of the polygons of a part, unless all polygons are triangles. */
static bool append_first(struct gd__builder *builder, const struct gd__builder *part)
{
    size_t polygons = builder->polygon_count + part->polygon_count;
    if (!builder->first && !part->first) return true;
    if (!builder->first && !begin_first(builder)) return false;
    if (polygons > builder->first_capacity && !resize_first(builder, polygons)) return false;
    uint32_t *first = builder->first + builder->polygon_count;
    for (size_t i = 0; i < part->polygon_count; i++)
        first[i] = (uint32_t)(builder->corner_count + (part->first ? part->first[i] : 3 * i));
    return true;
}

bool gd__builder_append(struct gd__builder *builder, const struct gd__builder *part)
{
    size_t positions = builder->position_count + part->position_count;
    size_t corners = builder->corner_count + part->corner_count;
    if (positions > builder->limits.max_vertices) return false;
    if (builder->triangles + part->triangles > builder->limits.max_faces) return false;
    if (positions > builder->position_capacity && !resize_positions(builder, positions))
        return false;
    if (corners > builder->corner_capacity && !resize_corners(builder, corners)) return false;
    if (!append_first(builder, part)) return false;
    if (part->position_count)
        memcpy(builder->positions + builder->position_count, part->positions,
               part->position_count * sizeof *part->positions);
    if (part->corner_count)
        memcpy(builder->corners + builder->corner_count, part->corners,
               part->corner_count * sizeof *part->corners);
    if (part->last_vertex_at &&
        (!builder->last_vertex_at || part->last_vertex > builder->last_vertex)) {
        builder->last_vertex = part->last_vertex;
        builder->last_vertex_at = part->last_vertex_at;
    }
    builder->position_count = positions;
    builder->open = builder->corner_count = corners;
    builder->polygon_count += part->polygon_count;
    builder->triangles += part->triangles;
    return true;
}

enum gd_status gd__builder_finish(struct gd__builder *builder, struct gd_polygons *out)
{
    if (builder->polygon_count == 0)
        return gd_fail(builder->scan->detail, GD_EMPTY, "the input has no faces");
    if (builder->last_vertex >= builder->position_count) {
        return gd__builder_no_such_vertex(builder,
                                          (long long)(builder->last_vertex + builder->index_base),
                                          builder->last_vertex_at);
    }
    if (builder->first) {
        if (builder->polygon_count == builder->first_capacity &&
            !resize_first(builder, builder->polygon_count + 1)) {
            return no_memory(builder);
        }
        builder->first[builder->polygon_count] = (uint32_t)builder->corner_count;
    }
    /* if the arrays can't be shrunk to their length, they remain valid */
    (void)resize_positions(builder, builder->position_count);
    (void)resize_corners(builder, builder->corner_count);
    if (builder->first) (void)resize_first(builder, builder->polygon_count + 1);
    *out = (struct gd_polygons){
        .positions = builder->positions,
        .position_count = (uint32_t)builder->position_count,
        .polygon_count = (uint32_t)builder->polygon_count,
        .corners = builder->corners,
        .first = builder->first,
    };
    builder->positions = NULL;
    builder->corners = NULL;
    builder->first = NULL;
    gd__builder_free(builder);
    return GD_OK;
}
