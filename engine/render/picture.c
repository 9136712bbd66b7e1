#include "gd/picture.h"

#include <stdlib.h>

#include "gd/isoline.h"
#include "render/cover.h"
#include "render/legend.h"
#include "render/shade.h"
#include "render/view.h"

/* DESIGN. A picture is made in three steps: the surface becomes an image, with a note of what
 * covers each pixel; lines become places in the picture, cut where they go behind something; both
 * are put together on a canvas, which is the image itself or an SVG file that embeds it. */

enum { GRID = 4, WIDTH = 800, HEIGHT = 600, TICKS = 6 };
#define LINE_TOLERANCE 0.1 /* pixels */

/* All zero before it is opened, but for the request. */
struct studio {
    const struct gd_picture *picture;
    const struct gd_mesh *mesh;
    const struct gd__palette *palette;
    struct gd__budget budget;
    uint32_t part, parts; /* in work, and all of them, which count as equally long */
    double told;          /* of the whole */
    struct gd__legend legend;
    struct gd__scale scale; /* of a field */
    struct gd__camera camera;
    struct gd__spot *spots; /* per vertex */
    struct gd__raster raster;
    struct gd__cover cover;
    struct gd__shade shade;
    struct gd__image image;
    struct gd__lines isolines, path_seen, path_hidden;
    bool end_is_seen[2];
    struct gd__place end[2]; /* of the path, or end[0]: the field's source */
    uint32_t end_count;
};

/* A part may be told of in several runs; the whole only goes on. */
static bool report(void *user, double fraction)
{
    struct studio *studio = user;
    const struct gd_control *control = studio->budget.control;
    studio->told = fmax(studio->told, (studio->part + fraction) / studio->parts);
    return control->progress(control->user, studio->told);
}

/* The control of a long call that is within the part in work. */
static struct gd_control control_of(struct studio *studio)
{
    const struct gd_control *control = studio->budget.control;
    struct gd_control own = control ? *control : (struct gd_control){0};
    size_t held = studio->budget.held;
    /* 0: no limit */
    if (own.budget_bytes) own.budget_bytes = own.budget_bytes > held ? own.budget_bytes - held : 1;
    own.progress = own.progress ? report : NULL;
    own.user = studio;
    return own;
}

/* --- the request ------------------------------------------------------------------------------ */

static bool is_finite(struct gd_vec3 v)
{
    return isfinite(v.x) && isfinite(v.y) && isfinite(v.z);
}

static bool is_side(uint32_t pixels)
{
    return pixels >= GD_PICTURE_LEAST && pixels <= GD_PICTURE_MOST;
}

/* False: something is outside what picture.h says. */
static bool is_sound(const struct gd_picture *picture, uint32_t width, uint32_t height)
{
    struct gd_vec3 d = picture->direction;
    if (!is_side(width) || !is_side(height) || (uint64_t)width * height > GD_PICTURE_PIXELS)
        return false;
    if (picture->isolines > GD_PICTURE_ISOLINES || !is_finite(picture->up) || !is_finite(d))
        return false;
    if (picture->field && gd_field_mesh(picture->field) != picture->mesh) return false;
    return picture->view != GD_VIEW_DIRECTION || d.x != 0 || d.y != 0 || d.z != 0;
}

/* --- where it is seen from -------------------------------------------------------------------- */

static struct gd_vec3 inside(const struct gd_mesh *mesh, const struct gd_point *point)
{
    return gd_vec3_scale(gd_point_position(mesh, point), 1 / mesh->unit);
}

/* What is to be seen: the path, or the source of the field. `*count` 0: nothing of the kind. */
static enum gd_status find_subject(struct studio *studio, struct gd_vec3 **out, uint32_t *count)
{
    struct gd_point source;
    const struct gd_path *path = studio->picture->path;
    bool has_source =
        studio->picture->field && gd_field_single_seed(studio->picture->field, &source);
    uint32_t points = path ? path->count : has_source ? 1 : 0;
    enum gd_status status =
        gd__budget_take(&studio->budget, points * (sizeof **out + sizeof(struct gd__spot)));
    *out = status ? NULL : malloc((points + 1) * sizeof **out);
    if (!*out) return status ? status : GD_NO_MEMORY;
    for (uint32_t i = 0; i < points; i++)
        (*out)[i] = inside(studio->mesh, path ? &path->points[i] : &source);
    *count = points;
    return GD_OK;
}

static enum gd_status aim(struct studio *studio, const struct gd_vec3 *subject, uint32_t count)
{
    const struct gd_picture *picture = studio->picture;
    struct gd_vec3 direction = picture->view == GD_VIEW_DIRECTION
                                   ? picture->direction
                                   : gd__view_direction(picture->view, picture->up);
    struct gd_control control = control_of(studio);
    enum gd_status status = GD_OK;
    if (picture->view == GD_VIEW_CHOSEN && count)
        status = gd__view_choose(studio->mesh, picture->up, subject, count, &studio->budget,
                                 &control, &direction);
    if (status) return status;
    struct gd__window_of_picture window = gd__legend_window(&studio->legend);
    studio->camera = gd__camera_aim(studio->mesh, direction, picture->up);
    gd__camera_fit(&studio->camera, studio->mesh, &window);
    return GD_OK;
}

