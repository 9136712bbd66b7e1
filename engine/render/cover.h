/* Cover: what covers each pixel of a picture, and so which parts of a line on the surface are
 * seen. */
#ifndef GD_RENDER_COVER_H
#define GD_RENDER_COVER_H

#include "render/lines.h"
#include "render/raster.h"

struct gd__cover {
    const struct gd_mesh *mesh;
    const struct gd__spot *spots; /* per vertex; borrowed */
    uint32_t width, height;
    float *depth;   /* per pixel, of one sample near its middle; INFINITY: nothing is there */
    uint32_t *face; /* likewise; GD_NONE */
};

/* To be closed, also after a failure. GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__cover_open(struct gd__cover *cover, const struct gd__raster *raster);
void gd__cover_close(struct gd__cover *cover);

/* Takes over what the raster's band shows. */
void gd__cover_take(struct gd__cover *cover, const struct gd__raster *raster, uint32_t band);

/* A line on the surface, cut where it goes behind something or comes forth: a piece shorter than
 * three pixels, such as rounding makes of a line along a silhouette, counts as what is around it.
 * What is seen is added to `seen`, the rest to `hidden`, which may be NULL. */
GD_MUST_USE enum gd_status gd__cover_split(const struct gd__cover *cover,
                                           const struct gd__spot *line, uint32_t count,
                                           struct gd__lines *seen, struct gd__lines *hidden);

/* The part of a line's length in the picture that is seen, in [0,1]; of a point 0 or 1. */
double gd__cover_visibility(const struct gd__cover *cover, const struct gd__spot *line,
                            uint32_t count);

#endif
