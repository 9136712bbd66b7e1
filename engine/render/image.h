/* Image: pixels of red, green, blue and opacity, a byte each, not multiplied by the opacity. */
#ifndef GD_RENDER_IMAGE_H
#define GD_RENDER_IMAGE_H

#include "base/budget.h"
#include "render/colour.h"

struct gd__image {
    uint32_t width, height;
    bool is_opaque;      /* all of it */
    uint8_t (*pixel)[4]; /* row by row from above */
};

/* To be closed, also after a failure; pixels are uninitialised. GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__image_open(struct gd__image *image, uint32_t width, uint32_t height,
                                          struct gd__budget *budget);
void gd__image_close(struct gd__image *image);

/* Lays a colour of that opacity over a pixel. */
void gd__image_blend(struct gd__image *image, size_t pixel, struct gd__colour colour,
                     double opacity);

/* The image as a PNG file (RFC 2083), `*size` bytes at `*bytes`, owned by the caller. `control` may
 * be NULL. GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__image_png(const struct gd__image *image, struct gd__budget *budget,
                                         const struct gd_control *control, void **bytes,
                                         size_t *size);

#endif
