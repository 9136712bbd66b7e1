#include "gd/picture.h"

#include <stdlib.h>
#include <string.h>

#include "base/arena.h"
#include "base/lanes.h"
#include "base/slices.h"
#include "render/legend.h"
#include "render/request.h"
#include "render/shade.h"

/* DESIGN. A picture is made in three steps. First the surface is rendered to an image with a depth
 * buffer. Then isolines and layers are projected and divided into visible and hidden parts. Finally
 * they are drawn on a canvas: the image itself, or an SVG file that embeds the image. The path of a
 * picture is its first layer. */

enum { GRID = 4 };
#define LINE_TOLERANCE 0.1  /* pixels */
#define SUBJECT_MOST   4096 /* points of layers that should be visible */

/* --- choice of a view ------------------------------------------------------------------------- */

/* View: finds a direction from which most of a path, or of a set of points, is visible. */

/* Positions on the surface, at least one, in the normalised unit; borrowed. */
struct subject {
    const struct gd_vec3 *points;
    uint32_t count;
    bool is_path; /* the points are a polyline */
};

#define ENOUGH 0.95 /* visible fraction at which the search stops */
/* a view replaces the best one only if its visible fraction is larger by more than this */
#define BETTER 0.05

#define END_PART 0.1 /* weight of the visibility of each end */

/* viewport in a picture of 240 x 180 pixels */
static const struct gd__viewport small = {4, 4, 232, 172};

struct angles {
    double azimuth, elevation; /* degrees */
};

/* Views to try after iso, in order of their difference from iso. */
static const struct angles angles[] = {{-30, 26},  {75, 26},  {-75, 26}, {30, 55},   {120, 26},
                                       {-120, 26}, {0, 75},   {165, 26}, {-165, 26}, {30, -26},
                                       {-30, -26}, {120, 55}, {-90, 55}, {120, -26}, {-120, -26}};

/* number of views that are sketched at a time, if there are threads for them */
enum { SKETCHES = 2, VIEWS = 1 + sizeof angles / sizeof *angles };

struct sketch {
    struct gd_vec3 direction;
    struct gd__screen_point *points, *line;
    double seen; /* visible fraction of the subject */
};

struct chooser {
    const struct gd_mesh *mesh;
    struct gd_vec3 up;
    const struct subject *subject;
    const struct gd__budget *budget;
    struct sketch sketches[SKETCHES];
    uint32_t sketch_count; /* number of sketches at a time */
};

static double path_seen(const struct sketch *sketch, uint32_t count,
                        const struct gd__depth_buffer *buffer)
{
    return (1 - 2 * END_PART) * gd__depth_buffer_visibility(buffer, sketch->line, count) +
           END_PART * gd__depth_buffer_visibility(buffer, sketch->line, 1) +
           END_PART * gd__depth_buffer_visibility(buffer, sketch->line + count - 1, 1);
}

static double points_seen(const struct sketch *sketch, uint32_t count,
                          const struct gd__depth_buffer *buffer)
{
    double sum = 0;
    for (uint32_t i = 0; i < count; i++)
        sum += gd__depth_buffer_visibility(buffer, sketch->line + i, 1);
    return sum / count;
}

static enum gd_status sketch_view(const struct subject *subject, struct sketch *sketch,
                                  const struct gd_control *control, struct gd__raster *raster,
                                  struct gd__arena *arena)
{
    enum gd_status status = gd__raster_open(raster, arena, control);
    if (!status) status = gd__raster_fill(raster, 0, control);
    if (status) return status;
    const struct gd__depth_buffer buffer = {.mesh = raster->mesh,
                                            .points = sketch->points,
                                            .width = raster->width,
                                            .height = raster->height,
                                            .depth = raster->depth,
                                            .face = raster->face};
    sketch->seen = subject->is_path ? path_seen(sketch, subject->count, &buffer)
                                    : points_seen(sketch, subject->count, &buffer);
    return GD_OK;
}

