#include "render/image.h"

#include <math.h>

/* Applies Porter and Duff's "over", for colours that are not premultiplied by opacity. */
void gd__image_blend(struct gd__image *image, size_t pixel, struct gd__colour colour,
                     double opacity)
{
    uint8_t *at = image->pixel[pixel];
    double below = (1 - opacity) * (at[3] / 255.0), sum = opacity + below;
    const double over[3] = {colour.red, colour.green, colour.blue};
    if (sum <= 0) return;
    for (int k = 0; k < 3; k++)
        at[k] = (uint8_t)lround((opacity * 255 * over[k] + below * at[k]) / sum);
    at[3] = (uint8_t)lround(255 * sum);
}
