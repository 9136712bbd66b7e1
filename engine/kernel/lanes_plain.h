/* Lanes in plain C: one at a time. kernel_lanes.h describes the operations. The three sets of lanes
 * must return the same bits. */
#pragma once

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

/* Return the smallest and the largest lane. */
static inline double least_of(lanes a)
{
    return a;
}
static inline double most_of(lanes a)
{
    return a;
}

/* Stores numbers of a chunk. */
static inline void store_doubles(gd__chunk_double *p, lanes a)
{
    *p = a;
}
static inline void store_words(gd__chunk_word *p, uint64_t a)
{
    *p = a;
}

/* Packed wedges without their starts. */
struct packed {
    uint64_t word, y;
    ids source;
};

/* Packs x and y, to which gd__wedge_zero has been added. */
static inline struct packed packed(lanes x, lanes y, ids source)
{
    uint64_t y_bits = gd__wedge_bits(y);
    uint64_t word = gd__wedge_bits(x) << GD__WEDGE_X_SHIFT |
                    (source & GD__WEDGE_LOW_MASK) << GD__WEDGE_Y_SHIFT | (y_bits & 3);
    return (struct packed){word, y_bits, source};
}

/* Stores the bits of a wedge that `start` and `word` do not hold. */
static inline void store_rest(const struct gd__wedges *to, uint32_t at, const struct packed *p)
{
    to->high[at] = (uint32_t)(p->y >> GD__WEDGE_HIGH_SHIFT);
    to->middle[at] = (uint16_t)(p->y >> GD__WEDGE_Y_SHIFT);
    if (to->form == GD__WEDGE_20)
        ((uint8_t *)to->low)[at] = (uint8_t)(p->source >> GD__WEDGE_LOW_SHIFT);
    else
        ((uint16_t *)to->low)[at] = (uint16_t)(p->source >> GD__WEDGE_LOW_SHIFT);
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