/* Computes how much of the subject is visible from the direction of a sketch. */
static enum gd_status try_view(const struct chooser *chooser, struct sketch *sketch,
                               const struct gd_control *control)
{
    const struct gd_mesh *mesh = chooser->mesh;
    struct gd__camera camera = gd__camera_aim(mesh, sketch->direction, chooser->up);
    struct gd__arena arena = {.budget = *chooser->budget};
    gd__camera_fit(&camera, mesh, NULL, 0, &small);
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        sketch->points[v] = gd__camera_project(&camera, mesh->position[v]);
    for (uint32_t i = 0; i < chooser->subject->count; i++)
        sketch->line[i] = gd__camera_project(&camera, chooser->subject->points[i]);
    struct gd__raster raster = {.mesh = mesh,
                                .points = sketch->points,
                                .width = (uint32_t)(small.width + 2 * small.left),
                                .height = (uint32_t)(small.height + 2 * small.top),
                                .grid = 1,
                                .rows = UINT32_MAX};
    /* the samples of the other sketches */
    arena.budget.held += (chooser->sketch_count - 1) * (size_t)raster.width * raster.height *
                         (sizeof *raster.depth + sizeof *raster.face);
    enum gd_status status = sketch_view(chooser->subject, sketch, control, &raster, &arena);
    gd__arena_free(&arena);
    return status;
}

/* Tries the view of a sketch, which is a slice of its own. */
static void try_slice(void *context, struct gd__pace *pace, uint32_t begin, uint32_t end)
{
    struct chooser *chooser = context;
    enum gd_status status =
        try_view(chooser, &chooser->sketches[begin / GD__PACE_STEPS], pace->control);
    (void)end;
    if (!pace->status) pace->status = status;
}

static struct gd_vec3 view_of(const struct chooser *chooser, uint32_t i)
{
    if (i == 0) return gd__view_direction(GD_VIEW_ISO, chooser->up);
    return gd__view_from(angles[i - 1].azimuth * M_PI / 180, angles[i - 1].elevation * M_PI / 180,
                         chooser->up);
}

static enum gd_status view_choose(struct chooser *chooser, const struct gd_control *control,
                                  struct gd_vec3 *out)
{
    struct gd__pace pace = {.control = control};
    double most = -1;
    *out = view_of(chooser, 0);
    for (uint32_t i = 0, count = 1; i < VIEWS && most < ENOUGH; i += count) {
        /* the first view is often good enough */
        count = i == 0 || i + 1 == VIEWS ? 1 : chooser->sketch_count;
        for (uint32_t k = 0; k < count; k++)
            chooser->sketches[k].direction = view_of(chooser, i + k);
        gd__slices_run(&pace, count * GD__PACE_STEPS, try_slice, chooser);
        if (pace.status) return pace.status;
        for (uint32_t k = 0; k < count && most < ENOUGH; k++) {
            if (chooser->sketches[k].seen <= most + BETTER) continue;
            most = chooser->sketches[k].seen;
            *out = chooser->sketches[k].direction;
        }
    }
    return GD_OK;
}

/* Tries the iso view, then others around the surface, at a small size, until 95 % of the subject is
 * visible. Sets *out to the best direction. Errors: GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED,
 * GD_DEADLINE. Cost: O(faces) for each of up to 16 directions. */
static enum gd_status direction_choose(const struct gd_mesh *mesh, struct gd_vec3 up,
                                       const struct subject *subject, struct gd__arena *arena,
                                       const struct gd_control *control, struct gd_vec3 *out)
{
    struct chooser chooser = {.mesh = mesh, .up = up, .subject = subject, .budget = &arena->budget};
    chooser.sketch_count = control->executor ? SKETCHES : 1;
    for (uint32_t k = 0; k < chooser.sketch_count; k++) {
        struct sketch *sketch = &chooser.sketches[k];
        sketch->points = gd__arena_take(arena, mesh->vertex_count, sizeof *sketch->points);
        sketch->line = gd__arena_take(arena, subject->count, sizeof *sketch->line);
    }
    return arena->status ? arena->status : view_choose(&chooser, control, out);
}

/* Fills and shades bands, one after the other. */
struct band_lane {
    struct gd__raster raster;
    struct gd__shade shade;
};

enum { BAND_LANES = 2 };

