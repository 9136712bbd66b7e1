/* Scene: the surface, isolines and layers of a picture as a GLB file (gd/result_file.h). */
#include <math.h>
#include <stdio.h>

#include "base/arena.h"
#include "gd/picture.h"
#include "gd/result_file.h"
#include "render/request.h"

#define TOLERANCE 1e-4 /* tolerance of isolines, relative to the diagonal of the surface */

enum { NAME = 16 };

/* The lines of all isolines, in growing arrays. */
struct isolines {
    struct gd_vec3 *points;
    uint32_t *first;
    uint32_t count;
    uint32_t point_room, line_room;
};

struct scene {
    const struct gd_picture *picture;
    struct gd__arena arena;
    struct gd__share share;
    struct gd__palette palette;
    struct gd__scale scale; /* if there is a field */
    struct gd__layer_list layers;
    struct isolines isolines;
    struct gd_polygons polygons;
    double *distances;
    struct gd_result_layer *written;
    char (*names)[NAME];
    uint32_t written_count;
};

static enum gd_status surface_open(struct scene *scene)
{
    const struct gd_picture *picture = scene->picture;
    const struct gd_mesh_summary *summary = gd_mesh_summary(picture->mesh);
    enum gd_status status =
        gd__budget_take(&scene->arena.budget, summary->index_count * sizeof(double[3]) +
                                                  summary->faces * sizeof(uint32_t[3]));
    if (!status) status = gd_mesh_polygons(picture->mesh, &scene->polygons);
    if (status || !picture->field) return status;
    scene->distances =
        gd__arena_take(&scene->arena, summary->index_count, sizeof *scene->distances);
    if (!scene->distances) return scene->arena.status;
    gd_field_vertex_distances(picture->field, scene->distances);
    return gd_control_check(scene->arena.budget.control, 0);
}

/* --- isolines --------------------------------------------------------------------------------- */

static enum gd_status isoline_take(void *own, const struct gd_path *line)
{
    struct scene *scene = own;
    struct isolines *lines = &scene->isolines;
    uint32_t begin = lines->count ? lines->first[lines->count] : 0;
    enum gd_status status = gd__arena_extend(&scene->arena, &lines->points, &lines->point_room,
                                             begin + (uint64_t)line->count, sizeof *lines->points);
    if (!status)
        status = gd__arena_extend(&scene->arena, &lines->first, &lines->line_room,
                                  lines->count + UINT64_C(2), sizeof *lines->first);
    if (status) return status;
    for (uint32_t i = 0; i < line->count; i++)
        lines->points[begin + i] = gd_point_position(scene->picture->mesh, &line->points[i]);
    lines->first[lines->count++] = begin;
    lines->first[lines->count] = begin + line->count;
    return GD_OK;
}

static enum gd_status isolines_open(struct scene *scene)
{
    const struct gd_mesh_summary *summary = gd_mesh_summary(scene->picture->mesh);
    double diagonal = gd_vec3_length(gd_vec3_sub(summary->max, summary->min));
    struct gd__isoline_request request = {.picture = scene->picture,
                                          .scale = &scene->scale,
                                          .share = &scene->share,
                                          .budget = &scene->arena.budget,
                                          .tolerance = TOLERANCE * diagonal,
                                          .take = isoline_take,
                                          .own = scene};
    return gd__isolines_flatten(&request);
}

/* --- layers ----------------------------------------------------------------------------------- */

/* Returns the linear value of an encoded component (IEC 61966-2-1). */
static double decode(float encoded)
{
    double value = (double)encoded;
    return value <= 0.04045 ? value / 12.92 : pow((value + 0.055) / 1.055, 2.4);
}

static struct gd_colour linear(struct gd__colour colour)
{
    return (struct gd_colour){decode(colour.red), decode(colour.green), decode(colour.blue)};
}

static const double (*as_rows(const struct gd_vec3 *points))[3]
{
    return (const double(*)[3])points;
}

static void isolines_write(struct scene *scene)
{
    const struct gd_picture *picture = scene->picture;
    struct gd__colour colour =
        picture->isoline_colour ? gd__colour_of_rgb(picture->isoline_colour) : scene->palette.line;
    scene->written[scene->written_count++] =
        (struct gd_result_layer){.points = as_rows(scene->isolines.points),
                                 .first = scene->isolines.first,
                                 .count = scene->isolines.count,
                                 .colour = linear(colour),
                                 .name = "isolines"};
}

static void layer_write(struct scene *scene, uint32_t i)
{
    const struct gd__layer *layer = &scene->layers.items[i];
    const struct gd_picture_layer *wanted = layer->wanted;
    char *name = scene->names[i];
    if (wanted == &scene->layers.path)
        snprintf(name, NAME, "path");
    else
        snprintf(name, NAME, "layer-%u", wanted->id);
    scene->written[scene->written_count++] =
        (struct gd_result_layer){.points = as_rows(wanted->points),
                                 .first = wanted->first,
                                 .count = wanted->count,
                                 .colour = linear(layer->colour),
                                 .name = name,
                                 .label = wanted->name,
                                 .labels = wanted->labels};
}

static enum gd_status layers_open(struct scene *scene)
{
    enum gd_status status =
        gd__layer_list_open(&scene->layers, scene->picture, &scene->palette, &scene->arena);
    size_t room = scene->layers.count + (size_t)1;
    scene->written = gd__arena_zeroed(&scene->arena, room, sizeof *scene->written);
    scene->names = gd__arena_zeroed(&scene->arena, room, sizeof *scene->names);
    if (status || scene->arena.status) return status ? status : scene->arena.status;
    if (scene->isolines.count) isolines_write(scene);
    for (uint32_t i = 0; i < scene->layers.count; i++) layer_write(scene, i);
    return GD_OK;
}

/* --- the file --------------------------------------------------------------------------------- */

static enum gd_status file_write(struct scene *scene, void **bytes, size_t *size)
{
    struct gd_colour colour = linear(scene->palette.surface);
    const struct gd_result result = {.mesh = &scene->polygons,
                                     .distances = scene->distances,
                                     .layers = scene->written,
                                     .layer_count = scene->written_count,
                                     .colour = &colour};
    char *out;
    enum gd_status status = gd__budget_take(&scene->arena.budget, gd_result_cost(&result));
    struct gd_control control = gd__share_control(&scene->share, scene->arena.budget.held);
    if (!status) status = gd_control_check(&control, 0);
    if (!status) status = gd_write_result(&result, GD_RESULT_GLB, &out, size);
    if (!status) *bytes = out;
    return status;
}

enum gd_status gd_picture_glb(const struct gd_picture *picture, const struct gd_control *control,
                              void **bytes, size_t *size)
{
    struct scene scene = {
        .picture = picture, .arena.budget.control = control, .share = {.control = control}};
    if (!gd__request_is_sound(picture)) return GD_INVALID_ARGUMENT;
    scene.palette = gd__request_palette(picture);
    if (picture->field) scene.scale = gd__request_scale(picture);
    scene.share.total = 3 + gd__isoline_count(picture, &scene.scale);
    enum gd_status status = surface_open(&scene);
    scene.share.done++;
    if (!status) status = isolines_open(&scene);
    if (!status) status = layers_open(&scene);
    if (!status) status = file_write(&scene, bytes, size);
    gd_polygons_free(&scene.polygons);
    gd__arena_free(&scene.arena);
    return status;
}
