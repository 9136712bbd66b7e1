/* Canvas: what lines, marks and texts are drawn on: an image (paint.c) or the text of an SVG file
 * (svg.c). All places and widths are in pixels. */
#ifndef GD_RENDER_CANVAS_H
#define GD_RENDER_CANVAS_H

#include "render/camera.h"
#include "render/image.h"
#include "render/lines.h"

struct gd__pen {
    struct gd__colour colour;
    double opacity, width;
    double dash; /* length of dashes and of gaps; 0: none */
};

enum gd__anchor { GD__ANCHOR_START, GD__ANCHOR_MIDDLE };

struct gd__text {
    /* of the characters that the stroke font has: digits, ".+-e", the letters of "distance" and
       "path length", space */
    const char *text;
    double x, y, size; /* of the base line */
    enum gd__anchor anchor;
    struct gd__colour colour;
};

/* Begins each kind of canvas. A failure stays in `status`; nothing is drawn then. */
struct gd__canvas {
    void (*stroke)(struct gd__canvas *canvas, const struct gd__lines *lines,
                   const struct gd__pen *pen);
    void (*disc)(struct gd__canvas *canvas, struct gd__place centre, double radius,
                 struct gd__colour colour, double opacity);
    void (*text)(struct gd__canvas *canvas, const struct gd__text *text);
    /* The colours of distances, from 0 below to the largest one above. */
    void (*scale)(struct gd__canvas *canvas, const struct gd__window_of_picture *box);
    enum gd_status status;
};

/* --- on an image ------------------------------------------------------------------------------ */

struct gd__paint {
    struct gd__canvas canvas; /* first */
    struct gd__image *image;  /* borrowed */
    const struct gd_control *control;
    uint8_t *coverage; /* per pixel, of what is being drawn; 0 between two calls */
};

/* `control` may be NULL; who is to stop finds GD_CANCELLED or GD_DEADLINE in the canvas' status.
 * GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__paint_open(struct gd__paint *paint, struct gd__image *image,
                                          struct gd__budget *budget,
                                          const struct gd_control *control);
void gd__paint_close(struct gd__paint *paint); /* also after a failure */

/* --- as SVG ----------------------------------------------------------------------------------- */

struct gd__svg {
    struct gd__canvas canvas; /* first */
    struct gd__budget *budget;
    char *text;
    size_t used, capacity;
};

/* Begins a file of that size over an image, a PNG file. */
void gd__svg_open(struct gd__svg *svg, uint32_t width, uint32_t height, const void *png,
                  size_t size, struct gd__budget *budget);

/* The whole file, the caller's; or the failure that stayed. It is closed either way. */
GD_MUST_USE enum gd_status gd__svg_close(struct gd__svg *svg, void **bytes, size_t *size);

/* --- letters (glyph.c) ------------------------------------------------------------------------ */

/* Adds the strokes of a text. */
void gd__text_strokes(const struct gd__text *text, struct gd__lines *out);

#endif
