/* Canvas: the drawing target of lines, discs and texts: an image (paint.c) or an SVG file (svg.c).
 * All positions and widths are in pixels. */
#pragma once

#include "base/arena.h"
#include "render/camera.h"
#include "render/image.h"
#include "render/lines.h"

struct gd__pen {
    struct gd__colour colour;
    double opacity, width;
    double dash; /* length of dashes and of gaps; 0 means none */
};

enum gd__anchor { GD__ANCHOR_START, GD__ANCHOR_MIDDLE };

struct gd__text {
    /* printable ASCII, the characters of the stroke font (glyph.c) */
    const char *text;
    double x, y, size; /* position on the base line, and font size */
    enum gd__anchor anchor;
    struct gd__colour colour;
    bool has_halo; /* a border of colour `halo` around the letters */
    struct gd__colour halo;
};

/* Each kind of canvas begins with this struct. `status` holds the first failure. After a failure,
 * the functions draw nothing. */
struct gd__canvas {
    void (*stroke)(struct gd__canvas *canvas, const struct gd__lines *lines,
                   const struct gd__pen *pen);
    void (*disc)(struct gd__canvas *canvas, struct gd__pixel_point centre, double radius,
                 struct gd__colour colour, double opacity);
    void (*text)(struct gd__canvas *canvas, const struct gd__text *text);
    /* Draws the colour scale of distances, from 0 at the bottom to the largest distance at the
       top. */
    void (*scale)(struct gd__canvas *canvas, const struct gd__viewport *box);
    /* Begin and end the drawing of the layer of that number. */
    void (*begin_layer)(struct gd__canvas *canvas, uint32_t number);
    void (*end_layer)(struct gd__canvas *canvas);
    enum gd_status status;
};

/* --- on an image ------------------------------------------------------------------------------ */

struct gd__paint {
    struct gd__canvas canvas; /* must be the first member */
    struct gd__image *image;  /* borrowed */
    const struct gd_control *control;
    uint8_t *coverage; /* for each pixel, coverage by the current shape; all 0 between calls */
};

/* Opens a canvas on an image, with its array in the arena. `control` may be NULL; later, a cancel
 * or a deadline sets the canvas' status to GD_CANCELLED or GD_DEADLINE. Errors: GD_NO_MEMORY,
 * GD_BUDGET. */
GD_MUST_USE enum gd_status gd__paint_open(struct gd__paint *paint, struct gd__image *image,
                                          struct gd__arena *arena,
                                          const struct gd_control *control);

/* --- as SVG ----------------------------------------------------------------------------------- */

struct gd__svg {
    struct gd__canvas canvas; /* must be the first member */
    struct gd__budget *budget;
    char *text;
    size_t used, capacity;
};

/* Starts an SVG file of that size. The background is a PNG file, which is embedded. */
void gd__svg_open(struct gd__svg *svg, uint32_t width, uint32_t height, const void *png,
                  size_t size, struct gd__budget *budget);

/* Returns the complete file, owned by the caller, or the first failure. Closes the canvas in both
 * cases. */
GD_MUST_USE enum gd_status gd__svg_close(struct gd__svg *svg, void **bytes, size_t *size);

/* --- letters (glyph.c) ------------------------------------------------------------------------ */

/* Adds the strokes of a text to `out`. */
void gd__text_strokes(const struct gd__text *text, struct gd__lines *out);

/* Returns the width of a text in pixels. In an SVG file it depends on the reader's font, which is
 * narrower. */
double gd__text_width(const char *text, double size);
