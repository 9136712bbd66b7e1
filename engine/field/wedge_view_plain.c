#include "kernel/lanes_plain.h"

static inline lanes load_first(const double *p, uint32_t count)
{
    return count ? *p : 0;
}

static inline lanes starts_first(const uint64_t *p, uint32_t count)
{
    return count ? (double)(uint32_t)*p : 0;
}

static inline ids sources_first(const uint64_t *p, uint32_t count)
{
    return count ? (uint32_t)(*p >> 32) : 0;
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
