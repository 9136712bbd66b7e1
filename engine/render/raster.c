#include "render/raster.h"

#include "base/slices.h"

#define SLACK 1e-3 /* rounding errors of x coordinates are below this, in samples */

enum {
    FACE_WORK = 64,
    CHECK_INTERVAL = 1 << 18 /* samples */
};

/* --- the rows of a face ----------------------------------------------------------------------- */

/* Returns the number of sample rows, or of samples in a row, below a coordinate; at most `most`. */
static inline uint32_t samples_below(double coordinate, uint32_t most)
{
    double least = coordinate - 0.5;
    if (least <= 0) return 0;
    if (least >= most) return most;
    uint32_t count = (uint32_t)least;
    return count + (count < least);
}

/* fminf and fmaxf would be calls of the library */
static float least_of(float a, float b, float c)
{
    float least = a < b ? a : b;
    return least < c ? least : c;
}

static float most_of(float a, float b, float c)
{
    float most = a > b ? a : b;
    return most > c ? most : c;
}

/* Returns twice the area of a face in the picture; positive if the face is seen from outside. */
static double area_of(const struct gd__screen_point *a, const struct gd__screen_point *b,
                      const struct gd__screen_point *c)
{
    return ((double)c->x - a->x) * ((double)b->y - a->y) -
           ((double)b->x - a->x) * ((double)c->y - a->y);
}

struct rows {
    uint32_t from, to; /* the sample rows [from, to) that a face meets; none if both are equal */
};

/* Returns the rows that a face meets. A face of a closed surface that is seen from behind meets
 * none. */
static struct rows rows_of(const struct gd__raster *raster, uint32_t face)
{
    uint32_t v[3], grid = raster->grid, most = raster->height * grid;
    gd__corners(raster->mesh, face, v);
    const struct gd__screen_point *a = &raster->points[v[0]], *b = &raster->points[v[1]],
                                  *c = &raster->points[v[2]];
    if (raster->is_closed && area_of(a, b, c) <= 0) return (struct rows){0, 0};
    return (struct rows){samples_below((double)least_of(a->y, b->y, c->y) * grid, most),
                         samples_below((double)most_of(a->y, b->y, c->y) * grid, most)};
}

/* --- one face --------------------------------------------------------------------------------- */

/* A projected face. a, b, c are its corners from top to bottom. */
struct patch {
    struct gd__screen_point a, b, c;
    float low, high; /* range of the corners' depths */
    double along_x, along_y;
};

static void exchange_if(struct gd__screen_point *above, struct gd__screen_point *below_it)
{
    if (above->y <= below_it->y) return;
    struct gd__screen_point point = *above;
    *above = *below_it;
    *below_it = point;
}

/* Returns true if no sample of any row lies between two x coordinates. */
static bool is_between_samples(const struct gd__raster *raster, float left, float right)
{
    double grid = raster->grid, shift = (grid - 1) / (2 * grid) + SLACK;
    uint32_t most = raster->width * raster->grid;
    return samples_below(left * grid - shift, most) == samples_below(right * grid + shift, most);
}

/* Computes the patch of a face. Returns false if the face covers no samples. */
static bool make_patch(const struct gd__raster *raster, uint32_t face, struct patch *out)
{
    uint32_t v[3];
    gd__corners(raster->mesh, face, v);
    struct gd__screen_point a = raster->points[v[0]], b = raster->points[v[1]],
                            c = raster->points[v[2]];
    if (is_between_samples(raster, least_of(a.x, b.x, c.x), most_of(a.x, b.x, c.x))) return false;
    exchange_if(&a, &b);
    exchange_if(&b, &c);
    exchange_if(&a, &b);
    double bx = (double)b.x - a.x, by = (double)b.y - a.y, cx = (double)c.x - a.x,
           cy = (double)c.y - a.y;
    double area = bx * cy - cx * by, bz = (double)b.z - a.z, cz = (double)c.z - a.z;
    if (area == 0) return false;
    *out = (struct patch){a,
                          b,
                          c,
                          least_of(a.z, b.z, c.z),
                          most_of(a.z, b.z, c.z),
                          (bz * cy - cz * by) / area,
                          (cz * bx - bz * cx) / area};
    return true;
}

/* Returns the x coordinate at height y of the edge from p down to q. The result is the same to the
 * last bit for both faces of the edge. */
static double edge_at(struct gd__screen_point p, struct gd__screen_point q, double y)
{
    return p.x + (y - p.y) * (((double)q.x - p.x) / ((double)q.y - p.y));
}

/* Fills a row of samples; returns the number of samples visited. */
static uint32_t fill_row(struct gd__raster *raster, const struct patch *patch, uint32_t face,
                         uint32_t row, uint32_t first_row)
{
    uint32_t grid = raster->grid, most = raster->width * grid;
    double y = (row + 0.5) / grid, shift = gd__raster_shift(grid, row),
           long_edge = edge_at(patch->a, patch->c, y),
           short_edge =
               y < patch->b.y ? edge_at(patch->a, patch->b, y) : edge_at(patch->b, patch->c, y);
    bool is_left = long_edge < short_edge;
    uint32_t from = samples_below((is_left ? long_edge : short_edge) * grid - shift, most),
             to = samples_below((is_left ? short_edge : long_edge) * grid - shift, most);
    size_t row_start = (size_t)(row - first_row) * most;
    float *depth = raster->depth + row_start;
    uint32_t *faces = raster->face + row_start;
    float step = (float)(patch->along_x / grid),
          start = (float)(patch->a.z + patch->along_x * ((from + 0.5 + shift) / grid - patch->a.x) +
                          patch->along_y * (y - patch->a.y));
    for (uint32_t i = from; i < to; i++) {
        float z = start + step * (float)(i - from);
        z = z < patch->low ? patch->low : z > patch->high ? patch->high : z;
        if (z < depth[i]) {
            depth[i] = z;
            faces[i] = face;
        }
    }
    return to - from;
}