/* The state of one picture. Before it is opened, all members except the request are zero. */
struct studio {
    const struct gd_picture *picture;
    const struct gd_mesh *mesh;
    struct gd__palette palette;
    struct gd__arena arena;
    struct gd__share share; /* progress, in parts that count as equally long */
    struct gd__legend legend;
    struct gd__scale scale; /* if there is a field */
    struct gd__camera camera;
    struct gd__screen_point *points;    /* per vertex */
    struct band_lane lanes[BAND_LANES]; /* the second is open only while bands are drawn */
    bool *band_is_drawn;
    struct gd__depth_buffer buffer;
    struct gd__image image;
    struct gd__lines isolines;
    struct gd__layer_list layers;
    bool has_source; /* the field has a single source, drawn if there is no path */
    struct gd_vec3 source;
    struct gd__stage stage;
};

/* --- view ------------------------------------------------------------------------------------- */

static struct gd_vec3 inside(const struct gd_mesh *mesh, struct gd_vec3 position)
{
    return gd_vec3_scale(position, 1 / mesh->unit);
}

static uint32_t layer_points(const struct gd_picture_layer *layer)
{
    return layer->first ? layer->first[layer->count] : layer->count;
}

/* Lists every `stride`-th point of the layers. Returns their number; `out` may be NULL. */
static uint32_t list_points(const struct studio *studio, uint64_t stride, struct gd_vec3 *out)
{
    uint64_t at = 0;
    uint32_t listed = 0;
    for (uint32_t i = 0; i < studio->layers.count; i++) {
        const struct gd_picture_layer *layer = studio->layers.items[i].wanted;
        for (uint32_t k = 0; k < layer_points(layer); k++, at++) {
            if (at % stride) continue;
            if (out) out[listed] = inside(studio->mesh, layer->points[k]);
            listed++;
        }
    }
    return listed;
}

/* Lists the positions that should be visible: the path, or points of the layers, or the source of
 * the field. The count is 0 if there is none of the three. */
static enum gd_status find_subject(struct studio *studio, struct subject *out)
{
    const struct gd_path *path = studio->picture->path;
    uint64_t all = 0;
    for (uint32_t i = 0; i < studio->layers.count; i++)
        all += layer_points(studio->layers.items[i].wanted);
    uint64_t stride = path ? 1 : 1 + all / SUBJECT_MOST;
    uint32_t count = path ? path->count : list_points(studio, stride, NULL);
    if (!count && studio->has_source) count = 1;
    struct gd_vec3 *points = gd__arena_take(&studio->arena, count + (size_t)1, sizeof *points);
    if (!points) return studio->arena.status;
    if (studio->has_source) points[0] = inside(studio->mesh, studio->source);
    for (uint32_t i = 0; path && i < count; i++)
        points[i] = inside(studio->mesh, studio->layers.path_points[i]);
    if (!path) list_points(studio, stride, points);
    *out = (struct subject){points, count, path || all == 0};
    return GD_OK;
}

static enum gd_status picture_aim(struct studio *studio, const struct subject *subject)
{
    const struct gd_picture *picture = studio->picture;
    struct gd_vec3 direction = picture->view == GD_VIEW_DIRECTION
                                   ? picture->direction
                                   : gd__view_direction(picture->view, picture->up);
    struct gd_control control = gd__share_control(&studio->share, studio->arena.budget.held);
    enum gd_status status = GD_OK;
    if (picture->view == GD_VIEW_CHOSEN && subject->count)
        status = direction_choose(studio->mesh, picture->up, subject, &studio->arena, &control,
                                  &direction);
    if (status) return status;
    struct gd__viewport window = gd__legend_window(&studio->legend);
    studio->camera = gd__camera_aim(studio->mesh, direction, picture->up);
    gd__camera_fit(&studio->camera, studio->mesh, picture->layers, picture->layer_count, &window);
    if (picture->zoom > 1) {
        struct gd_vec3 target =
            picture->target ? inside(studio->mesh, *picture->target) : studio->camera.centre;
        gd__camera_zoom(&studio->camera, &window, picture->zoom, picture->target ? &target : NULL);
    }
    return GD_OK;
}

/* --- the surface ------------------------------------------------------------------------------ */

