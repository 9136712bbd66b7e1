/* Colour: of distances, of the surface, of lines. Components are those of sRGB, in [0,1]. */
#ifndef GD_RENDER_COLOUR_H
#define GD_RENDER_COLOUR_H

#include "gd/picture.h"

struct gd__colour {
    float red, green, blue;
};

/* gd_colour_map, encoded. */
struct gd__colour gd__colour_of_part(double part);

/* As part of a picture on that background. */
struct gd__palette {
    struct gd__colour background, surface, inside, line, ink, path, halo;
    bool is_transparent;
};

const struct gd__palette *gd__palette(enum gd_background background);

#endif
