#include "render/colour.h"

#include "gd/colour_map.h"

struct gd__colour gd__colour_of_part(double part)
{
    struct gd_colour colour = gd_colour_map(part);
    return (struct gd__colour){(float)gd_colour_encode(colour.red),
                               (float)gd_colour_encode(colour.green),
                               (float)gd_colour_encode(colour.blue)};
}

struct gd__colour gd__colour_of_rgb(uint32_t rgb)
{
    return (struct gd__colour){(float)(rgb >> 16 & 255) / 255, (float)(rgb >> 8 & 255) / 255,
                               (float)(rgb & 255) / 255};
}

const struct gd__palette *gd__palette(enum gd_background background)
{
    static const struct gd__palette palettes[] = {
        [GD_BACKGROUND_WHITE] = {.background = {1, 1, 1},
                                 .surface = {0.86F, 0.88F, 0.90F},
                                 .inside = {0.80F, 0.74F, 0.66F},
                                 .line = {0.08F, 0.09F, 0.12F},
                                 .ink = {0.20F, 0.22F, 0.26F},
                                 .path = {0.82F, 0.07F, 0.12F},
                                 .halo = {1, 1, 1}},
        [GD_BACKGROUND_DARK] = {.background = {0.09F, 0.10F, 0.12F},
                                .surface = {0.80F, 0.82F, 0.85F},
                                .inside = {0.72F, 0.66F, 0.58F},
                                .line = {0.05F, 0.06F, 0.08F},
                                .ink = {0.85F, 0.87F, 0.90F},
                                .path = {0.86F, 0.08F, 0.13F},
                                .halo = {1, 1, 1}},
        [GD_BACKGROUND_TRANSPARENT] = {.background = {1, 1, 1},
                                       .surface = {0.86F, 0.88F, 0.90F},
                                       .inside = {0.80F, 0.74F, 0.66F},
                                       .line = {0.08F, 0.09F, 0.12F},
                                       .ink = {0.45F, 0.47F, 0.50F},
                                       .path = {0.82F, 0.07F, 0.12F},
                                       .halo = {1, 1, 1},
                                       .is_transparent = true},
    };
    return &palettes[background];
}
