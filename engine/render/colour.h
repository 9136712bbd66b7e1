/* Colours of distances, of the surface and of lines. Components are sRGB in [0,1]. */
#pragma once

#include "gd/picture.h"

struct gd__colour {
    float red, green, blue;
};

/* Returns gd_colour_map(part), encoded as sRGB. */
struct gd__colour gd__colour_of_part(double part);

/* Returns the colour 0xRRGGBB. */
struct gd__colour gd__colour_of_rgb(uint32_t rgb);

/* The colours of a picture with one kind of background. */
struct gd__palette {
    struct gd__colour background, surface, inside, line, ink, path, halo;
    bool is_transparent;
};

const struct gd__palette *gd__palette(enum gd_background background);
