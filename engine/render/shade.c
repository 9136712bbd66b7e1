#include "render/shade.h"

#include "base/slices.h"
#include "mesh/canonical.h"

/* A *fragment* is the part of a pixel that shows one face: all samples of the pixel with that face.
 * A fragment has one colour, computed at the mean position of its samples. Thousands of fragments
 * are coloured at a time, because a field evaluates many distances faster than single ones. */

enum { BATCH = 1 << 14, SAMPLES = 16 };

struct gd__fragment {
    uint32_t pixel; /* number of the pixel in the band */
    uint32_t face;
    float part;      /* fraction of the pixel */
    float weight[3]; /* barycentric coordinates of the fragment's middle in the face */
};

/* --- normals ---------------------------------------------------------------------------------- */

/* Normals for smooth shading with creases. The normal at a corner of a face is a mean of the
 * normals of faces around the vertex. It includes the faces whose normals differ from the face's
 * own normal by less than the crease angle. */

#define CREASE 0.77F /* cosine of 40 degrees: sharper edges between faces stay visible */
enum { MOST = 64 /* limit on faces around a vertex for smooth normals */ };

static struct gd__normal normals_normal_of(const struct gd_mesh *mesh, uint32_t face)
{
    const uint32_t *side = mesh->face_side[face];
    const struct gd_vec3 *position = mesh->position;
    struct gd_vec3 a = position[mesh->origin[side[0]]], b = position[mesh->origin[side[1]]],
                   c = position[mesh->origin[side[2]]];
    struct gd_vec3 n = gd_vec3_cross(gd_vec3_sub(b, a), gd_vec3_sub(c, a));
    n = gd_vec3_scale(n, 1 / gd_vec3_length(n));
    return (struct gd__normal){(float)n.x, (float)n.y, (float)n.z};
}