static void project_slice(void *context, struct gd__pace *pace, uint32_t begin, uint32_t end)
{
    const struct studio *studio = context;
    (void)pace;
    for (uint32_t v = begin; v < end; v++)
        studio->points[v] = gd__camera_project(&studio->camera, studio->mesh->position[v]);
}

static enum gd_status project(struct studio *studio, const struct gd_control *control)
{
    struct gd__pace pace = {.control = control};
    studio->points =
        gd__arena_take(&studio->arena, studio->mesh->vertex_count, sizeof *studio->points);
    if (!studio->points) return studio->arena.status;
    gd__slices_run(&pace, studio->mesh->vertex_count, project_slice, studio);
    return pace.status;
}

static enum gd_status open_first_lane(struct studio *studio, const struct gd_control *control)
{
    struct gd__raster *raster = &studio->lanes[0].raster;
    struct gd__shade *shade = &studio->lanes[0].shade;
    struct gd__arena *arena = &studio->arena;
    *raster = (struct gd__raster){.mesh = studio->mesh,
                                  .points = studio->points,
                                  .width = studio->legend.width,
                                  .height = studio->legend.height,
                                  .grid = GRID,
                                  .rows = gd__raster_rows(studio->legend.width)};
    *shade = (struct gd__shade){.raster = raster,
                                .camera = &studio->camera,
                                .palette = &studio->palette,
                                .field = studio->picture->field,
                                .range = studio->scale.range,
                                .edges = studio->picture->edges};
    enum gd_status status = gd__raster_open(raster, arena, control);
    return status ? status : gd__shade_open(shade, arena, control);
}

/* Opens the second lane in the arena, if there are threads for it. Returns false if there are none,
 * or if the budget or memory is too small for it. */
static bool open_second_lane(struct studio *studio, struct gd__arena *arena)
{
    const struct gd_control *control = studio->share.control;
    const struct band_lane *first = &studio->lanes[0];
    struct band_lane *second = &studio->lanes[1];
    if (!control || !control->executor || control->executor->width < 2) return false;
    second->raster = gd__raster_copy(&first->raster, arena);
    second->shade = gd__shade_copy(&first->shade, &second->raster, arena);
    return !arena->status;
}

static enum gd_status open_surface(struct studio *studio)
{
    struct gd_control control = gd__share_control(&studio->share, studio->arena.budget.held);
    size_t pixels = (size_t)studio->legend.width * studio->legend.height;
    enum gd_status status = project(studio, &control);
    studio->image = (struct gd__image){
        .width = studio->legend.width,
        .height = studio->legend.height,
        .is_opaque = !studio->palette.is_transparent,
        .pixel = gd__arena_large(&studio->arena, pixels, sizeof *studio->image.pixel)};
    if (!status) status = open_first_lane(studio, &control);
    studio->band_is_drawn = gd__arena_zeroed(&studio->arena, studio->lanes[0].raster.bands,
                                             sizeof *studio->band_is_drawn);
    return status
               ? status
               : gd__depth_buffer_open(&studio->buffer, &studio->lanes[0].raster, &studio->arena);
}

static enum gd_status draw_band(void *context, uint32_t number, uint32_t band,
                                const struct gd_control *control)
{
    struct studio *studio = context;
    struct band_lane *lane = &studio->lanes[number % BAND_LANES];
    if (studio->band_is_drawn[band]) return GD_OK;
    enum gd_status status = gd__raster_fill(&lane->raster, band, control);
    if (!status) status = gd__shade_band(&lane->shade, band, control, &studio->image);
    if (!status) gd__depth_buffer_take(&studio->buffer, &lane->raster, band);
    studio->band_is_drawn[band] = !status;
    return status;
}

/* Draws the bands that are not drawn yet. `held` is the number of bytes held. */
static enum gd_status draw_bands(struct studio *studio, const struct gd_executor *executor,
                                 size_t held)
{
    struct gd_control control = gd__share_control(&studio->share, held);
    const struct gd__lanes lanes = {.executor = executor,
                                    .control = &control,
                                    .share = &studio->share,
                                    .count = studio->lanes[0].raster.bands,
                                    .make = draw_band,
                                    .context = studio};
    return gd__lanes_run(&lanes);
}

