#include "field/sight.h"

#include "wedge/kernel.h"

gd__sight_kernel *gd__sight_kernel_in_use(void)
{
    const struct gd__kernel *in_use = gd__kernel_in_use();
#if defined(__x86_64__)
    if (in_use == &gd__kernel_avx512) return gd__sight_avx512;
    if (in_use == &gd__kernel_avx2) return gd__sight_avx2;
#endif
    (void)in_use;
    return gd__sight_plain;
}

double gd__sight_crossing(const struct gd__sight *sight, uint32_t wedge, double x, double y)
{
    struct gd__wedges wedges = gd__chunk_wedges(sight->chunk);
    double length = sight->length, unit = length * GD__WEDGE_UNIT;
    double b0 = gd__wedge_start(wedges.start[wedge]) * unit;
    double b1 = wedge + 1 < sight->chunk->count ? gd__wedge_start(wedges.start[wedge + 1]) * unit : length;
    bool mirrored = sight->side & 1;
    double from = fmax((mirrored ? length - b1 : b0) - 2 * unit, 0),
           to = fmin((mirrored ? length - b0 : b1) + 2 * unit, length);
    double dx = sight->x - x, dy = sight->y + y, t = dy > 0 ? x + dx * (y / dy) : sight->x;
    return t < from ? from : t > to ? to : t;
}
