#include "field/sight.h"

#include "kernel/kernel.h"

gd__sight_kernel *gd__sight_kernel_in_use(bool linear)
{
    const struct gd__kernel *in_use = gd__kernel_in_use();
#if defined(__x86_64__)
    if (in_use == &gd__kernel_avx512) return linear ? gd__sight_avx512_linear : gd__sight_avx512;
    if (in_use == &gd__kernel_avx2) return linear ? gd__sight_avx2_linear : gd__sight_avx2;
#endif
    (void)in_use;
    return linear ? gd__sight_plain_linear : gd__sight_plain;
}

/* Measured from the end of the leg that is nearer to the edge: the rounding is relative to that
 * end. */
static double straight_crossing(const struct gd__sight *sight, const struct gd__window *w)
{
    if (gd__window_is_linear(w)) return sight->x + w->x * (sight->y / w->y);
    double dx = sight->x - w->x, dy = sight->y + w->y;
    if (!(dy > 0)) return sight->x;
    return w->y < sight->y ? w->x + dx * (w->y / dy) : sight->x - dx * (sight->y / dy);
}

double gd__sight_crossing(const struct gd__sight *sight, const struct gd__window *wedge)
{
    double length = sight->length,
           more = gd__window_is_linear(wedge) ? 0 : 2 * length * GD__WEDGE_UNIT;
    double from = fmax(wedge->b0 - more, 0), to = fmin(wedge->b1 + more, length),
           t = straight_crossing(sight, wedge);
    return t < from ? from : t > to ? to : t;
}
