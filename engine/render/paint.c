#include <math.h>

#include "render/canvas.h"

/* Strokes and discs on an image. A pixel's coverage grows from 0, if its middle is half a pixel
 * outside the shape, to 1, if it is half a pixel inside. If several lines of one pen cross or join
 * at a pixel, they cover the pixel only once. */

enum { CHECK_INTERVAL = 256 }; /* segments */

/* Pixels that a shape may touch: [left, right) x [top, bottom). */
struct box {
    uint32_t left, top, right, bottom;
};

static uint32_t paint_clamp(double x, uint32_t most)
{
    return x <= 0 ? 0 : x >= most ? most : (uint32_t)x;
}

static struct box box_of(const struct gd__image *image, double left, double top, double right,
                         double bottom)
{
    return (struct box){
        paint_clamp(floor(left), image->width), paint_clamp(floor(top), image->height),
        paint_clamp(ceil(right), image->width), paint_clamp(ceil(bottom), image->height)};
}

static struct box box_around(struct box a, struct box b)
{
    return (struct box){a.left < b.left ? a.left : b.left, a.top < b.top ? a.top : b.top,
                        a.right > b.right ? a.right : b.right,
                        a.bottom > b.bottom ? a.bottom : b.bottom};
}

/* --- coverage --------------------------------------------------------------------------------- */

static struct box cover_segment(struct gd__paint *paint, struct gd__pixel_point a,
                                struct gd__pixel_point b, float radius)
{
    float reach = radius + 0.5F, x = b.x - a.x, y = b.y - a.y, square = x * x + y * y,
          scale = square > 0 ? 1 / square : 0;
    struct box box = box_of(paint->image, fminf(a.x, b.x) - reach, fminf(a.y, b.y) - reach,
                            fmaxf(a.x, b.x) + reach, fmaxf(a.y, b.y) + reach);
    for (uint32_t row = box.top; row < box.bottom; row++) {
        uint8_t *coverage = paint->coverage + (size_t)row * paint->image->width;
        float py = (float)row + 0.5F - a.y;
        for (uint32_t column = box.left; column < box.right; column++) {
            float px = (float)column + 0.5F - a.x, t = (px * x + py * y) * scale;
            t = t < 0 ? 0 : t > 1 ? 1 : t;
            float dx = px - t * x, dy = py - t * y, square_distance = dx * dx + dy * dy;
            if (square_distance >= reach * reach) continue;
            float part = reach - sqrtf(square_distance);
            uint8_t covered = part >= 1 ? 255 : (uint8_t)(255 * part + 0.5F);
            if (covered > coverage[column]) coverage[column] = covered;
        }
    }
    return box;
}

/* Blends the colour over the covered pixels, and clears the coverage. */
static void fill_coverage(struct gd__paint *paint, struct box box, struct gd__colour colour,
                          double opacity)
{
    for (uint32_t row = box.top; row < box.bottom; row++)
        for (uint32_t column = box.left; column < box.right; column++) {
            size_t pixel = (size_t)row * paint->image->width + column;
            if (!paint->coverage[pixel]) continue;
            gd__image_blend(paint->image, pixel, colour, opacity * paint->coverage[pixel] / 255.0);
            paint->coverage[pixel] = 0;
        }
}

/* --- the canvas ------------------------------------------------------------------------------- */

static enum gd_status draw_lines(struct gd__paint *paint, const struct gd__lines *lines,
                                 const struct gd__pen *pen)
{
    struct box all = {paint->image->width, paint->image->height, 0, 0};
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < lines->count && !status; i++) {
        const struct gd__pixel_point *place = lines->places;
        uint32_t begin = gd__line_begin(lines, i), last = lines->ends[i] - 1;
        for (uint32_t k = begin; (k < last || k == begin) && !status; k++) {
            all = box_around(all, cover_segment(paint, place[k], place[k < last ? k + 1 : k],
                                                (float)(pen->width / 2)));
            if (k % CHECK_INTERVAL == 0) status = gd_control_check(paint->control, 0);
        }
    }
    fill_coverage(paint, all, pen->colour, pen->opacity);
    return status;
}

static void paint_stroke(struct gd__canvas *canvas, const struct gd__lines *lines,
                         const struct gd__pen *pen)
{
    struct gd__lines dashes = {0};
    if (canvas->status) return;
    if (pen->dash > 0) gd__lines_dash(lines, pen->dash, pen->dash, &dashes);
    canvas->status = dashes.status;
    if (!canvas->status)
        canvas->status =
            draw_lines((struct gd__paint *)canvas, pen->dash > 0 ? &dashes : lines, pen);
    gd__lines_free(&dashes);
}

static void paint_disc(struct gd__canvas *canvas, struct gd__pixel_point centre, double radius,
                       struct gd__colour colour, double opacity)
{
    struct gd__paint *paint = (struct gd__paint *)canvas;
    if (canvas->status) return;
    fill_coverage(paint, cover_segment(paint, centre, centre, (float)radius), colour, opacity);
}

static void paint_text(struct gd__canvas *canvas, const struct gd__text *text)
{
    struct gd__lines lines = {0};
    gd__text_strokes(text, &lines);
    if (!canvas->status) canvas->status = lines.status;
    if (text->has_halo)
        paint_stroke(canvas, &lines, &(struct gd__pen){text->halo, 0.9, text->size / 3, 0});
    paint_stroke(canvas, &lines, &(struct gd__pen){text->colour, 1, text->size / 9, 0});
    gd__lines_free(&lines);
}

static void paint_scale(struct gd__canvas *canvas, const struct gd__viewport *area)
{
    struct gd__image *image = ((struct gd__paint *)canvas)->image;
    struct box box =
        box_of(image, area->left, area->top, area->left + area->width, area->top + area->height);
    if (canvas->status) return;
    for (uint32_t row = box.top; row < box.bottom; row++) {
        struct gd__colour colour = gd__colour_of_part(1 - (row + 0.5 - area->top) / area->height);
        for (uint32_t column = box.left; column < box.right; column++)
            gd__image_blend(image, (size_t)row * image->width + column, colour, 1);
    }
}

/* Does nothing, because an image has no groups. */
static void paint_begin_layer(struct gd__canvas *canvas, uint32_t number)
{
    (void)canvas;
    (void)number;
}

static void paint_end_layer(struct gd__canvas *canvas)
{
    (void)canvas;
}

enum gd_status gd__paint_open(struct gd__paint *paint, struct gd__image *image,
                              struct gd__arena *arena, const struct gd_control *control)
{
    size_t pixels = (size_t)image->width * image->height;
    *paint = (struct gd__paint){.canvas = {paint_stroke, paint_disc, paint_text, paint_scale,
                                           paint_begin_layer, paint_end_layer, GD_OK},
                                .image = image,
                                .control = control};
    paint->coverage = gd__arena_zeroed(arena, pixels, 1);
    return arena->status;
}
