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
 * A wedge takes 19, 20 or 24 bytes, depending on the form of its chunk. In the packed forms, x and
 * y are whole numbers of 50 bits, in units that the chunk's exponent defines. Their error is at
 * most 2^(exponent - 50) (doc 030). */
#pragma once

#include <string.h>

#include "window/windows.h"

/* Forms of a chunk. The packed forms store 20 or 28 bits of a source's number, WIDE stores 32 bits
 * and doubles. If all these bits are set, the wedge is a gap. */
enum gd__wedge_form { GD__WEDGE_20, GD__WEDGE_28, GD__WEDGE_WIDE };

struct gd__chunk {
    uint32_t count : 21;
    uint32_t exponent : 7; /* packed forms: see GD__WEDGE_BIAS */
    /* 1 if the chunk's windows belong to side 1, 0 if they belong to side 0 */
    uint32_t is_far : 1;
    /* 1 if the arrays are followed by the offset of the next older chunk of the same edge; that
     * offset is less than this chunk's own */
    uint32_t has_previous : 1;
    uint32_t form : 2;
    uint32_t data[]; /* the arrays of struct gd__wedges */
};

/* Numbers of 64 bits in a chunk have the alignment of 32 bits. */
typedef uint64_t __attribute__((aligned(4))) gd__chunk_word;
typedef double __attribute__((aligned(4))) gd__chunk_double;

/* The arrays of a chunk. In the packed forms they are, in this order, word, start, high, middle and
 * low; in the WIDE form x, y, start and high. */
struct gd__wedges {
    gd__chunk_word *word;    /* x, the 12 lowest bits of the source, the 2 lowest bits of y */
    gd__chunk_double *x, *y; /* WIDE, y >= 0 */
    uint32_t *start;         /* b0 / length in units of 2^-32 */
    uint32_t *high;          /* bits 18 to 49 of y; WIDE: the source */
    uint16_t *middle;        /* bits 2 to 17 of y */
    void *low;               /* the source's number from bit 12 on: 1 or 2 bytes each */
    uint32_t count;
    enum gd__wedge_form form;
    int exponent; /* packed forms: |x| and y are below 2^exponent */
    bool is_far;
};

#define GD__CHUNK_UNIT   8            /* unit of chunk offsets, in bytes */
#define GD__CHUNK_MOST   0x1fffff     /* the largest number of wedges in a chunk */
#define GD__CHUNK_SLACK  16           /* bytes behind a chunk that kernels may read */
#define GD__WEDGE_LEAST  19           /* bytes of one wedge in the shortest form */
#define GD__WEDGE_UNITS  4294967296.0 /* the number of units per edge in which starts are stored */
#define GD__WEDGE_UNIT   (1.0 / GD__WEDGE_UNITS)
#define GD__WEDGE_LATEST 4294967295.0 /* the largest start */

/* Packing. In units of 2^(exponent - 49), x is between -2^49 and 2^49. In units of 2^(exponent -
 * 50), y is below 2^50. Adding gd__wedge_zero rounds to a whole number of units and moves this
 * number, plus 2^49 for x, to the lower bits of the double. Subtracting gd__wedge_zero unpacks the
 * number. */
#define GD__WEDGE_X_SHIFT    14 /* place of x in a word */
#define GD__WEDGE_Y_SHIFT    2  /* number of bits of y in a word */
#define GD__WEDGE_LOW_SHIFT  12 /* number of bits of the source in a word */
#define GD__WEDGE_LOW_MASK   0xfffu
#define GD__WEDGE_HIGH_SHIFT 18 /* number of bits of y below `high` */
#define GD__WEDGE_BIAS       64 /* added to exponents */
#define GD__WEDGE_DETOUR     4  /* see gd__wedges_fit */

/* The numbers that are added to pack x and y, and the exponent bits that unpacking restores. */
struct gd__wedge_zero {
    double x, y;
    uint64_t x_bits, y_bits;
};

