#include "kernel/lanes_plain.h"

static inline lanes load_first(const gd__chunk_double *p, uint32_t count)
{
    return count ? *p : 0;
}

static inline lanes starts_first(const uint32_t *p, uint32_t count)
{
    return count ? *p : 0;
}

static inline ids ids_first(const uint32_t *p, uint32_t count)
{
    (void)count;
    return *p;
}

static inline ids load_packed(const struct gd__wedges *wedges, uint32_t at,
                              const struct gd__wedge_zero *zero, lanes *x, lanes *y)
{
    uint64_t word = wedges->word[at];
    *x = gd__wedge_double(zero->x_bits | word >> GD__WEDGE_X_SHIFT);
    *y = gd__wedge_double(zero->y_bits | (uint64_t)wedges->high[at] << GD__WEDGE_HIGH_SHIFT |
                          (uint64_t)wedges->middle[at] << GD__WEDGE_Y_SHIFT | (word & 3));
    ids above = wedges->form == GD__WEDGE_20 ? ((const uint8_t *)wedges->low)[at]
                                             : ((const uint16_t *)wedges->low)[at];
    return above << GD__WEDGE_LOW_SHIFT | ((ids)(word >> GD__WEDGE_Y_SHIFT) & GD__WEDGE_LOW_MASK);
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

static inline lanes ordinals(void)
{
    return 0;
}

#include "field/wedge_view_lanes.h"
