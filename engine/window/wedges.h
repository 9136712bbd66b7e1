/* Wedges: the final form of windows, stored in chunks. A chunk holds, as wedges, the windows of one
 * side that were propagated together. Its wedges are in the frame of side 0 of the edge, sorted by
 * start. A wedge ends where the next wedge of its chunk starts; the last one ends at the edge's
 * end. A wedge without a source is a gap. In a linear wedge (a wedge of a segment source), `x` is
 * the distance at the origin of the edge, and `y` is the tangent of half the angle between the edge
 * and the direction to the segment. The ends of a linear wedge are rounded inwards, because no
 * shortest path leads from the segment to points beyond these ends.
 *
 * An edge has a chain of chunks, newest first; most chains have one chunk. Chunks of a chain may
 * overlap. Each wedge describes an existing path, so the distance is the minimum over all wedges.
 *
 * A wedge takes 21, 22 or 24 bytes, depending on the form of its chunk. Coordinates in the
 * normalised unit are far below 2^63, so they need at most 7 bits of a double's exponent. After
 * scaling by a power of two, x and y have 4 unused bits each. These bits hold the lower 8 bits of
 * the source's number, so x and y lose no precision (doc 030). */
#ifndef GD_WINDOW_WEDGES_H
#define GD_WINDOW_WEDGES_H

#include <string.h>

#include "window/windows.h"

/* Forms of a chunk. They store 16, 24 or (WIDE) 32 bits of a source's number. If all these bits are
 * set, the wedge is a gap. In the WIDE form, x and y hold no bits of the source's number. */
enum gd__wedge_form { GD__WEDGE_16, GD__WEDGE_24, GD__WEDGE_WIDE };

struct gd__chunk {
    /* offset of the next older chunk of the same edge, which is less than the offset of this chunk;
     * GD_NONE ends the chain */
    uint32_t previous;
    uint32_t count : 29;
    /* 1 if the chunk's windows belong to side 1, 0 if they belong to side 0 */
    uint32_t is_far : 1;
    uint32_t form : 2;
    uint64_t data[]; /* the arrays of struct gd__wedges */
};

/* The arrays of a chunk, in this order. x is 8-byte aligned. */
struct gd__wedges {
    uint32_t *start; /* b0 / length in units of 2^-32 */
    /* for each wedge, the part of the source's number that x and y do not hold: 1, 2 or 4 bytes */
    void *high;
    /* Packed with bits of the source's number. y is negative for windows of side 0, positive for
       windows of side 1. */
    double *x, *y;
    uint32_t count;
    enum gd__wedge_form form;
};

#define GD__CHUNK_UNIT   8            /* unit of chunk offsets, in bytes */
#define GD__WEDGE_LEAST  21           /* bytes of one wedge in the shortest form */
#define GD__WEDGE_UNITS  4294967296.0 /* the number of units per edge in which starts are stored */
#define GD__WEDGE_UNIT   (1.0 / GD__WEDGE_UNITS)
#define GD__WEDGE_LATEST 4294967295.0 /* the largest start */

/* Packing of x and y: if a number below LIMIT is multiplied by SCALE, the four bits from bit SHIFT
 * upwards are 0. */
#define GD__WEDGE_LIMIT   0x1p63
#define GD__WEDGE_SCALE   0x1p-959
#define GD__WEDGE_UNSCALE 0x1p959
#define GD__WEDGE_SHIFT   59
#define GD__WEDGE_NIBBLE  15u
#define GD__WEDGE_MASK    (~((uint64_t)GD__WEDGE_NIBBLE << GD__WEDGE_SHIFT))

/* Returns the form with the fewest bytes that can number `sources` sources (vertices and seeds). */
static inline enum gd__wedge_form gd__wedge_form_of(uint64_t sources)
{
    return sources < UINT16_MAX                ? GD__WEDGE_16
           : sources < (UINT32_C(1) << 24) - 1 ? GD__WEDGE_24
                                               : GD__WEDGE_WIDE;
}

/* Returns true if all coordinates on a mesh can be packed. `shortest` and `longest` are edge
 * lengths in the normalised unit. The coordinates are bounded because no path is longer than all
 * edges together. */
static inline bool gd__wedges_fit(double shortest, double longest, uint32_t edges)
{
    return shortest >= GD_TOL_PACKED && longest * edges < GD__WEDGE_LIMIT / 2;
}

/* Returns the size in bytes of the arrays `start` and `high`. */
static inline size_t gd__wedge_heads_bytes(uint32_t count, enum gd__wedge_form form)
{
    size_t each = form == GD__WEDGE_WIDE ? 8 : 5 + (size_t)form;
    return (each * count + 7) & ~(size_t)7;
}

