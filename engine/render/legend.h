/* Legend: what colours and a path's length are in numbers, beside the surface. */
#ifndef GD_RENDER_LEGEND_H
#define GD_RENDER_LEGEND_H

#include "render/canvas.h"
#include "render/scale.h"

/* All lengths are in pixels; a unit is one of them in a picture of 800 x 600, and grows with its
 * sides. */
struct gd__legend {
    const struct gd_picture *picture;
    const struct gd__palette *palette;
    uint32_t width, height;
    double unit;
    bool has_scale, has_length; /* is asked for, and there is room for it */
};

struct gd__legend gd__legend_plan(const struct gd_picture *picture,
                                  const struct gd__palette *palette, uint32_t width,
                                  uint32_t height);

/* What it leaves for the surface. */
struct gd__window_of_picture gd__legend_window(const struct gd__legend *legend);

/* `scale` is for a legend that has one. */
void gd__legend_draw(const struct gd__legend *legend, const struct gd__scale *scale,
                     struct gd__canvas *canvas);

#endif