static float dot(struct gd__normal a, struct gd__normal b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static void normals_add(struct gd__normal *sum, float weight, struct gd__normal n)
{
    sum->x += weight * n.x;
    sum->y += weight * n.y;
    sum->z += weight * n.z;
}

static struct gd__normal *corner_at(const struct gd_mesh *mesh, struct gd__normal (*corners)[3],
                                    uint32_t side)
{
    uint32_t face = mesh->side_face[side];
    const uint32_t *sides = mesh->face_side[face];
    return &corners[face][sides[0] == side ? 0 : sides[1] == side ? 1 : 2];
}

/* Computes the normals of all corners at a vertex, with faces weighted by angle (G. Thuermer and C.
 * Wuethrich, "Computing vertex normals from polygonal facets", 1998). */
static void make_around(const struct gd_mesh *mesh, uint32_t vertex, const struct gd__normal *flat,
                        struct gd__normal (*corners)[3])
{
    const struct gd_fan *fan = mesh->fan + mesh->fan_first[vertex];
    uint32_t count = mesh->fan_first[vertex + 1] - mesh->fan_first[vertex];
    for (uint32_t i = 0; i < count; i++) {
        struct gd__normal own = flat[mesh->side_face[fan[i].side]], sum = {0};
        for (uint32_t k = 0; k < count && count <= MOST; k++) {
            double angle =
                (k + 1 < count ? fan[k + 1].angle : mesh->total_angle[vertex]) - fan[k].angle;
            struct gd__normal other = flat[mesh->side_face[fan[k].side]];
            if (dot(own, other) > CREASE) normals_add(&sum, (float)angle, other);
        }
        *corner_at(mesh, corners, fan[i].side) = dot(sum, own) > 0 ? sum : own;
    }
}

struct normals {
    const struct gd_mesh *mesh;
    struct gd__normal *flat;
    struct gd__normal (*corners)[3];
};

static void make_flat(void *context, struct gd__pace *pace, uint32_t begin, uint32_t end)
{
    const struct normals *normals = context;
    (void)pace;
    for (uint32_t f = begin; f < end; f++) normals->flat[f] = normals_normal_of(normals->mesh, f);
}

static void make_corners(void *context, struct gd__pace *pace, uint32_t begin, uint32_t end)
{
    const struct normals *normals = context;
    (void)pace;
    for (uint32_t v = begin; v < end; v++)
        make_around(normals->mesh, v, normals->flat, normals->corners);
}

/* Fills `corners` with three normals for each face, of any length except 0, and `flat` with one
 * unit normal for each face. Around a vertex with more than 64 faces, each corner has its face's
 * own normal. O(faces). Errors: GD_CANCELLED, GD_DEADLINE. */
static enum gd_status normals_make(struct normals *normals, const struct gd_control *control)
{
    struct gd__pace pace = {.control = control};
    gd__slices_run(&pace, normals->mesh->face_count, make_flat, normals);
    gd__slices_run(&pace, normals->mesh->vertex_count, make_corners, normals);
    return pace.status;
}

/* --- life ------------------------------------------------------------------------------------- */

static void scratch_open(struct gd__shade *shade, struct gd__arena *arena)
{
    size_t pixels = (size_t)shade->raster->width * shade->raster->rows;
    shade->fragments = gd__arena_take(arena, BATCH, sizeof *shade->fragments);
    shade->points = gd__arena_take(arena, BATCH, sizeof *shade->points);
    shade->distances = gd__arena_take(arena, BATCH, sizeof *shade->distances);
    shade->sum = gd__arena_take(arena, pixels, sizeof *shade->sum);
}

enum gd_status gd__shade_open(struct gd__shade *shade, struct gd__arena *arena,
                              const struct gd_control *control)
{
    const struct gd_mesh *mesh = shade->raster->mesh;
    for (int i = 0; i <= GD__SHADE_COLOURS; i++)
        shade->colours[i] = gd__colour_of_part((double)i / GD__SHADE_COLOURS);
    scratch_open(shade, arena);
    shade->corners = gd__arena_large(arena, mesh->face_count, sizeof *shade->corners);
    struct gd__arena scratch = {.budget = arena->budget, .status = arena->status};
    struct normals normals = {
        mesh, gd__arena_take(&scratch, mesh->face_count, sizeof *normals.flat), shade->corners};
    if (!scratch.status) scratch.status = normals_make(&normals, control);
    gd__arena_free(&scratch);
    return scratch.status;
}

struct gd__shade gd__shade_copy(const struct gd__shade *shade, const struct gd__raster *raster,
                                struct gd__arena *arena)
{
    struct gd__shade copy = *shade;
    copy.raster = raster;
    scratch_open(&copy, arena);
    return copy;
}

/* --- the colour of a fragment ----------------------------------------------------------------- */

static struct gd_vec3 normal_at(const struct gd__shade *shade, const struct gd__fragment *fragment)
{
    const struct gd__normal *corner = shade->corners[fragment->face];
    struct gd_vec3 sum = {0, 0, 0};
    for (int k = 0; k < 3; k++)
        sum = gd_vec3_along(sum, fragment->weight[k],
                            (struct gd_vec3){corner[k].x, corner[k].y, corner[k].z});
    double length = gd_vec3_length(sum);
    return length > 0 ? gd_vec3_scale(sum, 1 / length) : shade->camera->towards;
}

/* Returns the brightness of a surface with that normal. There are three lights: a lamp above the
 * viewer's left shoulder, a lamp beside the eye, and ambient light. */
static double light_on(const struct gd__camera *camera, struct gd_vec3 normal)
{
    static const double everywhere = 0.36, lamp = 0.42, eye = 0.26, along[3] = {-0.48, 0.60, 0.64};
    double right = gd_vec3_dot(normal, camera->right), up = gd_vec3_dot(normal, camera->up),
           towards = gd_vec3_dot(normal, camera->towards);
    return everywhere + lamp * fmax(0, along[0] * right + along[1] * up + along[2] * towards) +
           eye * fmax(0, towards);
}

/* Returns the opacity of the lines of edges at the fragment. A line is a pixel wide, and fainter on
 * small triangles. */
static double edge_cover(const struct gd__shade *shade, const struct gd__fragment *fragment)
{
    uint32_t v[3];
    gd__corners(shade->raster->mesh, fragment->face, v);
    const struct gd__screen_point *points = shade->raster->points;
    double nearest = INFINITY, lowest = INFINITY;
    for (int k = 0; k < 3; k++) {
        const struct gd__screen_point *a = &points[v[k]], *b = &points[v[(k + 1) % 3]],
                                      *c = &points[v[(k + 2) % 3]];
        double x = (double)b->x - a->x, y = (double)b->y - a->y, length = hypot(x, y);
        double height =
            length > 0 ? fabs(x * ((double)c->y - a->y) - y * ((double)c->x - a->x)) / length : 0;
        nearest = fmin(nearest, height * fragment->weight[(k + 2) % 3]);
        lowest = fmin(lowest, height);
    }
    return fmin(fmax(1 - nearest, 0), 1) * fmin(fmax((lowest - 1) / 6, 0), 1) * 0.45;
}

static struct gd__colour shade_mix(struct gd__colour a, struct gd__colour b, double part)
{
    float p = (float)part;
    return (struct gd__colour){a.red + p * (b.red - a.red), a.green + p * (b.green - a.green),
                               a.blue + p * (b.blue - a.blue)};
}

static struct gd__colour colour_of(const struct gd__shade *shade,
                                   const struct gd__fragment *fragment, double distance)
{
    struct gd_vec3 normal = normal_at(shade, fragment);
    bool is_inside = gd_vec3_dot(normal, shade->camera->towards) < 0;
    double light = light_on(shade->camera, is_inside ? gd_vec3_scale(normal, -1) : normal);
    struct gd__colour colour = is_inside ? shade->palette->inside : shade->palette->surface;
    if (isfinite(distance)) {
        double part = distance / shade->range;
        colour = shade->colours[part < 1 ? (uint32_t)(part * GD__SHADE_COLOURS + 0.5)
                                         : GD__SHADE_COLOURS];
        /* weaker shading, so that the colours of distances stay distinguishable */
        light = 0.38 + 0.62 * light;
    }
    colour = shade_mix((struct gd__colour){0, 0, 0}, colour, light);
    return shade->edges ? shade_mix(colour, shade->palette->line, edge_cover(shade, fragment))
                        : colour;
}

/* --- fragments -------------------------------------------------------------------------------- */

/* Colours the collected fragments. */
static enum gd_status flush(struct gd__shade *shade, const struct gd_control *control)
{
    enum gd_status status = gd_control_check(control, 0);
    uint32_t count = shade->fragment_count;
    shade->fragment_count = 0;
    if (shade->field && !status)
        status = gd_field_distances(shade->field, shade->points, count, control, shade->distances);
    for (uint32_t i = 0; i < count && !status; i++) {
        const struct gd__fragment *fragment = &shade->fragments[i];
        struct gd__colour colour =
            colour_of(shade, fragment, shade->field ? shade->distances[i] : NAN);
        float *sum = shade->sum[fragment->pixel], part = fragment->part;
        sum[0] += part * colour.red;
        sum[1] += part * colour.green;
        sum[2] += part * colour.blue;
        sum[3] += part;
    }
    return status;
}

static double into_unit(double x)
{
    return x < 0 ? 0 : x < 1 ? x : 1;
}

/* Computes the barycentric coordinates of a position in the picture, clamped to the face. */
static void weigh(const struct gd__raster *raster, uint32_t face, double x, double y,
                  float weight[3])
{
    uint32_t v[3];
    gd__corners(raster->mesh, face, v);
    const struct gd__screen_point *a = &raster->points[v[0]], *b = &raster->points[v[1]],
                                  *c = &raster->points[v[2]];
    double bx = (double)b->x - a->x, by = (double)b->y - a->y, cx = (double)c->x - a->x,
           cy = (double)c->y - a->y, area = bx * cy - cx * by;
    x -= a->x;
    y -= a->y;
    double second = into_unit((x * cy - cx * y) / area),
           third = into_unit((bx * y - x * by) / area), first = into_unit(1 - second - third),
           sum = first + second + third;
    weight[0] = (float)(first / sum);
    weight[1] = (float)(second / sum);
    weight[2] = (float)(third / sum);
}

static void add_fragment(struct gd__shade *shade, uint32_t pixel, uint32_t face, double x, double y,
                         float part)
{
    uint32_t i = shade->fragment_count++;
    struct gd__fragment *fragment = &shade->fragments[i];
    *fragment = (struct gd__fragment){.pixel = pixel, .face = face, .part = part};
    weigh(shade->raster, face, x, y, fragment->weight);
    if (!shade->field) return;
    double second = fragment->weight[1], third = fragment->weight[2];
    shade->points[i] = gd__point_of_face(
        shade->raster->mesh, face, (const double[3]){into_unit(1 - second - third), second, third});
}

/* The faces at a pixel's samples. For each face: the number of its samples and the sum of their
 * positions. */
struct tally {
    uint32_t count, face[SAMPLES], samples[SAMPLES];
    double x[SAMPLES], y[SAMPLES];
};

static void count_sample(struct tally *tally, uint32_t face, double x, double y)
{
    uint32_t i = tally->count;
    while (i > 0 && tally->face[i - 1] != face) i--;
    if (i == 0) {
        i = ++tally->count;
        tally->face[i - 1] = face;
        tally->samples[i - 1] = 0;
        tally->x[i - 1] = tally->y[i - 1] = 0;
    }
    tally->samples[i - 1]++;
    tally->x[i - 1] += x;
    tally->y[i - 1] += y;
}

static void tally_pixel(const struct gd__raster *raster, uint32_t row, uint32_t column,
                        struct tally *tally)
{
    uint32_t grid = raster->grid;
    tally->count = 0;
    for (uint32_t j = 0; j < grid; j++) {
        const uint32_t *face =
            raster->face + ((size_t)row * grid + j) * raster->width * grid + (size_t)column * grid;
        double shift = gd__raster_shift(grid, j);
        for (uint32_t i = 0; i < grid; i++)
            if (face[i] != GD_NONE)
                count_sample(tally, face[i], (i + 0.5 + shift) / grid, (j + 0.5) / grid);
    }
}

/* Returns true if all samples of a pixel show the same face, which is the usual case. */
static bool is_filled(const struct gd__raster *raster, uint32_t row, uint32_t column)
{
    uint32_t grid = raster->grid, differ = 0;
    const uint32_t *face =
        raster->face + (size_t)row * grid * raster->width * grid + (size_t)column * grid;
    for (uint32_t j = 0; j < grid; j++)
        for (uint32_t i = 0; i < grid; i++)
            differ |= face[(size_t)j * raster->width * grid + i] ^ face[0];
    return differ == 0 && face[0] != GD_NONE;
}

static void add_fragments(struct gd__shade *shade, uint32_t top, uint32_t row, uint32_t column)
{
    const struct gd__raster *raster = shade->raster;
    struct tally tally;
    if (is_filled(raster, row, column)) {
        uint32_t face =
            raster->face[((size_t)row * raster->width * raster->grid + column) * raster->grid];
        add_fragment(shade, row * raster->width + column, face, column + 0.5, top + row + 0.5, 1);
        return;
    }
    tally_pixel(raster, row, column, &tally);
    for (uint32_t i = 0; i < tally.count; i++)
        add_fragment(shade, row * raster->width + column, tally.face[i],
                     column + tally.x[i] / tally.samples[i],
                     top + row + tally.y[i] / tally.samples[i],
                     (float)tally.samples[i] / (float)(raster->grid * raster->grid));
}

/* --- the band --------------------------------------------------------------------------------- */

static uint8_t byte_of(float part)
{
    return part <= 0 ? 0 : part >= 1 ? 255 : (uint8_t)(255 * part + 0.5F);
}

static void write_pixel(const struct gd__palette *palette, const float sum[4], uint8_t out[4])
{
    float buffer = fminf(sum[3], 1), rest = 1 - buffer;
    const float ground[3] = {palette->background.red, palette->background.green,
                             palette->background.blue};
    for (int k = 0; k < 3; k++)
        out[k] = palette->is_transparent ? byte_of(buffer > 0 ? sum[k] / buffer : 0)
                                         : byte_of(sum[k] + rest * ground[k]);
    out[3] = palette->is_transparent ? byte_of(buffer) : 255;
}

enum gd_status gd__shade_band(struct gd__shade *shade, uint32_t band,
                              const struct gd_control *control, struct gd__image *image)
{
    const struct gd__raster *raster = shade->raster;
    uint32_t width = raster->width, top = band * raster->rows,
             rows = raster->height - top < raster->rows ? raster->height - top : raster->rows;
    enum gd_status status = GD_OK;
    shade->fragment_count = 0; /* a band that was not finished may have left fragments */
    for (size_t i = 0; i < (size_t)rows * width; i++)
        for (int k = 0; k < 4; k++) shade->sum[i][k] = 0;
    for (uint32_t i = 0; i < rows * width && !status; i++) {
        if (shade->fragment_count > BATCH - SAMPLES) status = flush(shade, control);
        if (!status && i % width == 0) status = gd_control_check(control, 0);
        if (!status) add_fragments(shade, top, i / width, i % width);
    }
    if (!status) status = flush(shade, control);
    for (uint32_t i = 0; i < rows * width && !status; i++)
        write_pixel(shade->palette, shade->sum[i], image->pixel[(size_t)top * width + i]);
    return status;
}
