/* Kernel: operations on all windows of a list, or on all vertices of a ring, several lanes at a
 * time. One source (kernel_lanes.h) is compiled for each set of lanes: plain C, AVX2, AVX-512. Each
 * set is compiled twice: for windows of point sources, and for lists that may also hold linear
 * windows (window/window.h). All variants return the same bits, because each lane does the same
 * operations in the same order, without fused multiply-add. So a distance does not depend on the
 * machine. Stateless; any thread. */
#ifndef GD_KERNEL_KERNEL_H
#define GD_KERNEL_KERNEL_H

#include "mesh/topology.h"
#include "window/children.h"
#include "kernel/ring.h"
#include "window/wedges.h"

/* The best straight path to the apex of a side through one of its windows, and the windows beside
 * the apex. */
struct gd__apex {
    double distance; /* in: the distance of the apex; out: a shorter one, if a window gives it */
    bool improved;
    double x, y; /* as in struct gd__predecessor */
    uint32_t source;
    /* out: the last window left of the apex and the first one right of it, or GD_NONE if there is
       none */
    uint32_t last_left, first_right;
};

struct gd__kernel {
    const char *name;
    const struct gd__kernel *linear; /* the same lanes, for lists that may hold linear windows */

    /* Filters windows by the distances d0, d1 of the edge's ends (Xin and Wang 2009). If the path
     * round an end is strictly shorter than the path through a window, no shortest path uses the
     * window there. Trims and compacts the windows; returns the number that is left. */
    uint32_t (*filter)(const struct gd__windows *windows, uint32_t count, double length, double d0,
                       double d1);

    /* Keeps the windows whose least distance is within `bound`. Returns their number. */
    uint32_t (*within)(const struct gd__windows *windows, uint32_t count, double bound);

    /* Writes at least one window of a side as wedges of its edge to a chunk whose form is set;
     * `mirrored` for side 1. Sets the chunk's count and side. Returns false if there are gaps
     * between the windows or if they may be linear; gd__chunk_write handles these cases. Unless the
     * form is wide, sources must be nearer than GD__WEDGE_LIMIT. */
    bool (*store)(const struct gd__windows *windows, uint32_t count, double length, bool mirrored,
                  struct gd__chunk *out);

    /* Casts windows across the face of their side. Offers straight paths to the apex, records the
     * windows that pass beside it, and appends children on the two other edges. With `coalesce`,
     * neighbours with the same source are joined. Both lists must have room for `count` windows. */
    void (*cast)(const struct gd_side *side, const struct gd__windows *windows, uint32_t count,
                 bool coalesce, struct gd__apex *apex, struct gd__children *left,
                 struct gd__children *right);

    /* Returns a lower bound of the lengths of the paths from a place through the edges of groups
     * [first, end) of a ring. The bound also holds, as a linear function, for paths from parts of
     * edges between such places, if no part is longer than `own`. Returns GD__RING_NOWHERE if there
     * is no path. */
    float (*ring)(const struct gd__ring_group *first, const struct gd__ring_group *end,
                  struct gd__place place, float own);
};

extern const struct gd__kernel gd__kernel_plain, gd__kernel_plain_linear;
#if defined(__x86_64__)
extern const struct gd__kernel gd__kernel_avx2, gd__kernel_avx2_linear, gd__kernel_avx512,
    gd__kernel_avx512_linear;
#endif

/* Returns the kernel in use for windows of point sources: the widest of this machine, or the one
 * forced by gd_cpu_select. */
const struct gd__kernel *gd__kernel_in_use(void);

#endif
