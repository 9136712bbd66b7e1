#include "render/cover.h"

#include <stdlib.h>

#include "base/large.h"

/* A place of a face is as deep as the sample of its pixel but for what the face rises between both:
 * up to a pixel and a half of its steepness. */
#define SLACK    1.0 /* pixels of depth */
#define AWAY     1.5 /* pixels between place and sample, corner to corner */
#define STEEPEST 16.0
#define STEP     0.5   /* pixels between places of a line that are looked at */
enum { SHORTEST = 6 }; /* such places, of a piece */

enum gd_status gd__cover_open(struct gd__cover *cover, const struct gd__raster *raster)
{
    size_t pixels = (size_t)raster->width * raster->height;
    *cover = (struct gd__cover){.mesh = raster->mesh,
                                .spots = raster->spots,
                                .width = raster->width,
                                .height = raster->height};
    enum gd_status status =
        gd__budget_take(raster->budget, pixels * (sizeof *cover->depth + sizeof *cover->face));
    if (status) return status;
    cover->depth = gd__large_array(pixels, sizeof *cover->depth);
    cover->face = gd__large_array(pixels, sizeof *cover->face);
    return cover->depth && cover->face ? GD_OK : GD_NO_MEMORY;
}

void gd__cover_close(struct gd__cover *cover)
{
    free(cover->depth);
    free(cover->face);
}

void gd__cover_take(struct gd__cover *cover, const struct gd__raster *raster, uint32_t band)
{
    uint32_t grid = raster->grid, width = cover->width;
    for (uint32_t row = 0; row < raster->rows && band * raster->rows + row < cover->height; row++)
        for (uint32_t x = 0; x < width; x++) {
            size_t sample =
                ((size_t)row * grid + grid / 2) * width * grid + (size_t)x * grid + grid / 2;
            size_t pixel = (size_t)(band * raster->rows + row) * width + x;
            cover->depth[pixel] = raster->depth[sample];
            cover->face[pixel] = raster->face[sample];
        }
}

/* --- one place -------------------------------------------------------------------------------- */

/* By how much a face's depth changes a pixel. */
static double steepness(const struct gd__cover *cover, uint32_t face)
{
    uint32_t v[3];
    gd__corners(cover->mesh, face, v);
    const struct gd__spot *a = &cover->spots[v[0]], *b = &cover->spots[v[1]],
                          *c = &cover->spots[v[2]];
    double bx = b->x - a->x, by = b->y - a->y, bz = b->z - a->z, cx = c->x - a->x, cy = c->y - a->y,
           cz = c->z - a->z;
    double steep = hypot(bz * cy - cz * by, cz * bx - bz * cx), flat = fabs(bx * cy - cx * by);
    return steep < STEEPEST * flat ? steep / flat : STEEPEST;
}

static bool hides(const struct gd__cover *cover, struct gd__spot at)
{
    if (!(at.x >= 0 && at.y >= 0 && at.x < (float)cover->width && at.y < (float)cover->height))
        return false;
    size_t pixel = (size_t)at.y * cover->width + (size_t)at.x;
    if (at.z <= cover->depth[pixel] + SLACK || cover->face[pixel] == GD_NONE) return false;
    return at.z > cover->depth[pixel] + SLACK + AWAY * steepness(cover, cover->face[pixel]);
}

/* --- a line, looked at in small steps --------------------------------------------------------- */

struct look {
    struct gd__spot at;
    bool is_hidden;
};

static uint32_t steps_between(const struct gd__spot *a, const struct gd__spot *b)
{
    return 1 + (uint32_t)(hypot((double)b->x - a->x, (double)b->y - a->y) / STEP);
}

static uint64_t count_looks(const struct gd__spot *line, uint32_t count)
{
    uint64_t looks = 1;
    for (uint32_t i = 0; i + 1 < count; i++) looks += steps_between(&line[i], &line[i + 1]);
    return looks;
}

static struct look look_at(const struct gd__cover *cover, const struct gd__spot *a,
                           const struct gd__spot *b, float t)
{
    struct gd__spot at = {a->x + t * (b->x - a->x), a->y + t * (b->y - a->y),
                          a->z + t * (b->z - a->z)};
    return (struct look){at, hides(cover, at)};
}

static void look_along(const struct gd__cover *cover, const struct gd__spot *line, uint32_t count,
                       struct look *looks)
{
    for (uint32_t i = 0; i + 1 < count; i++) {
        uint32_t steps = steps_between(&line[i], &line[i + 1]);
        for (uint32_t k = 0; k < steps; k++)
            *looks++ = look_at(cover, &line[i], &line[i + 1], (float)k / (float)steps);
    }
    *looks = look_at(cover, &line[count - 1], &line[count - 1], 0);
}

static uint64_t end_of_run(const struct look *looks, uint64_t count, uint64_t begin)
{
    uint64_t end = begin + 1;
    while (end < count && looks[end].is_hidden == looks[begin].is_hidden) end++;
    return end;
}

static void turn(struct look *looks, uint64_t begin, uint64_t end)
{
    for (uint64_t i = begin; i < end; i++) looks[i].is_hidden = !looks[i].is_hidden;
}

/* Short pieces between others are turned: first hidden ones, then those that are seen. */
static void calm(struct look *looks, uint64_t count)
{
    for (int hidden = 1; hidden >= 0; hidden--)
        for (uint64_t begin = 0, end; begin < count; begin = end) {
            end = end_of_run(looks, count, begin);
            if (looks[begin].is_hidden == hidden && end - begin < SHORTEST && begin > 0 &&
                end < count)
                turn(looks, begin, end);
        }
}

/* Pieces meet where the last place of one is the first of the next. */
static void emit(const struct look *looks, uint64_t count, bool hidden, struct gd__lines *out)
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

enum gd_status gd__cover_split(const struct gd__cover *cover, const struct gd__spot *line,
                               uint32_t count, struct gd__lines *seen, struct gd__lines *hidden)
{
    uint64_t looks_count = count_looks(line, count);
    struct look *looks = malloc(looks_count * sizeof *looks);
    if (!looks) return GD_NO_MEMORY;
    look_along(cover, line, count, looks);
    calm(looks, looks_count);
    emit(looks, looks_count, false, seen);
    if (hidden) emit(looks, looks_count, true, hidden);
    free(looks);
    return seen->status ? seen->status : hidden ? hidden->status : GD_OK;
}

double gd__cover_visibility(const struct gd__cover *cover, const struct gd__spot *line,
                            uint32_t count)
{
    uint64_t looks = 1, seen = !hides(cover, line[count - 1]);
    for (uint32_t i = 0; i + 1 < count; i++) {
        uint32_t steps = steps_between(&line[i], &line[i + 1]);
        for (uint32_t k = 0; k < steps; k++)
            seen += !look_at(cover, &line[i], &line[i + 1], (float)k / (float)steps).is_hidden;
        looks += steps;
    }
    return (double)seen / (double)looks;
}
