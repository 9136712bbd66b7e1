/* Wedges: the final form of windows, 24 bytes each, in chunks: the windows of one side that were
 * propagated together.
 *
 * In the frame of side 0 of the edge, sorted by start. A wedge reaches to where the next one of its
 * chunk begins, the last one to the edge's end; a wedge without a source is a gap. Of a linear
 * wedge `x` is the distance at the edge's origin and `y` the tangent of half the angle under which
 * its line is seen along the edge; its ends are rounded inwards, since beyond them its line is no
 * segment. An edge has a chain of chunks, newest first; mostly one. Chunks of a chain may overlap:
 * each wedge is a path that exists, so the least over all of them is the distance. */
#ifndef GD_WINDOW_WEDGES_H
#define GD_WINDOW_WEDGES_H

#include "window/windows.h"

/* The wedges of a chunk as a structure of arrays. */
struct gd__wedges {
    double *x,
        /* pseudo-source; the sign of y tells on which side of the edge it lies: negative, of side
           0's windows */
        *y;
    /* low half: b0 / length in units of 2^-32; high half: the pseudo-source, GD_NONE for a gap */
    uint64_t *start;
};

struct gd__chunk {
    uint32_t previous; /* of the same edge, always before this one; GD_NONE ends the chain */
    uint32_t count;
    double data[]; /* x, y, start of each wedge */
};

#define GD__CHUNK_UNIT   8            /* bytes: what offsets of chunks count */
#define GD__WEDGE_BYTES  24           /* of one wedge */
#define GD__WEDGE_UNITS  4294967296.0 /* of an edge's length, in which starts are kept */
#define GD__WEDGE_UNIT   (1.0 / GD__WEDGE_UNITS)
#define GD__WEDGE_LATEST 4294967295.0 /* the last start */

/* The arrays of so many wedges behind each other. */
static inline struct gd__wedges gd__wedges_at(double *data, uint32_t count)
{
    return (struct gd__wedges){data, data + count, (uint64_t *)(data + 2 * (size_t)count)};
}

static inline struct gd__wedges gd__chunk_wedges(const struct gd__chunk *chunk)
{
    return gd__wedges_at((double *)chunk->data, chunk->count);
}

static inline uint32_t gd__wedge_start(uint64_t start)
{
    return (uint32_t)start;
}

static inline uint32_t gd__wedge_source(uint64_t start)
{
    return (uint32_t)(start >> 32);
}

/* The window that wedge `i` of a chunk was, in the frame of side 0, y >= 0, without sigma but for a
 * linear one; tags are GD__WINDOW_FAR_SIDE where its source lies across side 1. A gap has source
 * GD_NONE. */
struct gd__window gd__wedge_window(struct gd__wedges wedges, uint32_t count, uint32_t i,
                                   double length);

/* Most wedges that so many windows of a list can give: each may have a gap before it, and the last
 * one behind it. */
static inline uint32_t gd__wedges_bound(uint32_t count)
{
    return 2 * count + 1;
}

/* Writes sorted windows of a side as wedges with the gaps between them to arrays behind each other
 * at `data`; returns how many. `mirrored`: windows of side 1. The slow but general form of
 * gd__kernel.store. */
uint32_t gd__wedges_write(const struct gd__windows *windows, uint32_t count, double length,
                          bool mirrored, double *data);

#endif