/* --- the surface ------------------------------------------------------------------------------ */

static enum gd_status open_surface(struct studio *studio)
{
    const struct gd_mesh *mesh = studio->mesh;
    studio->raster = (struct gd__raster){.mesh = mesh,
                                         .spots = studio->spots,
                                         .width = studio->legend.width,
                                         .height = studio->legend.height,
                                         .grid = GRID,
                                         .rows = gd__raster_rows(studio->legend.width),
                                         .budget = &studio->budget};
    studio->shade = (struct gd__shade){.raster = &studio->raster,
                                       .camera = &studio->camera,
                                       .palette = studio->palette,
                                       .field = studio->picture->field,
                                       .range = studio->scale.range,
                                       .edges = studio->picture->edges};
    struct gd_control control = control_of(studio);
    enum gd_status status = gd__raster_open(&studio->raster, &control);
    if (!status) status = gd__shade_open(&studio->shade, &control);
    if (!status) status = gd__cover_open(&studio->cover, &studio->raster);
    if (!status)
        status = gd__image_open(&studio->image, studio->raster.width, studio->raster.height,
                                &studio->budget);
    studio->image.is_opaque = !studio->palette->is_transparent;
    return status;
}

static enum gd_status draw_surface(struct studio *studio)
{
    const struct gd_mesh *mesh = studio->mesh;
    enum gd_status status =
        gd__budget_take(&studio->budget, mesh->vertex_count * sizeof *studio->spots);
    studio->spots = status ? NULL : malloc(mesh->vertex_count * sizeof *studio->spots);
    if (!studio->spots) return status ? status : GD_NO_MEMORY;
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        studio->spots[v] = gd__camera_project(&studio->camera, mesh->position[v]);
    status = open_surface(studio);
    for (uint32_t band = 0; !status && band < studio->raster.bands; band++) {
        struct gd_control control = control_of(studio);
        status = gd__raster_fill(&studio->raster, band, &control);
        studio->part++;
        if (!status) status = gd__shade_band(&studio->shade, band, &control, &studio->image);
        if (!status) gd__cover_take(&studio->cover, &studio->raster, band);
        studio->part++;
    }
    return status;
}

/* --- lines ------------------------------------------------------------------------------------ */

static enum gd_status split(struct studio *studio, const struct gd_path *line,
                            struct gd__lines *seen, struct gd__lines *hidden)
{
    struct gd__spot *spots = malloc(line->count * sizeof *spots);
    if (!spots) return GD_NO_MEMORY;
    for (uint32_t i = 0; i < line->count; i++)
        spots[i] = gd__camera_project(&studio->camera, inside(studio->mesh, &line->points[i]));
    enum gd_status status = gd__cover_split(&studio->cover, spots, line->count, seen, hidden);
    free(spots);
    return status;
}

static enum gd_status split_isoline(struct studio *studio, const struct gd_isoline *isoline,
                                    const struct gd_control *control)
{
    double tolerance = LINE_TOLERANCE / studio->camera.scale * studio->mesh->unit;
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < isoline->line_count && !status; i++) {
        struct gd_path flat;
        status = gd_isoline_flatten(studio->mesh, &isoline->lines[i], tolerance, control, &flat);
        if (status) break;
        status = split(studio, &flat, &studio->isolines, NULL);
        gd_path_free(&flat);
    }
    return status;
}

static enum gd_status find_isolines(struct studio *studio)
{
    enum gd_status status = GD_OK;
    for (uint32_t k = 1; k <= studio->scale.count && !status; k++) {
        struct gd_isoline isoline;
        struct gd_control control = control_of(studio);
        status =
            gd_isoline_trace(studio->picture->field, k * studio->scale.step, &control, &isoline);
        studio->part++;
        if (status) break;
        status = split_isoline(studio, &isoline, &control);
        gd_isoline_free(&isoline);
    }
    return status;
}

/* The path's ends, or a field's source. */
static void find_ends(struct studio *studio, const struct gd_vec3 *subject, uint32_t count)
{
    studio->end_count = count > 1 ? 2 : count;
    for (uint32_t i = 0; i < studio->end_count; i++) {
        struct gd__spot spot = gd__camera_project(&studio->camera, subject[i ? count - 1 : 0]);
        studio->end[i] = (struct gd__place){spot.x, spot.y};
        studio->end_is_seen[i] = gd__cover_visibility(&studio->cover, &spot, 1) > 0;
    }
}

static enum gd_status find_lines(struct studio *studio, const struct gd_vec3 *subject,
                                 uint32_t count)
{
    enum gd_status status = GD_OK;
    if (studio->picture->field && studio->picture->isolines) status = find_isolines(studio);
    if (!status && studio->picture->path)
        status = split(studio, studio->picture->path, &studio->path_seen, &studio->path_hidden);
    find_ends(studio, subject, count);
    return status;
}

