/* Colour map: a colour for a distance, the same in pictures and in files. */
#ifndef GD_COLOUR_MAP_H
#define GD_COLOUR_MAP_H

#ifdef __cplusplus
extern "C" {
#endif

/* Components of linear light, in [0,1] (glTF has these; pictures and web pages have them
 * encoded). */
struct gd_colour {
    double red, green, blue;
};

/* The colour of a part of the largest distance, cut to [0,1]: a helix in the Oklab space (B.
 * Ottosson, "A perceptual color space for image processing", 2020) of constant chroma, whose
 * lightness grows evenly while the hue goes from violet by blue and green to yellow. So equal steps
 * of distance are equal steps to the eye; who sees fewer hues, or none, is left with the order by
 * lightness; and lines in red or black show on all of it. */
struct gd_colour gd_colour_map(double part);

/* A component as sRGB encodes it (IEC 61966-2-1), cut to [0,1]. */
double gd_colour_encode(double linear);

#ifdef __cplusplus
}
#endif

#endif
