/* Depth buffer: stores depth and face of each pixel, and determines the visible parts of lines on
 * the surface. */
#pragma once

#include "render/lines.h"
#include "render/raster.h"

struct gd__depth_buffer {
    const struct gd_mesh *mesh;
    const struct gd__screen_point *points; /* per vertex; borrowed */
    uint32_t width, height;
    /* for each pixel, depth of a sample near its middle; INFINITY means background */
    float *depth;
    uint32_t *face; /* for each pixel, face of that sample; GD_NONE means background */
};

/* Opens a buffer with arrays in the arena. Errors: GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__depth_buffer_open(struct gd__depth_buffer *buffer,
                                                 const struct gd__raster *raster,
                                                 struct gd__arena *arena);

/* Copies one sample of each pixel of the raster's band. */
void gd__depth_buffer_take(struct gd__depth_buffer *buffer, const struct gd__raster *raster,
                           uint32_t band);

/* Divides a line on the surface into visible and hidden parts. A piece shorter than three pixels,
 * as rounding produces along silhouettes, takes the visibility of its neighbours. Visible parts are
 * added to `seen`, hidden ones to `hidden`, which may be NULL. */
GD_MUST_USE enum gd_status gd__depth_buffer_split(const struct gd__depth_buffer *buffer,
                                                  const struct gd__screen_point *line,
                                                  uint32_t count, struct gd__lines *seen,
                                                  struct gd__lines *hidden);

/* Returns the bytes that gd__depth_buffer_split needs for a line, without its result. */
size_t gd__depth_buffer_split_bytes(const struct gd__screen_point *line, uint32_t count);

/* Returns the visible fraction of a line's length in the picture, in [0,1]; 0 or 1 for a point. */
double gd__depth_buffer_visibility(const struct gd__depth_buffer *buffer,
                                   const struct gd__screen_point *line, uint32_t count);
