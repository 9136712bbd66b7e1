/* Legend: draws the colour scale with its numbers beside the surface, and below it the names of
 * layers, with samples of their lines and marks. */
#pragma once

#include "render/layer.h"
#include "render/scale.h"

/* All lengths are in pixels. `unit` is the legend's unit of length: one pixel in a picture of 800 x
 * 600, and proportionally more in larger pictures. */
struct gd__legend {
    const struct gd__palette *palette;
    const struct gd__layer *layers; /* borrowed */
    uint32_t layer_count;
    uint32_t width, height;
    double unit;
    bool has_scale;       /* true if a scale is requested and the picture is large enough */
    uint32_t rows;        /* rows of names */
    bool is_over_surface; /* the surface may reach below the legend */
};

/* Computes the unit and the parts of the legend from the picture and the other members. */
void gd__legend_plan(struct gd__legend *legend, const struct gd_picture *picture);

/* Returns the viewport that remains for the surface. */
struct gd__viewport gd__legend_window(const struct gd__legend *legend);

/* Draws the legend. `scale` is only used if has_scale. */
void gd__legend_draw(const struct gd__legend *legend, const struct gd__scale *scale,
                     struct gd__canvas *canvas);
