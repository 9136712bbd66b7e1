/* Shade: computes the colours of a picture's pixels, band by band, from the light on the surface
 * and a field's distances. */
#pragma once

#include "render/image.h"
#include "render/raster.h"

#define GD__SHADE_COLOURS 1024

struct gd__normal {
    float x, y, z;
};

struct gd__fragment;

struct gd__shade {
    const struct gd__raster *raster;
    const struct gd__camera *camera;
    const struct gd__palette *palette;
    const struct gd_field *field; /* NULL means that there is none */
    /* largest distance of the scale, in the caller's unit; more than 0 */
    double range;
    bool edges;

    /* private members */
    /* colours of evenly spaced distances from 0 to `range` */
    struct gd__colour colours[GD__SHADE_COLOURS + 1];
    struct gd__normal (*corners)[3];
    struct gd__fragment *fragments; /* fragments that are not coloured yet */
    struct gd_point *points;        /* if there is a field: the fragments' points */
    double *distances;              /* if there is a field: their distances */
    uint32_t fragment_count;
    /* for each pixel of the band, the sum of weighted colours, and the sum of weights */
    float (*sum)[4];
};

/* Opens a shade, whose public members the caller has set, with arrays in the arena. The
 * threads of the control's executor compute the normals. Errors: GD_NO_MEMORY, GD_BUDGET,
 * GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__shade_open(struct gd__shade *shade, struct gd__arena *arena,
                                          const struct gd_control *control);

/* Returns a copy of an open shade that colours bands of its own, those of `raster`. The copy's
 * scratch arrays are in the arena. Failures are in the arena's status. */
struct gd__shade gd__shade_copy(const struct gd__shade *shade, const struct gd__raster *raster,
                                struct gd__arena *arena);

/* Colours the image's rows of the band that the raster has filled. Errors: GD_NO_MEMORY, GD_BUDGET,
 * GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__shade_band(struct gd__shade *shade, uint32_t band,
                                          const struct gd_control *control,
                                          struct gd__image *image);