/* The second lane takes memory. If the budget is too small for it, one lane draws the rest. */
static enum gd_status draw_surface(struct studio *studio)
{
    enum gd_status status = open_surface(studio);
    if (status) return status;
    struct gd__arena arena = {.budget = studio->arena.budget};
    uint32_t done = studio->share.done;
    if (open_second_lane(studio, &arena))
        status = draw_bands(studio, studio->share.control->executor, arena.budget.held);
    gd__arena_free(&arena);
    if (status == GD_CANCELLED || status == GD_DEADLINE) return status;
    studio->share.done = done;
    return draw_bands(studio, NULL, studio->arena.budget.held);
}

/* --- lines ------------------------------------------------------------------------------------ */

static enum gd_status isoline_line_split(void *own, const struct gd_path *line)
{
    struct studio *studio = own;
    struct gd__screen_point *points = malloc(line->count * sizeof *points);
    if (!points) return GD_NO_MEMORY;
    for (uint32_t i = 0; i < line->count; i++)
        points[i] = gd__camera_project(
            &studio->camera,
            inside(studio->mesh, gd_point_position(studio->mesh, &line->points[i])));
    enum gd_status status =
        gd__depth_buffer_split(&studio->buffer, points, line->count, &studio->isolines, NULL);
    free(points);
    return status;
}

static enum gd_status find_isolines(struct studio *studio)
{
    struct gd__isoline_request request = {.picture = studio->picture,
                                          .scale = &studio->scale,
                                          .share = &studio->share,
                                          .budget = &studio->arena.budget,
                                          .tolerance = LINE_TOLERANCE / studio->camera.scale *
                                                       studio->mesh->unit,
                                          .take = isoline_line_split,
                                          .own = studio};
    return gd__isolines_flatten(&request);
}

static enum gd_status find_lines(struct studio *studio)
{
    enum gd_status status = find_isolines(studio);
    studio->stage = (struct gd__stage){.mesh = studio->mesh,
                                       .camera = &studio->camera,
                                       .buffer = &studio->buffer,
                                       .palette = &studio->palette,
                                       .arena = &studio->arena,
                                       .unit = studio->legend.unit};
    for (uint32_t i = 0; i < studio->layers.count && !status; i++) {
        struct gd_control control = gd__share_control(&studio->share, studio->arena.budget.held);
        status = gd__layer_project(&studio->layers.items[i], &studio->stage, &control);
        studio->share.done++;
    }
    return status;
}

/* --- the canvas ------------------------------------------------------------------------------- */

/* Draws the field's source as a ring. */
static void draw_source(const struct studio *studio, struct gd__canvas *canvas)
{
    const struct gd__palette *palette = &studio->palette;
    struct gd__screen_point point =
        gd__camera_project(&studio->camera, inside(studio->mesh, studio->source));
    struct gd__pixel_point at = {point.x, point.y};
    double opacity = gd__depth_buffer_visibility(&studio->buffer, &point, 1) > 0 ? 1 : 0.4,
           unit = studio->legend.unit;
    canvas->disc(canvas, at, 5.5 * unit, palette->path, opacity);
    canvas->disc(canvas, at, 2.8 * unit, palette->halo, opacity);
}

static void draw_lines(const struct studio *studio, struct gd__canvas *canvas)
{
    const struct gd_picture *picture = studio->picture;
    double unit = studio->legend.unit;
    struct gd__pen pen = {studio->palette.line, 0.5, fmax(unit, 0.8), 0};
    if (picture->isoline_colour) {
        pen.colour = gd__colour_of_rgb(picture->isoline_colour);
        pen.opacity = 1;
    }
    if (picture->isoline_width > 0) pen.width = unit * picture->isoline_width;
    canvas->stroke(canvas, &studio->isolines, &pen);
    for (uint32_t i = 0; i < studio->layers.count; i++) {
        const struct gd__layer *layer = &studio->layers.items[i];
        if (layer->wanted != &studio->layers.path) canvas->begin_layer(canvas, layer->wanted->id);
        gd__layer_draw(layer, &studio->stage, canvas);
        if (layer->wanted != &studio->layers.path) canvas->end_layer(canvas);
    }
    if (studio->has_source && !picture->path) draw_source(studio, canvas);
    gd__labels_draw(studio->layers.items, studio->layers.count, &studio->stage, canvas);
    gd__legend_draw(&studio->legend, &studio->scale, canvas);
}