/* --- the canvas ------------------------------------------------------------------------------- */

/* The first end is a ring, the last one a disc. */
static void draw_end(const struct studio *studio, uint32_t i, struct gd__canvas *canvas)
{
    const struct gd__palette *palette = studio->palette;
    struct gd__colour outer = i ? palette->halo : palette->path,
                      inner = i ? palette->path : palette->halo;
    double opacity = studio->end_is_seen[i] ? 1 : 0.4, unit = studio->legend.unit;
    canvas->disc(canvas, studio->end[i], 5.5 * unit, outer, opacity);
    canvas->disc(canvas, studio->end[i], (i ? 4.2 : 2.8) * unit, inner, opacity);
}

static void draw_lines(const struct studio *studio, struct gd__canvas *canvas)
{
    const struct gd__palette *palette = studio->palette;
    double unit = studio->legend.unit;
    canvas->stroke(canvas, &studio->isolines,
                   &(struct gd__pen){palette->line, 0.5, fmax(unit, 0.8), 0});
    canvas->stroke(canvas, &studio->path_hidden,
                   &(struct gd__pen){palette->path, 0.6, 2 * unit, 5 * unit});
    canvas->stroke(canvas, &studio->path_seen,
                   &(struct gd__pen){palette->halo, 0.85, 5.4 * unit, 0});
    canvas->stroke(canvas, &studio->path_seen, &(struct gd__pen){palette->path, 1, 3 * unit, 0});
    for (uint32_t i = 0; i < studio->end_count; i++) draw_end(studio, i, canvas);
    gd__legend_draw(&studio->legend, &studio->scale, canvas);
}

static enum gd_status finish_png(struct studio *studio, void **bytes, size_t *size)
{
    struct gd__paint paint;
    struct gd_control control = control_of(studio);
    enum gd_status status = gd__paint_open(&paint, &studio->image, &studio->budget, &control);
    if (!status) draw_lines(studio, &paint.canvas);
    if (!status) status = paint.canvas.status;
    gd__paint_close(&paint);
    return status ? status : gd__image_png(&studio->image, &studio->budget, &control, bytes, size);
}

static enum gd_status finish_svg(struct studio *studio, void **bytes, size_t *size)
{
    struct gd__svg svg;
    struct gd_control control = control_of(studio);
    void *png;
    size_t png_size;
    enum gd_status status =
        gd__image_png(&studio->image, &studio->budget, &control, &png, &png_size);
    if (status) return status;
    gd__svg_open(&svg, studio->legend.width, studio->legend.height, png, png_size, &studio->budget);
    free(png);
    draw_lines(studio, &svg.canvas);
    return gd__svg_close(&svg, bytes, size);
}

/* --- the whole -------------------------------------------------------------------------------- */

static void set_up(struct studio *studio, const struct gd_picture *picture,
                   const struct gd_control *control)
{
    uint32_t width = picture->width ? picture->width : WIDTH,
             height = picture->height ? picture->height : HEIGHT;
    studio->picture = picture;
    studio->mesh = picture->mesh;
    studio->palette = gd__palette(picture->background);
    studio->budget = (struct gd__budget){.control = control};
    studio->legend = gd__legend_plan(picture, studio->palette, width, height);
    if (picture->field)
        studio->scale = gd__scale_of(gd__field_range(picture->field),
                                     picture->isolines ? picture->isolines : TICKS);
    studio->parts = 1 + 2 * ((height - 1) / gd__raster_rows(width) + 1) +
                    (picture->isolines ? studio->scale.count : 0);
}

static void clear(struct studio *studio)
{
    free(studio->spots);
    gd__raster_close(&studio->raster);
    gd__cover_close(&studio->cover);
    gd__shade_close(&studio->shade);
    gd__image_close(&studio->image);
    gd__lines_free(&studio->isolines);
    gd__lines_free(&studio->path_seen);
    gd__lines_free(&studio->path_hidden);
}

typedef enum gd_status finisher(struct studio *studio, void **bytes, size_t *size);

static enum gd_status render(const struct gd_picture *picture, const struct gd_control *control,
                             finisher *finish, void **bytes, size_t *size)
{
    struct studio studio = {0};
    struct gd_vec3 *subject = NULL;
    uint32_t count = 0;
    if (!is_sound(picture, picture->width ? picture->width : WIDTH,
                  picture->height ? picture->height : HEIGHT))
        return GD_INVALID_ARGUMENT;
    set_up(&studio, picture, control);
    enum gd_status status = find_subject(&studio, &subject, &count);
    if (!status) status = aim(&studio, subject, count);
    if (!status) status = draw_surface(&studio);
    if (!status) status = find_lines(&studio, subject, count);
    if (!status) status = finish(&studio, bytes, size);
    free(subject);
    clear(&studio);
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
