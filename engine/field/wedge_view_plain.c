#include "kernel/lanes_plain.h"

static inline lanes load_first(const double *p, uint32_t count)
{
    return count ? *p : 0;
}

static inline lanes starts_first(const uint32_t *p, uint32_t count)
{
    return count ? *p : 0;
}

static inline ids highs_first(const struct gd__wedges *wedges, uint32_t at, uint32_t count)
{
    (void)count;
    if (wedges->form == GD__WEDGE_16) return (ids)((uint8_t *)wedges->high)[at] << 8;
    if (wedges->form == GD__WEDGE_24) return (ids)((uint16_t *)wedges->high)[at] << 8;
    return ((uint32_t *)wedges->high)[at];
}

static inline ids sources_of(ids high, lanes x, lanes y, uint64_t nibble)
{
    return high | (ids)((gd__wedge_bits(&x) & nibble) >> GD__WEDGE_SHIFT) |
           (ids)((gd__wedge_bits(&y) & nibble) >> (GD__WEDGE_SHIFT - 4));
}

static inline lanes without(lanes a, uint64_t mask_bits)
{
    uint64_t bits = gd__wedge_bits(&a) & ~mask_bits;
    memcpy(&a, &bits, sizeof a);
    return a;
}

static inline mask ids_below(ids a, uint32_t limit)
{
    return a < limit;
}

static inline ids ids_scaled(ids a, uint32_t from, uint32_t by)
{
    return (a - from) * by;
}

static inline lanes gather(mask m, const double *from, ids at)
{
    return m ? from[at] : 0;
}

static inline double least_of(lanes a)
{
    return a;
}

static inline lanes ordinals(void)
{
    return 0;
}

#include "field/wedge_view_lanes.h"
