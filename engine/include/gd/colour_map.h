/* Colour map: maps distances to colours. Pictures and files use the same map. */
#ifndef GD_COLOUR_MAP_H
#define GD_COLOUR_MAP_H

#include "gd/language.h"

GD_EXTERN_C_BEGIN

/* A colour in linear light, with components in [0,1]. glTF uses linear components. Pictures and web
 * pages use the components encoded by gd_colour_encode. */
struct gd_colour {
    double red, green, blue;
};

/* Returns the colour of `part`, a distance as a fraction of the largest one, clamped to [0,1]. The
 * map is a helix in the Oklab space (B. Ottosson, "A perceptual color space for image processing",
 * 2020): its chroma is constant, its lightness increases evenly, and its hues run from violet
 * through blue and green to yellow. Equal steps of distance look equally large. Colour-blind
 * viewers can see the order from the lightness. Red and black lines contrast with all colours of
 * the map. */
struct gd_colour gd_colour_map(double part);

/* Returns the sRGB encoding (IEC 61966-2-1) of a linear component, clamped to [0,1]. */
double gd_colour_encode(double linear);

GD_EXTERN_C_END

#endif
