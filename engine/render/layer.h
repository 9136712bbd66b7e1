/* Layers: the polylines and marks of a picture. A layer is projected, divided into visible and
 * hidden parts, and drawn on a canvas. */
#pragma once

#include "render/canvas.h"
#include "render/depth_buffer.h"

/* The data that all layers of a picture share. */
struct gd__stage {
    const struct gd_mesh *mesh;
    const struct gd__camera *camera;
    const struct gd__depth_buffer *buffer;
    const struct gd__palette *palette;
    struct gd__arena *arena;
    double unit; /* unit of the legend, in pixels */
};

struct gd__mark {
    struct gd__pixel_point at;
    bool is_seen;
};

struct gd__layer { /* before the projection, all members except the first two are zero */
    const struct gd_picture_layer *wanted;
    struct gd__colour colour;
    struct gd__lines seen, hidden;
    struct gd__mark *marks; /* the marks; or two ends, if `wanted->ends` shows them */
    uint32_t mark_count;
};

/* Returns the colour that the layer sets. If it sets none, marks get the colour of isolines, and
 * lines get colour `number` of a list. */
struct gd__colour gd__layer_colour(const struct gd_picture_layer *layer, uint32_t number,
                                   const struct gd__palette *palette);

/* Returns the width of a layer's lines, or the radius of its marks, in pixels. */
double gd__layer_width(const struct gd_picture_layer *layer, double unit);

/* Projects the layer, which must be freed even after a failure. Errors: GD_NO_MEMORY, GD_BUDGET,
 * GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__layer_project(struct gd__layer *layer, const struct gd__stage *stage,
                                             const struct gd_control *control);
void gd__layer_free(struct gd__layer *layer);

/* Draws the layer without its labels. */
void gd__layer_draw(const struct gd__layer *layer, const struct gd__stage *stage,
                    struct gd__canvas *canvas);

/* Draws the labels of all layers beside their marks, so that labels do not cover each other where
 * there is room. */
void gd__labels_draw(const struct gd__layer *layers, uint32_t count, const struct gd__stage *stage,
                     struct gd__canvas *canvas);
