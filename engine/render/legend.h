/* Legend: draws the colour scale with its numbers, and a path's length, beside the surface. */
#ifndef GD_RENDER_LEGEND_H
#define GD_RENDER_LEGEND_H

#include "render/canvas.h"
#include "render/scale.h"

/* All lengths are in pixels. `unit` is the legend's unit of length: one pixel in a picture of 800 x
 * 600, and proportionally more in larger pictures. */
struct gd__legend {
    const struct gd_picture *picture;
    const struct gd__palette *palette;
    uint32_t width, height;
    double unit;
    bool has_scale, has_length; /* true if requested and the picture is large enough */
};

struct gd__legend gd__legend_plan(const struct gd_picture *picture,
                                  const struct gd__palette *palette, uint32_t width,
                                  uint32_t height);

/* Returns the viewport that remains for the surface. */
struct gd__viewport gd__legend_window(const struct gd__legend *legend);

/* Draws the legend. `scale` is only used if has_scale. */
void gd__legend_draw(const struct gd__legend *legend, const struct gd__scale *scale,
                     struct gd__canvas *canvas);

#endif
