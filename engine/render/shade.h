/* Shade: the colours of a picture's pixels, band by band: light on the surface, and a field's
 * distances. */
#ifndef GD_RENDER_SHADE_H
#define GD_RENDER_SHADE_H

#include "render/image.h"
#include "render/normals.h"
#include "render/raster.h"

#define GD__SHADE_COLOURS 1024

struct gd__fragment;

struct gd__shade {
    const struct gd__raster *raster;
    const struct gd__camera *camera;
    const struct gd__palette *palette;
    const struct gd_field *field; /* NULL: none */
    double range;                 /* of its distances, the caller's unit; more than 0 */
    bool edges;

    /* its own */
    struct gd__colour colours[GD__SHADE_COLOURS + 1]; /* of distances, evenly from 0 to the range */
    struct gd__normal (*corners)[3];
    struct gd__fragment *fragments; /* that wait for their colours */
    struct gd_point *points;        /* where they are, if there is a field, */
    double *distances;              /* and its distances */
    uint32_t fragment_count;
    float (*sum)[4]; /* per pixel of the band: colours times their parts, and the parts */
};

/* What is not its own is set; to be closed, also after a failure. GD_NO_MEMORY, GD_BUDGET,
 * GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__shade_open(struct gd__shade *shade,
                                          const struct gd_control *control);
void gd__shade_close(struct gd__shade *shade);

/* Colours the rows of the band that the raster has filled. GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED,
 * GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__shade_band(struct gd__shade *shade, uint32_t band,
                                          const struct gd_control *control,
                                          struct gd__image *image);

#endif
