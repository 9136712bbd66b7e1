#include "render/legend.h"

#include <stdio.h>

/* Lengths in units of the legend (legend.h), unless stated otherwise. */
#define MARGIN     16.0 /* margin around the surface */
#define COLUMN     92.0 /* width of the scale, on the right */
#define ROW        30.0 /* height of the line with the length, at the bottom */
#define BAR_WIDTH  14.0
#define BAR_PART   0.62 /* height of the colour bar, relative to the picture's height */
#define TICK       4.0
#define LETTERS    13.0
#define TICK_APART 1.6           /* least distance of two numbers, in text heights */
#define LEAST_SIDE 200           /* pixels: smaller pictures have no legend */
#define AREA       (800.0 * 600) /* pixels of a picture whose unit is one pixel */

struct gd__legend gd__legend_plan(const struct gd_picture *picture,
                                  const struct gd__palette *palette, uint32_t width,
                                  uint32_t height)
{
    uint32_t least = width < height ? width : height;
    bool has_room = picture->legend && least >= LEAST_SIDE;
    return (struct gd__legend){.picture = picture,
                               .palette = palette,
                               .width = width,
                               .height = height,
                               .unit = fmax(sqrt((double)width * height / AREA), 0.75),
                               .has_scale = has_room && picture->field,
                               .has_length = has_room && picture->path};
}

struct gd__viewport gd__legend_window(const struct gd__legend *legend)
{
    double margin = fmin(MARGIN * legend->unit, 0.1 * fmin(legend->width, legend->height)),
           column = legend->has_scale ? COLUMN * legend->unit : 0,
           row = legend->has_length ? ROW * legend->unit : 0;
    return (struct gd__viewport){margin, margin, legend->width - 2 * margin - column,
                                 legend->height - 2 * margin - row};
}

/* Draws a text in the legend's font size and colour. */
static void put_text(const struct gd__legend *legend, struct gd__canvas *canvas, const char *text,
                     double x, double y, enum gd__anchor anchor)
{
    canvas->text(canvas, &(struct gd__text){text, x, y, LETTERS * legend->unit, anchor,
                                            legend->palette->ink});
}

static void draw_tick(const struct gd__legend *legend, struct gd__canvas *canvas, double x,
                      double y, double distance)
{
    char number[32];
    double unit = legend->unit;
    struct gd__lines line = {0};
    snprintf(number, sizeof number, "%.6g", distance);
    gd__lines_add(&line, x, y);
    gd__lines_add(&line, x + TICK * unit, y);
    gd__lines_end(&line);
    if (!canvas->status) canvas->status = line.status;
    canvas->stroke(canvas, &line, &(struct gd__pen){legend->palette->ink, 1, unit, 0});
    gd__lines_free(&line);
    put_text(legend, canvas, number, x + (TICK + 4) * unit, y + 0.36 * LETTERS * unit,
             GD__ANCHOR_START);
}

static void draw_scale(const struct gd__legend *legend, const struct gd__scale *scale,
                       struct gd__canvas *canvas)
{
    double unit = legend->unit, height = BAR_PART * legend->height;
    struct gd__viewport bar = {floor(legend->width - (COLUMN - 4) * unit),
                               floor(0.5 * (legend->height - height)), ceil(BAR_WIDTH * unit),
                               floor(height)};
    double right = bar.left + bar.width, apart = TICK_APART * LETTERS * unit,
           pixels = bar.height * scale->step / scale->range;
    uint32_t every = 1 + (uint32_t)(apart / pixels);
    canvas->scale(canvas, &bar);
    put_text(legend, canvas, "distance", bar.left, bar.top - 12 * unit, GD__ANCHOR_START);
    for (uint32_t k = 0; k <= scale->count; k += every)
        draw_tick(legend, canvas, right, bar.top + bar.height - k * pixels, k * scale->step);
}

static void draw_length(const struct gd__legend *legend, struct gd__canvas *canvas)
{
    char text[48];
    double unit = legend->unit, y = legend->height - 16 * unit, x = 18 * unit;
    struct gd__lines line = {0};
    snprintf(text, sizeof text, "path length %.9g", legend->picture->path->length);
    gd__lines_add(&line, x, y);
    gd__lines_add(&line, x + 26 * unit, y);
    gd__lines_end(&line);
    if (!canvas->status) canvas->status = line.status;
    canvas->stroke(canvas, &line, &(struct gd__pen){legend->palette->path, 1, 3 * unit, 0});
    gd__lines_free(&line);
    put_text(legend, canvas, text, x + 36 * unit, y + 0.36 * LETTERS * unit, GD__ANCHOR_START);
}

void gd__legend_draw(const struct gd__legend *legend, const struct gd__scale *scale,
                     struct gd__canvas *canvas)
{
    if (legend->has_scale) draw_scale(legend, scale, canvas);
    if (legend->has_length) draw_length(legend, canvas);
}
