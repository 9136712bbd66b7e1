/* Raster: computes the visible face at each sample of a picture, in bands of rows.
 *
 * DESIGN. A pixel has grid x grid samples. Rows of samples are shifted against each other by
 * fractions of a sample, so that steep edges are sampled at grid^2 positions. A face covers the
 * samples between its edges. A sample on the common edge of two faces belongs to exactly one of
 * them, so that there are no gaps and no overlaps. Faces are listed by the bands that they meet, so
 * that a band's samples stay in the cache. */
#pragma once

#include "base/arena.h"
#include "render/camera.h"

/* Returns the number of pixel rows of a band, chosen so that its samples fit the cache and checks
 * of the control are frequent. */
static inline uint32_t gd__raster_rows(uint32_t width)
{
    enum { BAND_PIXELS = 1 << 14 };
    uint32_t rows = BAND_PIXELS / width;
    return rows < 4 ? 4 : rows > 32 ? 32 : rows;
}

struct gd__raster {
    const struct gd_mesh *mesh;
    const struct gd__screen_point *points; /* per vertex; borrowed */
    uint32_t width, height;                /* pixels */
    uint32_t grid;                         /* a power of two, at most 4 */
    uint32_t rows;                         /* pixel rows in a band; the last band may have fewer */
    uint32_t bands;
    bool is_closed; /* true if faces that are seen from behind are hidden */
    /* the faces of band b are faces[first[b]] to faces[first[b + 1] - 1]; NULL means that there is
       one band, which may have all faces */
    uint32_t *first, *faces;
    /* depths of the last filled band, in rows of width * grid samples; INFINITY means no face */
    float *depth;
    uint32_t *face; /* faces of those samples; GD_NONE means no face */
};

/* Opens a raster with arrays in the arena, and lists the faces of its bands on the threads of the
 * control's executor. If the surface is closed, faces that are seen from behind are omitted.
 * Errors: GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__raster_open(struct gd__raster *raster, struct gd__arena *arena,
                                           const struct gd_control *control);

/* Returns a copy of an open raster that fills bands of its own. The copy's samples are in the
 * arena, and its other arrays are those of the original. Failures are in the arena's status. */
struct gd__raster gd__raster_copy(const struct gd__raster *raster, struct gd__arena *arena);

/* Fills the samples of a band; `control` may be NULL. Errors: GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__raster_fill(struct gd__raster *raster, uint32_t band,
                                           const struct gd_control *control);

/* Returns the shift of a sample row, as a fraction of a sample. Rows are numbered through the
 * picture. */
static inline double gd__raster_shift(uint32_t grid, uint32_t row)
{
    return (row % grid + 0.5) / grid - 0.5;
}

/* Returns the three vertices of a face. */
static inline void gd__corners(const struct gd_mesh *mesh, uint32_t face, uint32_t corners[3])
{
    for (int k = 0; k < 3; k++) corners[k] = mesh->origin[mesh->face_side[face][k]];
}