static uint32_t fill_face(struct gd__raster *raster, uint32_t face, uint32_t first_row,
                          uint32_t end_row)
{
    struct patch patch;
    struct rows rows = rows_of(raster, face);
    uint32_t samples = 0;
    if (rows.from < first_row) rows.from = first_row;
    if (rows.to > end_row) rows.to = end_row;
    if (rows.from >= rows.to || !make_patch(raster, face, &patch)) return 0;
    for (uint32_t row = rows.from; row < rows.to; row++)
        samples += fill_row(raster, &patch, face, row, first_row);
    return samples;
}

enum gd_status gd__raster_fill(struct gd__raster *raster, uint32_t band,
                               const struct gd_control *control)
{
    enum gd_status status = GD_OK;
    uint32_t first_row = band * raster->rows * raster->grid,
             end_row = first_row + raster->rows * raster->grid, work = 0;
    const uint32_t *faces = raster->faces;
    uint32_t first = faces ? raster->first[band] : 0,
             end = faces ? raster->first[band + 1] : raster->mesh->face_count;
    if (end_row > raster->height * raster->grid) end_row = raster->height * raster->grid;
    size_t samples = (size_t)(end_row - first_row) * raster->width * raster->grid;
    for (size_t i = 0; i < samples; i++) {
        raster->depth[i] = INFINITY;
        raster->face[i] = GD_NONE;
    }
    for (uint32_t i = first; i < end && !status; i++) {
        work += FACE_WORK + fill_face(raster, faces ? faces[i] : i, first_row, end_row);
        if (work < CHECK_INTERVAL) continue;
        status = gd_control_check(control, (double)(i - first) / (end - first));
        work = 0;
    }
    return status;
}

/* --- the bands' faces ------------------------------------------------------------------------- */

struct span {
    uint16_t from, to; /* the bands [from, to) that the face meets; none if both are equal */
};

struct listing {
    const struct gd__raster *raster;
    struct span *spans; /* per face */
};

static void find_spans(void *context, struct gd__pace *pace, uint32_t begin, uint32_t end)
{
    const struct listing *listing = context;
    uint32_t height = listing->raster->rows * listing->raster->grid;
    (void)pace;
    for (uint32_t f = begin; f < end; f++) {
        struct rows rows = rows_of(listing->raster, f);
        listing->spans[f] = rows.from == rows.to
                                ? (struct span){0, 0}
                                : (struct span){(uint16_t)(rows.from / height),
                                                (uint16_t)((rows.to - 1) / height + 1)};
    }
}

/* Lists the faces of each band, by a counting sort. */
static enum gd_status sort_faces(struct gd__raster *raster, const struct span *spans,
                                 struct gd__arena *arena, struct gd__pace *pace)
{
    uint32_t *next = raster->first, faces = raster->mesh->face_count;
    uint64_t total = 0;
    for (uint32_t b = 0; b <= raster->bands; b++) next[b] = 0;
    GD__PACED (pace, f, faces) {
        for (uint32_t b = spans[f].from; b < spans[f].to; b++) next[b]++;
        total += (uint32_t)(spans[f].to - spans[f].from);
    }
    if (pace->status) return pace->status;
    if (total > UINT32_MAX) return GD_NO_MEMORY;
    raster->faces = gd__arena_take(arena, total + 1, sizeof *raster->faces);
    if (!raster->faces) return arena->status;
    for (uint32_t b = 1; b <= raster->bands; b++) next[b] += next[b - 1];
    GD__PACED (pace, i, faces) {
        const struct span *span = &spans[faces - 1 - i];
        for (uint32_t b = span->from; b < span->to; b++) raster->faces[--next[b]] = faces - 1 - i;
    }
    return pace->status;
}

static enum gd_status list_faces(struct gd__raster *raster, struct gd__arena *arena,
                                 const struct gd_control *control)
{
    struct gd__pace pace = {.control = control};
    struct gd__arena scratch = {.budget = arena->budget};
    uint32_t faces = raster->mesh->face_count;
    struct listing listing = {raster, gd__arena_take(&scratch, faces, sizeof *listing.spans)};
    enum gd_status status = scratch.status;
    if (!status) {
        gd__slices_run(&pace, faces, find_spans, &listing);
        status = pace.status;
    }
    if (!status) status = sort_faces(raster, listing.spans, arena, &pace);
    gd__arena_free(&scratch);
    return status;
}

/* --- life ------------------------------------------------------------------------------------- */

static void samples_open(struct gd__raster *raster, struct gd__arena *arena)
{
    size_t samples = (size_t)raster->rows * raster->width * raster->grid * raster->grid;
    raster->depth = gd__arena_large(arena, samples, sizeof *raster->depth);
    raster->face = gd__arena_large(arena, samples, sizeof *raster->face);
}

struct gd__raster gd__raster_copy(const struct gd__raster *raster, struct gd__arena *arena)
{
    struct gd__raster copy = *raster;
    samples_open(&copy, arena);
    return copy;
}

enum gd_status gd__raster_open(struct gd__raster *raster, struct gd__arena *arena,
                               const struct gd_control *control)
{
    if (raster->rows > raster->height) raster->rows = raster->height;
    raster->bands = (raster->height + raster->rows - 1) / raster->rows;
    raster->is_closed = gd_mesh_summary(raster->mesh)->boundaries == 0;
    raster->first = gd__arena_take(arena, raster->bands + (size_t)1, sizeof *raster->first);
    samples_open(raster, arena);
    if (arena->status) return arena->status;
    return raster->bands > 1 ? list_faces(raster, arena, control) : GD_OK;
}
