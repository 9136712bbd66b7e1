#include "render/depth_buffer.h"

#include <stdlib.h>

/* A position on the surface counts as visible if its depth exceeds the depth of its pixel's sample
 * by at most the following sum: SLACK + AWAY x the face's steepness. */
#define SLACK 1.0 /* pixels of depth */
/* largest distance between a position and its pixel's sample, from corner to corner, in pixels */
#define AWAY     1.5
#define STEEPEST 16.0
#define STEP     0.5 /* distance of tested positions along a line, in pixels */
/* number of tested positions of the shortest piece that keeps its own visibility */
enum { SHORTEST = 6 };

enum gd_status gd__depth_buffer_open(struct gd__depth_buffer *buffer,
                                     const struct gd__raster *raster, struct gd__arena *arena)
{
    size_t pixels = (size_t)raster->width * raster->height;
    *buffer = (struct gd__depth_buffer){.mesh = raster->mesh,
                                        .points = raster->points,
                                        .width = raster->width,
                                        .height = raster->height};
    buffer->depth = gd__arena_large(arena, pixels, sizeof *buffer->depth);
    buffer->face = gd__arena_large(arena, pixels, sizeof *buffer->face);
    return arena->status;
}

void gd__depth_buffer_take(struct gd__depth_buffer *buffer, const struct gd__raster *raster,
                           uint32_t band)
{
    uint32_t grid = raster->grid, width = buffer->width;
    for (uint32_t row = 0; row < raster->rows && band * raster->rows + row < buffer->height; row++)
        for (uint32_t x = 0; x < width; x++) {
            size_t sample =
                ((size_t)row * grid + grid / 2) * width * grid + (size_t)x * grid + grid / 2;
            size_t pixel = (size_t)(band * raster->rows + row) * width + x;
            buffer->depth[pixel] = raster->depth[sample];
            buffer->face[pixel] = raster->face[sample];
        }
}

/* --- one position ----------------------------------------------------------------------------- */

/* Returns the change of a face's depth from pixel to pixel. */
static double steepness(const struct gd__depth_buffer *buffer, uint32_t face)
{
    uint32_t v[3];
    gd__corners(buffer->mesh, face, v);
    const struct gd__screen_point *a = &buffer->points[v[0]], *b = &buffer->points[v[1]],
                                  *c = &buffer->points[v[2]];
    double bx = b->x - a->x, by = b->y - a->y, bz = b->z - a->z, cx = c->x - a->x, cy = c->y - a->y,
           cz = c->z - a->z;
    double steep = hypot(bz * cy - cz * by, cz * bx - bz * cx), flat = fabs(bx * cy - cx * by);
    return steep < STEEPEST * flat ? steep / flat : STEEPEST;
}

static bool hides(const struct gd__depth_buffer *buffer, struct gd__screen_point at)
{
    if (!(at.x >= 0 && at.y >= 0 && at.x < (float)buffer->width && at.y < (float)buffer->height))
        return false;
    size_t pixel = (size_t)at.y * buffer->width + (size_t)at.x;
    if (at.z <= buffer->depth[pixel] + SLACK || buffer->face[pixel] == GD_NONE) return false;
    return at.z > buffer->depth[pixel] + SLACK + AWAY * steepness(buffer, buffer->face[pixel]);
}

/* --- a line in small steps -------------------------------------------------------------------- */

struct look {
    struct gd__screen_point at;
    bool is_hidden;
};

static uint32_t steps_between(const struct gd__screen_point *a, const struct gd__screen_point *b)
{
    return 1 + (uint32_t)(hypot((double)b->x - a->x, (double)b->y - a->y) / STEP);
}

static uint64_t count_looks(const struct gd__screen_point *line, uint32_t count)
{
    uint64_t looks = 1;
    for (uint32_t i = 0; i + 1 < count; i++) looks += steps_between(&line[i], &line[i + 1]);
    return looks;
}

