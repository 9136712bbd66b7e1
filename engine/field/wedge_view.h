/* Wedge view: the wedges of a chunk, seen from a point across their edge. The kernels are the inner
 * loop of every query and evaluate several wedges at a time.
 *
 * The same source (wedge_view_lanes.h) is compiled for each set of vector instructions, as in
 * engine/kernel. All kernels give the same results to the last bit. Stateless and thread-safe. */
#pragma once

#include "field/layout.h"

struct gd__wedge_view {
    const struct gd__chunk *chunk;
    double length; /* length of the edge */
    double x, y;   /* the point in the frame of `side`, y >= 0 */
    uint32_t side; /* the side of the edge that belongs to the point's face */
};

/* The shortest path through the wedges of several views. `place` is the number of its wedge,
 * counted through all views. In a tie, the first wedge wins. GD_NONE means that no path is shorter
 * than `known`. */
struct gd__wedge_view_best {
    double distance;
    uint32_t place;
};

/* The kernel: finds the shortest path through the wedges of the views, if it is shorter than
 * `known`. A path is straight, or bends at the wedge's end. The _linear kernels also accept linear
 * wedges. */
typedef struct gd__wedge_view_best gd__wedge_view_kernel(const struct gd_field *field,
                                                         const struct gd__wedge_view *wedge_views,
                                                         uint32_t count, double known);

extern gd__wedge_view_kernel gd__wedge_view_plain, gd__wedge_view_plain_linear;
#if defined(__x86_64__)
extern gd__wedge_view_kernel gd__wedge_view_avx2, gd__wedge_view_avx2_linear, gd__wedge_view_avx512,
    gd__wedge_view_avx512_linear;
#endif
