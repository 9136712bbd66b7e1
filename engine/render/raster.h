/* Raster: which face is seen at each sample of a picture, band of rows by band of rows.
 *
 * DESIGN. A pixel has grid x grid samples, whose rows are shifted against each other by a part of a
 * sample, so that steep edges are seen at grid^2 places. A face covers those samples that lie
 * between its edges; what is on the common edge of two faces belongs to one of them: there are no
 * gaps, and nothing is counted twice. Faces are listed by the bands that they meet, so that a
 * band's samples stay in the cache while they are written. */
#ifndef GD_RENDER_RASTER_H
#define GD_RENDER_RASTER_H

#include "base/budget.h"
#include "render/camera.h"

/* Rows of pixels of a band: as many as keep its samples in the cache, and the work between two
 * looks at the control short. */
static inline uint32_t gd__raster_rows(uint32_t width)
{
    enum { BAND_PIXELS = 1 << 14 };
    uint32_t rows = BAND_PIXELS / width;
    return rows < 4 ? 4 : rows > 32 ? 32 : rows;
}

struct gd__raster {
    const struct gd_mesh *mesh;
    const struct gd__spot *spots; /* per vertex; borrowed */
    uint32_t width, height;       /* pixels */
    uint32_t grid;                /* a power of two, at most 4 */
    uint32_t rows;                /* of pixels in a band; the last one may be lower */
    uint32_t bands;
    uint32_t *first, *faces;   /* of each band; bands + 1 */
    struct gd__budget *budget; /* pays for it all; may be NULL */
    /* of the band that was filled last, rows of width * grid samples; INFINITY: nothing is seen */
    float *depth;
    uint32_t *face; /* likewise; GD_NONE */
};

/* Lists the faces; those that are seen from behind are left out where the surface is closed. To be
 * closed, also after a failure. GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__raster_open(struct gd__raster *raster,
                                           const struct gd_control *control);
void gd__raster_close(struct gd__raster *raster);

/* Fills a band's samples; `control` may be NULL. GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__raster_fill(struct gd__raster *raster, uint32_t band,
                                           const struct gd_control *control);

/* How far the samples of a row, counted through the picture, are shifted: a part of a sample. */
static inline double gd__raster_shift(uint32_t grid, uint32_t row)
{
    return (row % grid + 0.5) / grid - 0.5;
}

/* The corners of a face. */
static inline void gd__corners(const struct gd_mesh *mesh, uint32_t face, uint32_t corners[3])
{
    for (int k = 0; k < 3; k++) corners[k] = mesh->origin[mesh->face_side[face][k]];
}

#endif
