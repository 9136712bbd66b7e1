#include "gd/colour_map.h"

#include <math.h>

/* Chroma, and the ranges of lightness and hue, in the Oklab space. They define the longest helix of
 * constant chroma whose colours are all in sRGB. */
#define CHROMA          0.117
#define LIGHTNESS_FIRST 0.45
#define LIGHTNESS_LAST  0.92
#define HUE_FIRST       (310 * M_PI / 180)
#define HUE_LAST        (110 * M_PI / 180)

static double colour_map_cut(double component)
{
    return fmin(fmax(component, 0), 1);
}

double gd_colour_encode(double linear)
{
    double light = colour_map_cut(linear);
    return light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1 / 2.4) - 0.055;
}

/* Converts a colour by the matrices in the definition of Oklab. */
static struct gd_colour from_oklab(double lightness, double a, double b)
{
    double l = lightness + 0.3963377774 * a + 0.2158037573 * b,
           m = lightness - 0.1055613458 * a - 0.0638541728 * b,
           s = lightness - 0.0894841775 * a - 1.2914855480 * b;
    l = l * l * l;
    m = m * m * m;
    s = s * s * s;
    return (struct gd_colour){
        colour_map_cut(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
        colour_map_cut(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
        colour_map_cut(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

struct gd_colour gd_colour_map(double part)
{
    double t = colour_map_cut(part), hue = HUE_FIRST + t * (HUE_LAST - HUE_FIRST);
    return from_oklab(LIGHTNESS_FIRST + t * (LIGHTNESS_LAST - LIGHTNESS_FIRST), CHROMA * cos(hue),
                      CHROMA * sin(hue));
}
