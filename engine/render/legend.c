#include "render/legend.h"

#include <stdio.h>
#include <string.h>

/* Lengths in units of the legend (legend.h), unless stated otherwise. */
#define MARGIN      16.0 /* margin around the surface */
#define COLUMN      92.0 /* width of the scale, on the right */
#define ROW         30.0 /* height of the row with the names of layers, at the bottom */
#define FURTHER_ROW 22.0 /* height of each further row */
#define SIDE        18.0 /* margin left of the first name and right of the last name */
#define SAMPLE      36.0 /* width of a sample, with the gap to its name */
#define BETWEEN     24.0 /* gap between two names in a row */
#define BAR_WIDTH   14.0
#define BAR_PART    0.62 /* height of the colour bar, relative to the picture's height */
#define TICK        4.0
#define LETTERS     13.0
#define TICK_APART  1.6           /* least distance between two numbers, in text heights */
#define LEAST_SIDE  200           /* pixels; a picture with a smaller side has no legend */
#define AREA        (800.0 * 600) /* pixels of a picture whose unit is one pixel */

/* --- names of layers -------------------------------------------------------------------------- */

/* The position of the next name. */
struct cursor {
    double x;
    uint32_t row;
    char text[GD_PICTURE_LABEL + 1]; /* the name, shortened if the picture is too narrow */
};

/* Shortens a text to a width. */
static void name_fit(char *text, double size, double width)
{
    size_t length = strlen(text);
    while (length > 2 && gd__text_width(text, size) > width) {
        text[--length] = '\0';
        text[length - 1] = text[length - 2] = '.';
    }
}

/* Moves the cursor, which is zero at first, to the position of a name: beside the last name, or
 * below it if the row is full. */
static void cursor_move(const struct gd__legend *legend, const char *name, struct cursor *cursor)
{
    double unit = legend->unit, left = SIDE * unit, size = LETTERS * unit,
           room = legend->width - 2 * left - SAMPLE * unit,
           end = cursor->x > 0 ? cursor->x + SAMPLE * unit + gd__text_width(cursor->text, size) : 0;
    snprintf(cursor->text, sizeof cursor->text, "%s", name);
    name_fit(cursor->text, size, room);
    double width = SAMPLE * unit + gd__text_width(cursor->text, size);
    if (end > 0 && end + BETWEEN * unit + width <= legend->width - left) {
        cursor->x = end + BETWEEN * unit;
        return;
    }
    cursor->row += end > 0;
    cursor->x = left;
}

static uint32_t count_rows(const struct gd__legend *legend)
{
    struct cursor cursor = {0};
    for (uint32_t i = 0; i < legend->layer_count; i++)
        if (legend->layers[i].wanted->name)
            cursor_move(legend, legend->layers[i].wanted->name, &cursor);
    return cursor.x > 0 ? cursor.row + 1 : 0;
}

void gd__legend_plan(struct gd__legend *legend, const struct gd_picture *picture)
{
    uint32_t width = legend->width, height = legend->height,
             least = width < height ? width : height;
    bool has_room = picture->legend && least >= LEAST_SIDE;
    legend->unit = fmax(sqrt((double)width * height / AREA), 0.75);
    legend->has_scale = has_room && picture->field;
    legend->rows = has_room ? count_rows(legend) : 0;
    legend->is_over_surface = picture->zoom > 1;
    /* names never take more than half of the picture */
    while (legend->rows > 1 &&
           (ROW + (legend->rows - 1) * FURTHER_ROW) * legend->unit > height / 2.0)
        legend->rows--;
}

struct gd__viewport gd__legend_window(const struct gd__legend *legend)
{
    double margin = fmin(MARGIN * legend->unit, 0.1 * fmin(legend->width, legend->height)),
           column = legend->has_scale ? COLUMN * legend->unit : 0,
           row = legend->rows ? (ROW + (legend->rows - 1) * FURTHER_ROW) * legend->unit : 0;
    return (struct gd__viewport){margin, margin, legend->width - 2 * margin - column,
                                 legend->height - 2 * margin - row};
}

/* Draws a text in the legend's font size and colour. */
static void put_text(const struct gd__legend *legend, struct gd__canvas *canvas, const char *text,
                     double x, double y, enum gd__anchor anchor)
{
    canvas->text(canvas, &(struct gd__text){.text = text,
                                            .x = x,
                                            .y = y,
                                            .size = LETTERS * legend->unit,
                                            .anchor = anchor,
                                            .colour = legend->palette->ink,
                                            .has_halo = legend->is_over_surface,
                                            .halo = legend->palette->background});
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

/* Draws a sample of a layer's lines or marks. */
static void draw_sample(const struct gd__legend *legend, const struct gd__layer *layer,
                        struct gd__pixel_point at, struct gd__canvas *canvas)
{
    double unit = legend->unit, width = gd__layer_width(layer->wanted, unit);
    struct gd__lines line = {0};
    if (!layer->wanted->first) {
        canvas->disc(canvas, (struct gd__pixel_point){(float)(at.x + 13 * unit), at.y},
                     fmin(width, 6 * unit), layer->colour, 1);
        return;
    }
    gd__lines_add(&line, at.x, at.y);
    gd__lines_add(&line, at.x + 26 * unit, at.y);
    gd__lines_end(&line);
    if (!canvas->status) canvas->status = line.status;
    canvas->stroke(canvas, &line, &(struct gd__pen){layer->colour, 1, fmin(width, 8 * unit), 0});
    gd__lines_free(&line);
}

static void draw_names(const struct gd__legend *legend, struct gd__canvas *canvas)
{
    double unit = legend->unit;
    struct cursor cursor = {0};
    for (uint32_t i = 0; i < legend->layer_count; i++) {
        const struct gd__layer *layer = &legend->layers[i];
        if (!layer->wanted->name) continue;
        cursor_move(legend, layer->wanted->name, &cursor);
        if (cursor.row >= legend->rows) return;
        double y = legend->height - (16 + (legend->rows - 1 - cursor.row) * FURTHER_ROW) * unit;
        draw_sample(legend, layer, (struct gd__pixel_point){(float)cursor.x, (float)y}, canvas);
        put_text(legend, canvas, cursor.text, cursor.x + SAMPLE * unit, y + 0.36 * LETTERS * unit,
                 GD__ANCHOR_START);
    }
}

void gd__legend_draw(const struct gd__legend *legend, const struct gd__scale *scale,
                     struct gd__canvas *canvas)
{
    if (legend->has_scale) draw_scale(legend, scale, canvas);
    if (legend->rows) draw_names(legend, canvas);
}
