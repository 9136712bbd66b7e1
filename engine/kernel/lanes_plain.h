/* Lanes in plain C: one at a time. kernel_lanes.h describes the operations. The three sets of lanes
 * must return the same bits. */
#ifndef GD_KERNEL_LANES_H
#define GD_KERNEL_LANES_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "window/wedges.h"

#define LANES            1
#define KERNEL(x)        gd__##x##_plain
#define KERNEL_LINEAR(x) gd__##x##_plain_linear

typedef double lanes;
typedef bool mask;
typedef uint32_t ids;

static inline lanes all(double a)
{
    return a;
}
static inline lanes load(const double *p)
{
    return *p;
}
static inline void store(double *p, lanes a)
{
    *p = a;
}
static inline lanes root(lanes a)
{
    return sqrt(a);
}
static inline lanes magnitude(lanes a)
{
    return fabs(a);
}
static inline lanes greater(lanes a, lanes b)
{
    return a > b ? a : b;
}
static inline lanes lesser(lanes a, lanes b)
{
    return a < b ? a : b;
}
static inline lanes pick(mask m, lanes yes, lanes no)
{
    return m ? yes : no;
}

static inline mask lt(lanes a, lanes b)
{
    return a < b;
}
static inline mask le(lanes a, lanes b)
{
    return a <= b;
}
static inline mask eq(lanes a, lanes b)
{
    return a == b;
}
static inline mask both(mask a, mask b)
{
    return a & b;
}
static inline mask either(mask a, mask b)
{
    return a | b;
}
static inline mask except(mask a, mask b)
{
    return a & !b;
}
static inline mask first_lanes(uint32_t count)
{
    return count > 0;
}
static inline uint32_t bits(mask m)
{
    return m;
}
static inline mask mask_of(uint32_t set)
{
    return set & 1;
}

static inline lanes compress(mask m, lanes a)
{
    (void)m;
    return a;
}
static inline lanes after(double first, lanes a)
{
    (void)a;
    return first;
}
static inline lanes ahead(lanes a)
{
    return a;
}
static inline mask mask_ahead(mask m)
{
    (void)m;
    return false;
}
static inline double last_of(lanes a, uint32_t count)
{
    (void)count;
    return a;
}
static inline double first_of(lanes a)
{
    return a;
}
static inline lanes reversed(lanes a)
{
    return a;
}

static inline ids ids_all(uint32_t a)
{
    return a;
}
static inline ids ids_load(const uint32_t *p)
{
    return *p;
}
static inline void ids_store(uint32_t *p, ids a)
{
    *p = a;
}
static inline mask ids_eq(ids a, ids b)
{
    return a == b;
}
/* Returns the highest bit. */
static inline mask ids_top(ids a)
{
    return a >> 31;
}
static inline ids ids_compress(mask m, ids a)
{
    (void)m;
    return a;
}
static inline ids ids_after(uint32_t first, ids a)
{
    (void)a;
    return first;
}
static inline uint32_t ids_last_of(ids a, uint32_t count)
{
    (void)count;
    return a;
}
static inline ids ids_reversed(ids a)
{
    return a;
}

/* Stores starts as integers. They are numbers below 2^32. */
static inline void store_starts(uint32_t *p, lanes start)
{
    *p = (uint32_t)start;
}

/* Returns `a` in the lanes of m, zero elsewhere. */
static inline ids ids_pick(mask m, ids a)
{
    return m ? a : 0;
}

/* Stores the bits of the source's number that x and y do not hold, in the chunk's form. */
static inline void store_highs(const struct gd__wedges *to, uint32_t at, ids source)
{
    if (to->form == GD__WEDGE_16) ((uint8_t *)to->high)[at] = (uint8_t)(source >> 8);
    if (to->form == GD__WEDGE_24) ((uint16_t *)to->high)[at] = (uint16_t)(source >> 8);
    if (to->form == GD__WEDGE_WIDE) ((uint32_t *)to->high)[at] = source;
}

/* Packs a scaled coordinate with the bits `nibble` of a source's shifted number. */
static inline lanes packed(lanes a, ids source, int shift, uint64_t nibble)
{
    uint64_t word = gd__wedge_bits(&a) | ((uint64_t)source << shift & nibble);
    memcpy(&a, &word, sizeof a);
    return a;
}

#define FLOATS 1

typedef float floats;

static inline floats floats_all(float a)
{
    return a;
}
static inline floats floats_load(const float *p)
{
    return *p;
}
static inline floats floats_root(floats a)
{
    return sqrtf(a);
}
static inline floats floats_lesser(floats a, floats b)
{
    return a < b ? a : b;
}
static inline floats floats_greater(floats a, floats b)
{
    return a > b ? a : b;
}
static inline float floats_least(floats a)
{
    return a;
}

#endif
