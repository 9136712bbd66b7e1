/* Image: one byte each of red, green, blue and opacity for each pixel. Colours are not
 * premultiplied by opacity. */
#pragma once

#include "base/budget.h"
#include "render/colour.h"

struct gd__image {
    uint32_t width, height;
    bool is_opaque;      /* true if no pixel is transparent */
    uint8_t (*pixel)[4]; /* rows from top to bottom */
};

/* Blends a colour with an opacity over a pixel. */
void gd__image_blend(struct gd__image *image, size_t pixel, struct gd__colour colour,
                     double opacity);

/* Encodes the image as a PNG file (RFC 2083) of `*size` bytes at `*bytes`, owned by the caller.
 * `control` may be NULL. Errors: GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__image_png(const struct gd__image *image, struct gd__budget *budget,
                                         const struct gd_control *control, void **bytes,
                                         size_t *size);