static enum gd_status finish_png(struct studio *studio, void **bytes, size_t *size)
{
    struct gd__paint paint;
    struct gd_control control = gd__share_control(&studio->share, studio->arena.budget.held);
    enum gd_status status = gd__paint_open(&paint, &studio->image, &studio->arena, &control);
    if (!status) draw_lines(studio, &paint.canvas);
    if (!status) status = paint.canvas.status;
    return status ? status
                  : gd__image_png(&studio->image, &studio->arena.budget, &control, bytes, size);
}

static enum gd_status finish_svg(struct studio *studio, void **bytes, size_t *size)
{
    struct gd__svg svg;
    struct gd_control control = gd__share_control(&studio->share, studio->arena.budget.held);
    void *png;
    size_t png_size;
    enum gd_status status =
        gd__image_png(&studio->image, &studio->arena.budget, &control, &png, &png_size);
    if (status) return status;
    gd__svg_open(&svg, studio->legend.width, studio->legend.height, png, png_size,
                 &studio->arena.budget);
    free(png);
    draw_lines(studio, &svg.canvas);
    return gd__svg_close(&svg, bytes, size);
}

/* --- public calls ----------------------------------------------------------------------------- */

static void set_up(struct studio *studio, const struct gd_picture *picture,
                   const struct gd_control *control)
{
    struct gd_point source;
    uint32_t width = gd__request_width(picture), height = gd__request_height(picture);
    studio->picture = picture;
    studio->mesh = picture->mesh;
    studio->palette = gd__request_palette(picture);
    studio->arena.budget.control = control;
    studio->legend.width = width;
    studio->legend.height = height;
    if (picture->field) {
        studio->scale = gd__request_scale(picture);
        studio->has_source = gd_field_single_seed(picture->field, &source);
    }
    if (studio->has_source) studio->source = gd_point_position(picture->mesh, &source);
    uint32_t isolines = gd__isoline_count(picture, &studio->scale);
    studio->share.control = control;
    studio->share.total = 1 + ((height - 1) / gd__raster_rows(width) + 1) + isolines +
                          (isolines > 0) + picture->layer_count + (picture->path != NULL);
}

static enum gd_status draw(struct studio *studio)
{
    struct subject subject = {0};
    enum gd_status status =
        gd__layer_list_open(&studio->layers, studio->picture, &studio->palette, &studio->arena);
    if (status) return status;
    studio->legend.palette = &studio->palette;
    studio->legend.layers = studio->layers.items;
    studio->legend.layer_count = studio->layers.count;
    gd__legend_plan(&studio->legend, studio->picture);
    status = find_subject(studio, &subject);
    if (!status) status = picture_aim(studio, &subject);
    if (!status) status = draw_surface(studio);
    return status ? status : find_lines(studio);
}

static void picture_clear(struct studio *studio)
{
    for (uint32_t i = 0; i < studio->layers.count; i++) gd__layer_free(&studio->layers.items[i]);
    gd__arena_free(&studio->arena);
    gd__lines_free(&studio->isolines);
}

typedef enum gd_status finisher(struct studio *studio, void **bytes, size_t *size);

static enum gd_status render(const struct gd_picture *picture, const struct gd_control *control,
                             finisher *finish, void **bytes, size_t *size)
{
    struct studio studio = {0};
    if (!gd__request_is_sound(picture)) return GD_INVALID_ARGUMENT;
    set_up(&studio, picture, control);
    enum gd_status status = draw(&studio);
    if (!status) status = finish(&studio, bytes, size);
    picture_clear(&studio);
    return status;
}

enum gd_status gd_picture_png(const struct gd_picture *picture, const struct gd_control *control,
                              void **bytes, size_t *size)
{
    return render(picture, control, finish_png, bytes, size);
}

enum gd_status gd_picture_svg(const struct gd_picture *picture, const struct gd_control *control,
                              void **bytes, size_t *size)
{
    return render(picture, control, finish_svg, bytes, size);
}
