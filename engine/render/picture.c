#include "gd/picture.h"

#include <stdlib.h>

#include "base/share.h"
#include "gd/isoline.h"
#include "render/depth_buffer.h"
#include "render/legend.h"
#include "render/shade.h"
#include "render/view.h"

/* DESIGN. A picture is made in three steps. First the surface is rendered to an image with a depth
 * buffer. Then lines are projected and divided into visible and hidden parts. Finally the lines are
 * drawn on a canvas: the image itself, or an SVG file that embeds the image. */

enum { GRID = 4, WIDTH = 800, HEIGHT = 600, TICKS = 6 };
#define LINE_TOLERANCE 0.1 /* pixels */

/* The state of one picture. Before it is opened, all members except the request are zero. */
struct studio {
    const struct gd_picture *picture;
    const struct gd_mesh *mesh;
    const struct gd__palette *palette;
    struct gd__budget budget;
    struct gd__share share; /* progress, in parts that count as equally long */
    struct gd__legend legend;
    struct gd__scale scale; /* if there is a field */
    struct gd__camera camera;
    struct gd__screen_point *points; /* per vertex */
    struct gd__raster raster;
    struct gd__depth_buffer buffer;
    struct gd__shade shade;
    struct gd__image image;
    struct gd__lines isolines, path_seen, path_hidden;
    bool end_is_seen[2];
    /* ends of the path; without a path, end[0] is the field's source */
    struct gd__pixel_point end[2];
    uint32_t end_count;
};

/* --- the request ------------------------------------------------------------------------------ */

static bool is_side(uint32_t pixels)
{
    return pixels >= GD_PICTURE_LEAST && pixels <= GD_PICTURE_MOST;
}

/* Returns false if a member is out of the range given in gd/picture.h. */
static bool is_sound(const struct gd_picture *picture, uint32_t width, uint32_t height)
{
    struct gd_vec3 d = picture->direction;
    if (!is_side(width) || !is_side(height) || (uint64_t)width * height > GD_PICTURE_PIXELS)
        return false;
    if (picture->isolines > GD_PICTURE_ISOLINES || !gd_vec3_is_finite(picture->up) ||
        !gd_vec3_is_finite(d))
        return false;
    if (picture->field && gd_field_mesh(picture->field) != picture->mesh) return false;
    return picture->view != GD_VIEW_DIRECTION || d.x != 0 || d.y != 0 || d.z != 0;
}

/* --- view ------------------------------------------------------------------------------------- */

static struct gd_vec3 inside(const struct gd_mesh *mesh, const struct gd_point *point)
{
    return gd_vec3_scale(gd_point_position(mesh, point), 1 / mesh->unit);
}

/* Lists the positions that should be visible: the path, or the source of the field. *count is 0
 * without both. */
static enum gd_status find_subject(struct studio *studio, struct gd_vec3 **out, uint32_t *count)
{
    struct gd_point source;
    const struct gd_path *path = studio->picture->path;
    bool has_source =
        studio->picture->field && gd_field_single_seed(studio->picture->field, &source);
    uint32_t points = path ? path->count : has_source ? 1 : 0;
    enum gd_status status =
        gd__budget_take(&studio->budget, points * (sizeof **out + sizeof(struct gd__screen_point)));
    *out = status ? NULL : malloc((points + 1) * sizeof **out);
    if (!*out) return status ? status : GD_NO_MEMORY;
    for (uint32_t i = 0; i < points; i++)
        (*out)[i] = inside(studio->mesh, path ? &path->points[i] : &source);
    *count = points;
    return GD_OK;
}

static enum gd_status picture_aim(struct studio *studio, const struct gd_vec3 *subject,
                                  uint32_t count)
{
    const struct gd_picture *picture = studio->picture;
    struct gd_vec3 direction = picture->view == GD_VIEW_DIRECTION
                                   ? picture->direction
                                   : gd__view_direction(picture->view, picture->up);
    struct gd_control control = gd__share_control(&studio->share, studio->budget.held);
    enum gd_status status = GD_OK;
    if (picture->view == GD_VIEW_CHOSEN && count)
        status = gd__view_choose(studio->mesh, picture->up, subject, count, &studio->budget,
                                 &control, &direction);
    if (status) return status;
    struct gd__viewport window = gd__legend_window(&studio->legend);
    studio->camera = gd__camera_aim(studio->mesh, direction, picture->up);
    gd__camera_fit(&studio->camera, studio->mesh, &window);
    return GD_OK;
}

/* --- the surface ------------------------------------------------------------------------------ */

