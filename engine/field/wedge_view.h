/* View: the wedges of a chunk as a point across their edge sees them. What every query does most
 * of, several lanes at a time.
 *
 * One source (wedge_view_lanes.h) is compiled for each set of lanes, as the kernels of the wedge room
 * are; all give the same results to the last bit. Stateless; any thread. */
#ifndef GD_FIELD_WEDGE_VIEW_H
#define GD_FIELD_WEDGE_VIEW_H

#include "field/layout.h"

struct gd__wedge_view {
    const struct gd__chunk *chunk;
    double length; /* of the edge */
    double x, y;   /* the point in the frame of its side of the edge, y >= 0 */
    uint32_t side; /* that one */
};

/* The shortest way that several wedge_views offer. `place` is its wedge's, counted through all wedge_views,
 * and of equal ones the first; GD_NONE: there is none shorter than what was known. */
struct gd__seen {
    double distance;
    uint32_t place;
};

/* The kernel: the shortest way through the wedge_views' wedges, if one is shorter than `known`. A way is
 * straight, or round the wedge's end. The linear ones take linear wedges too. */
typedef struct gd__seen gd__wedge_view_kernel(const struct gd_field *field,
                                              const struct gd__wedge_view *wedge_views,
                                              uint32_t count, double known);

extern gd__wedge_view_kernel gd__wedge_view_plain, gd__wedge_view_plain_linear;
#if defined(__x86_64__)
extern gd__wedge_view_kernel gd__wedge_view_avx2, gd__wedge_view_avx2_linear, gd__wedge_view_avx512,
    gd__wedge_view_avx512_linear;
#endif

/* The one for the kernels that are in use (kernel/kernel.h), of a field with or without segments. */
gd__wedge_view_kernel *gd__wedge_view_kernel_in_use(bool linear);

/* Where the way through a wedge, a window in the frame of the view's side, to the point crosses
 * the edge: on the straight line, or at the wedge's nearer end. Ends are stored to one unit: a
 * crossing within two of them counts as inside, where a neighbour is as short; but not of a linear
 * wedge. */
double gd__wedge_view_crossing(const struct gd__wedge_view *wedge_view,
                               const struct gd__window *wedge);

#endif