static inline size_t gd__wedges_bytes(uint32_t count, enum gd__wedge_form form)
{
    return gd__wedge_heads_bytes(count, form) + 2 * sizeof(double) * (size_t)count;
}

static inline size_t gd__chunk_bytes(const struct gd__chunk *chunk)
{
    return sizeof *chunk + gd__wedges_bytes(chunk->count, chunk->form);
}

static inline struct gd__wedges gd__chunk_wedges(const struct gd__chunk *chunk)
{
    char *data = (char *)chunk->data;
    uint32_t count = chunk->count;
    double *x = (double *)(data + gd__wedge_heads_bytes(count, chunk->form));
    return (struct gd__wedges){.start = (uint32_t *)data,
                               .high = data + sizeof(uint32_t) * (size_t)count,
                               .x = x,
                               .y = x + count,
                               .count = count,
                               .form = chunk->form};
}

/* Returns the wedges from `first` on. */
static inline struct gd__wedges gd__wedges_from(const struct gd__wedges *w, uint32_t first)
{
    return (struct gd__wedges){.start = w->start + first,
                               .high = (char *)w->high + ((size_t)first << w->form),
                               .x = w->x + first,
                               .y = w->y + first,
                               .count = w->count - first,
                               .form = w->form};
}

static inline uint64_t gd__wedge_bits(const double *packed)
{
    uint64_t bits;
    memcpy(&bits, packed, sizeof bits);
    return bits;
}

static inline double gd__wedge_unpack(const struct gd__wedges *wedges, const double *packed)
{
    if (wedges->form == GD__WEDGE_WIDE) return *packed;
    uint64_t bits = gd__wedge_bits(packed) & GD__WEDGE_MASK;
    double scaled;
    memcpy(&scaled, &bits, sizeof scaled);
    return scaled * GD__WEDGE_UNSCALE;
}

/* Returns the pseudo-source of wedge `i`; GD_NONE for a gap. */
static inline uint32_t gd__wedge_source(const struct gd__wedges *wedges, uint32_t i)
{
    if (wedges->form == GD__WEDGE_WIDE) return ((const uint32_t *)wedges->high)[i];
    bool is_short = wedges->form == GD__WEDGE_16;
    uint32_t all = is_short ? UINT16_MAX : (UINT32_C(1) << 24) - 1,
             high = is_short ? ((const uint8_t *)wedges->high)[i]
                             : ((const uint16_t *)wedges->high)[i],
             low = (gd__wedge_bits(&wedges->x[i]) >> GD__WEDGE_SHIFT & GD__WEDGE_NIBBLE) |
                   (gd__wedge_bits(&wedges->y[i]) >> GD__WEDGE_SHIFT & GD__WEDGE_NIBBLE) << 4,
             source = high << 8 | low;
    return source == all ? GD_NONE : source;
}

/* Writes wedge `i`. x and y must be below GD__WEDGE_LIMIT unless the form is wide. */
void gd__wedge_put(const struct gd__wedges *wedges, uint32_t i, uint32_t start, double x, double y,
                   uint32_t source);

/* Returns wedge `i` as a window in the frame of side 0, with y >= 0. Sets sigma only for linear
 * wedges. Sets the tag GD__WINDOW_FAR_SIDE if the window belongs to side 1. A gap has the source
 * GD_NONE. */
struct gd__window gd__wedge_window(const struct gd__wedges *wedges, uint32_t i, double length);

/* Returns an upper bound on the number of wedges for `count` windows: there may be a gap before
 * each window and after the last one. */
static inline uint32_t gd__wedges_bound(uint32_t count)
{
    return 2 * count + 1;
}

/* Returns an upper bound on the bytes of a chunk of `count` windows, in any form, and of the group
 * that kernels may write behind it. */
static inline size_t gd__chunk_bound(uint32_t count)
{
    return sizeof(struct gd__chunk) + gd__wedges_bytes(gd__wedges_bound(count), GD__WEDGE_WIDE) +
           GD__WINDOWS_GROUP * sizeof(double);
}

/* Writes sorted windows of a side to a chunk, as wedges with gaps between them. Uses the chunk's
 * form, or WIDE if a window needs it. Sets the count and the side. `mirrored` is true if the
 * windows belong to side 1. This is the general form of gd__kernel.store. */
void gd__chunk_write(const struct gd__windows *windows, uint32_t count, double length,
                     bool mirrored, struct gd__chunk *out);

#endif
