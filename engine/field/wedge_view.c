#include "field/wedge_view.h"

#include "kernel/kernel.h"

gd__wedge_view_kernel *gd__wedge_view_kernel_in_use(bool linear)
{
    const struct gd__kernel *in_use = gd__kernel_in_use();
#if defined(__x86_64__)
    if (in_use == &gd__kernel_avx512)
        return linear ? gd__wedge_view_avx512_linear : gd__wedge_view_avx512;
    if (in_use == &gd__kernel_avx2)
        return linear ? gd__wedge_view_avx2_linear : gd__wedge_view_avx2;
#endif
    (void)in_use;
    return linear ? gd__wedge_view_plain_linear : gd__wedge_view_plain;
}

/* Returns where the straight line crosses the edge, measured from the end of the leg that is nearer
 * to the edge, so that the rounding error is relative to that end's distance. */
static double straight_crossing(const struct gd__wedge_view *wedge_view, const struct gd__window *w)
{
    if (gd__window_is_linear(w)) return wedge_view->x + w->x * (wedge_view->y / w->y);
    double dx = wedge_view->x - w->x, dy = wedge_view->y + w->y;
    if (!(dy > 0)) return wedge_view->x;
    return w->y < wedge_view->y ? w->x + dx * (w->y / dy)
                                : wedge_view->x - dx * (wedge_view->y / dy);
}

double gd__wedge_view_crossing(const struct gd__wedge_view *wedge_view,
                               const struct gd__window *wedge)
{
    double length = wedge_view->length,
           more = gd__window_is_linear(wedge) ? 0 : 2 * length * GD__WEDGE_UNIT;
    double from = fmax(wedge->b0 - more, 0), to = fmin(wedge->b1 + more, length),
           t = straight_crossing(wedge_view, wedge);
    return t < from ? from : t > to ? to : t;
}