static inline double gd__wedge_double(uint64_t bits)
{
    double number;
    memcpy(&number, &bits, sizeof number);
    return number;
}

static inline uint64_t gd__wedge_bits(double number)
{
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    return bits;
}

static inline struct gd__wedge_zero gd__wedge_zero(int exponent)
{
    /* 2^52 units of x and of y, and in addition 2^49 units of x */
    uint64_t x_bits = (uint64_t)(1023 + 52 - 49 + exponent) << 52,
             y_bits = x_bits - (UINT64_C(1) << 52);
    return (struct gd__wedge_zero){gd__wedge_double(x_bits | UINT64_C(1) << 49),
                                   gd__wedge_double(y_bits), x_bits, y_bits};
}

/* Returns the unit of y. */
static inline double gd__wedge_least(int exponent)
{
    return gd__wedge_double((uint64_t)(1023 - 50 + exponent) << 52);
}

/* Returns the form with the fewest bytes that can number `sources` sources (vertices and seeds). */
static inline enum gd__wedge_form gd__wedge_form_of(uint64_t sources)
{
    return sources < (UINT32_C(1) << 20) - 1   ? GD__WEDGE_20
           : sources < (UINT32_C(1) << 28) - 1 ? GD__WEDGE_28
                                               : GD__WEDGE_WIDE;
}

/* Returns a lower bound of a window's distances on an edge. `x` is the absolute value. */
static inline double gd__wedge_nearest(double x, double y, double sigma, double length)
{
    double beside = x - length;
    return sigma + (beside > y ? beside : y);
}

/* Returns the exponent of a packed chunk, plus GD__WEDGE_BIAS. `farthest` is the largest |x| or y
 * of its windows. 2^exponent also bounds length - x and the rounding error. */
static inline int gd__wedge_exponent(double farthest, double length)
{
    double reach = (farthest + length) * (1 + 0x1p-40);
    return (int)(gd__wedge_bits(reach) >> 52) - 1022 + GD__WEDGE_BIAS;
}

/* Returns true if packing changes no distance by more than 1e-14 of it. This fails only close to a
 * seed. `nearest` is a lower bound of the distances. */
static inline bool gd__wedges_fit(double farthest, double nearest, double length)
{
    return farthest + length < GD__WEDGE_DETOUR * nearest;
}

/* Returns the size in bytes of the header and of the arrays. */
static inline size_t gd__chunk_end(const struct gd__chunk *chunk)
{
    size_t each = chunk->form == GD__WEDGE_WIDE ? 24 : GD__WEDGE_LEAST + (size_t)chunk->form;
    return sizeof *chunk + each * chunk->count;
}

/* Returns the offset of the next older chunk of the same edge; GD_NONE ends the chain. */
static inline uint32_t gd__chunk_previous(const struct gd__chunk *chunk)
{
    uint32_t previous = GD_NONE;
    if (chunk->has_previous)
        memcpy(&previous, (const char *)chunk + gd__chunk_end(chunk), sizeof previous);
    return previous;
}

static inline size_t gd__chunk_bytes(const struct gd__chunk *chunk)
{
    return (gd__chunk_end(chunk) + 4 * (size_t)chunk->has_previous + 7) & ~(size_t)7;
}

/* Sets the previous chunk of a chunk that has been written. Returns the chunk's size in bytes. */
static inline size_t gd__chunk_link(struct gd__chunk *chunk, uint32_t previous)
{
    size_t end = gd__chunk_end(chunk);
    bool has_previous = previous != GD_NONE;
    if (has_previous) memcpy((char *)chunk + end, &previous, sizeof previous);
    chunk->has_previous = has_previous;
    return (end + 4 * (size_t)has_previous + 7) & ~(size_t)7;
}

/* Clears at least the padding behind the arrays. */
static inline void gd__chunk_pad(struct gd__chunk *chunk)
{
    memset((char *)chunk + gd__chunk_end(chunk), 0, 12);
}