static struct look cover_probe_at(const struct gd__depth_buffer *buffer,
                                  const struct gd__screen_point *a,
                                  const struct gd__screen_point *b, float t)
{
    struct gd__screen_point at = {a->x + t * (b->x - a->x), a->y + t * (b->y - a->y),
                                  a->z + t * (b->z - a->z)};
    return (struct look){at, hides(buffer, at)};
}

static void look_along(const struct gd__depth_buffer *buffer, const struct gd__screen_point *line,
                       uint32_t count, struct look *looks)
{
    for (uint32_t i = 0; i + 1 < count; i++) {
        uint32_t steps = steps_between(&line[i], &line[i + 1]);
        for (uint32_t k = 0; k < steps; k++)
            *looks++ = cover_probe_at(buffer, &line[i], &line[i + 1], (float)k / (float)steps);
    }
    *looks = cover_probe_at(buffer, &line[count - 1], &line[count - 1], 0);
}

static uint64_t end_of_run(const struct look *looks, uint64_t count, uint64_t begin)
{
    uint64_t end = begin + 1;
    while (end < count && looks[end].is_hidden == looks[begin].is_hidden) end++;
    return end;
}

static void cover_turn(struct look *looks, uint64_t begin, uint64_t end)
{
    for (uint64_t i = begin; i < end; i++) looks[i].is_hidden = !looks[i].is_hidden;
}

/* Gives short pieces the visibility of their neighbours: first short hidden pieces, then short
 * visible ones. */
static void calm(struct look *looks, uint64_t count)
{
    for (int hidden = 1; hidden >= 0; hidden--)
        for (uint64_t begin = 0, end; begin < count; begin = end) {
            end = end_of_run(looks, count, begin);
            if (looks[begin].is_hidden == hidden && end - begin < SHORTEST && begin > 0 &&
                end < count)
                cover_turn(looks, begin, end);
        }
}

/* Emits the hidden or the visible pieces as lines. Neighbouring pieces share an end. */
static void cover_emit(const struct look *looks, uint64_t count, bool hidden, struct gd__lines *out)
{
    for (uint64_t begin = 0, end; begin < count; begin = end) {
        end = end_of_run(looks, count, begin);
        if (looks[begin].is_hidden != hidden) continue;
        for (uint64_t i = begin; i < end + (end < count); i++)
            gd__lines_add(out, looks[i].at.x, looks[i].at.y);
        gd__lines_end(out);
        gd__lines_simplify(out, 0.1);
    }
}

size_t gd__depth_buffer_split_bytes(const struct gd__screen_point *line, uint32_t count)
{
    return count_looks(line, count) * sizeof(struct look);
}

enum gd_status gd__depth_buffer_split(const struct gd__depth_buffer *buffer,
                                      const struct gd__screen_point *line, uint32_t count,
                                      struct gd__lines *seen, struct gd__lines *hidden)
{
    uint64_t looks_count = count_looks(line, count);
    struct look *looks = malloc(looks_count * sizeof *looks);
    if (!looks) return GD_NO_MEMORY;
    look_along(buffer, line, count, looks);
    calm(looks, looks_count);
    cover_emit(looks, looks_count, false, seen);
    if (hidden) cover_emit(looks, looks_count, true, hidden);
    free(looks);
    return seen->status ? seen->status : hidden ? hidden->status : GD_OK;
}

double gd__depth_buffer_visibility(const struct gd__depth_buffer *buffer,
                                   const struct gd__screen_point *line, uint32_t count)
{
    uint64_t looks = 1, seen = !hides(buffer, line[count - 1]);
    for (uint32_t i = 0; i + 1 < count; i++) {
        uint32_t steps = steps_between(&line[i], &line[i + 1]);
        for (uint32_t k = 0; k < steps; k++)
            seen +=
                !cover_probe_at(buffer, &line[i], &line[i + 1], (float)k / (float)steps).is_hidden;
        looks += steps;
    }
    return (double)seen / (double)looks;
}