static enum gd_status open_surface(struct studio *studio)
{
    const struct gd_mesh *mesh = studio->mesh;
    studio->raster = (struct gd__raster){.mesh = mesh,
                                         .points = studio->points,
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
    struct gd_control control = gd__share_control(&studio->share, studio->budget.held);
    enum gd_status status = gd__raster_open(&studio->raster, &control);
    if (!status) status = gd__shade_open(&studio->shade, &control);
    if (!status) status = gd__depth_buffer_open(&studio->buffer, &studio->raster);
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
        gd__budget_take(&studio->budget, mesh->vertex_count * sizeof *studio->points);
    studio->points = status ? NULL : malloc(mesh->vertex_count * sizeof *studio->points);
    if (!studio->points) return status ? status : GD_NO_MEMORY;
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        studio->points[v] = gd__camera_project(&studio->camera, mesh->position[v]);
    status = open_surface(studio);
    for (uint32_t band = 0; !status && band < studio->raster.bands; band++) {
        struct gd_control control = gd__share_control(&studio->share, studio->budget.held);
        status = gd__raster_fill(&studio->raster, band, &control);
        studio->share.done++;
        if (!status) status = gd__shade_band(&studio->shade, band, &control, &studio->image);
        if (!status) gd__depth_buffer_take(&studio->buffer, &studio->raster, band);
        studio->share.done++;
    }
    return status;
}

/* --- lines ------------------------------------------------------------------------------------ */

static enum gd_status picture_split(struct studio *studio, const struct gd_path *line,
                                    struct gd__lines *seen, struct gd__lines *hidden)
{
    struct gd__screen_point *points = malloc(line->count * sizeof *points);
    if (!points) return GD_NO_MEMORY;
    for (uint32_t i = 0; i < line->count; i++)
        points[i] = gd__camera_project(&studio->camera, inside(studio->mesh, &line->points[i]));
    enum gd_status status =
        gd__depth_buffer_split(&studio->buffer, points, line->count, seen, hidden);
    free(points);
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
        status = picture_split(studio, &flat, &studio->isolines, NULL);
        gd_path_free(&flat);
    }
    return status;
}

static enum gd_status trace_isolines(struct studio *studio, const struct gd_isoline_index *index)
{
    enum gd_status status = GD_OK;
    for (uint32_t k = 1; k <= studio->scale.count && !status; k++) {
        struct gd_isoline isoline;
        struct gd_control control = gd__share_control(&studio->share, studio->budget.held);
        status = gd_isoline_trace_indexed(index, k * studio->scale.step, &control, &isoline);
        studio->share.done++;
        if (status) break;
        status = split_isoline(studio, &isoline, &control);
        gd_isoline_free(&isoline);
    }
    return status;
}

static enum gd_status find_isolines(struct studio *studio)
{
    struct gd_isoline_index *index;
    struct gd_control control = gd__share_control(&studio->share, studio->budget.held);
    enum gd_status status = gd__budget_take(&studio->budget, gd_isoline_index_bytes(studio->mesh));
    if (!status) status = gd_isoline_index_create(studio->picture->field, &control, &index);
    studio->share.done++;
    if (status) return status;
    status = trace_isolines(studio, index);
    gd_isoline_index_destroy(index);
    return status;
}

/* Projects the path's ends, or the field's source, and tests whether they are visible. */
static void find_ends(struct studio *studio, const struct gd_vec3 *subject, uint32_t count)
{
    studio->end_count = count > 1 ? 2 : count;
    for (uint32_t i = 0; i < studio->end_count; i++) {
        struct gd__screen_point point =
            gd__camera_project(&studio->camera, subject[i ? count - 1 : 0]);
        studio->end[i] = (struct gd__pixel_point){point.x, point.y};
        studio->end_is_seen[i] = gd__depth_buffer_visibility(&studio->buffer, &point, 1) > 0;
    }
}

static enum gd_status find_lines(struct studio *studio, const struct gd_vec3 *subject,
                                 uint32_t count)
{
    enum gd_status status = GD_OK;
    if (studio->picture->field && studio->picture->isolines) status = find_isolines(studio);
    if (!status && studio->picture->path)
        status =
            picture_split(studio, studio->picture->path, &studio->path_seen, &studio->path_hidden);
    find_ends(studio, subject, count);
    return status;
}

/* --- the canvas ------------------------------------------------------------------------------- */

/* Draws an end: the first as a ring, the last as a disc. */
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
    struct gd_control control = gd__share_control(&studio->share, studio->budget.held);
    enum gd_status status = gd__paint_open(&paint, &studio->image, &studio->budget, &control);
    if (!status) draw_lines(studio, &paint.canvas);
    if (!status) status = paint.canvas.status;
    gd__paint_close(&paint);
    return status ? status : gd__image_png(&studio->image, &studio->budget, &control, bytes, size);
}

static enum gd_status finish_svg(struct studio *studio, void **bytes, size_t *size)
{
    struct gd__svg svg;
    struct gd_control control = gd__share_control(&studio->share, studio->budget.held);
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

/* --- public calls ----------------------------------------------------------------------------- */

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
    studio->share.control = control;
    studio->share.total = 1 + 2 * ((height - 1) / gd__raster_rows(width) + 1) +
                          (picture->isolines ? studio->scale.count + 1 : 0);
}

static void picture_clear(struct studio *studio)
{
    free(studio->points);
    gd__raster_close(&studio->raster);
    gd__depth_buffer_close(&studio->buffer);
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
    if (!status) status = picture_aim(&studio, subject, count);
    if (!status) status = draw_surface(&studio);
    if (!status) status = find_lines(&studio, subject, count);
    if (!status) status = finish(&studio, bytes, size);
    free(subject);
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