/* Returns the arrays of a chunk with this header. `data` is the chunk's member. */
static inline struct gd__wedges gd__wedges_of(const uint32_t *data, uint32_t count,
                                              enum gd__wedge_form form, uint32_t exponent,
                                              bool is_far)
{
    gd__chunk_word *word = (gd__chunk_word *)data;
    uint32_t *start = (uint32_t *)(word + ((size_t)count << (form == GD__WEDGE_WIDE)));
    uint16_t *middle = (uint16_t *)(start + 2 * (size_t)count);
    return (struct gd__wedges){.word = word,
                               .x = (gd__chunk_double *)word,
                               .y = (gd__chunk_double *)word + count,
                               .start = start,
                               .high = start + count,
                               .middle = middle,
                               .low = middle + count,
                               .count = count,
                               .form = form,
                               .exponent = (int)exponent - GD__WEDGE_BIAS,
                               .is_far = is_far};
}

static inline struct gd__wedges gd__chunk_wedges(const struct gd__chunk *chunk)
{
    return gd__wedges_of(chunk->data, chunk->count, chunk->form, chunk->exponent, chunk->is_far);
}

/* Returns x of wedge `i`, in the frame of side 0. */
static inline double gd__wedge_x(const struct gd__wedges *wedges, uint32_t i)
{
    if (wedges->form == GD__WEDGE_WIDE) return wedges->x[i];
    struct gd__wedge_zero zero = gd__wedge_zero(wedges->exponent);
    return gd__wedge_double(zero.x_bits | wedges->word[i] >> GD__WEDGE_X_SHIFT) - zero.x;
}

/* Returns y >= 0 of wedge `i`. */
static inline double gd__wedge_y(const struct gd__wedges *wedges, uint32_t i)
{
    if (wedges->form == GD__WEDGE_WIDE) return wedges->y[i];
    struct gd__wedge_zero zero = gd__wedge_zero(wedges->exponent);
    return gd__wedge_double(zero.y_bits | (uint64_t)wedges->high[i] << GD__WEDGE_HIGH_SHIFT |
                            (uint64_t)wedges->middle[i] << GD__WEDGE_Y_SHIFT |
                            (wedges->word[i] & 3)) -
           zero.y;
}

/* Returns the pseudo-source of wedge `i`; GD_NONE for a gap. */
static inline uint32_t gd__wedge_source(const struct gd__wedges *wedges, uint32_t i)
{
    if (wedges->form == GD__WEDGE_WIDE) return wedges->high[i];
    bool is_short = wedges->form == GD__WEDGE_20;
    uint32_t all = is_short ? (1u << 20) - 1 : (1u << 28) - 1,
             above =
                 is_short ? ((const uint8_t *)wedges->low)[i] : ((const uint16_t *)wedges->low)[i],
             source = above << GD__WEDGE_LOW_SHIFT |
                      ((uint32_t)(wedges->word[i] >> GD__WEDGE_Y_SHIFT) & GD__WEDGE_LOW_MASK);
    return source == all ? GD_NONE : source;
}

/* Writes wedge `i`, y >= 0. Unless the form is wide, |x| and y must be below 2^exponent. */
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
    return 2 * GD__CHUNK_UNIT + 24 * (size_t)gd__wedges_bound(count) +
           GD__WINDOWS_GROUP * sizeof(double);
}

/* Writes sorted windows of a side to a chunk, as wedges with gaps between them. The chunk's form
 * must be set. Changes it to WIDE if a window needs it. Sets the count, the exponent and the side.
 * The caller then sets the previous chunk. `mirrored` is true if the windows belong to side 1. This
 * function is the general form of gd__kernel.store. */
void gd__chunk_write(const struct gd__windows *windows, uint32_t count, double length,
                     bool mirrored, struct gd__chunk *out);
