/* Kernel: operations on all windows of a list, or on all vertices of a ring, several lanes at a
 * time. One source (kernel_lanes.h) is compiled for each set of lanes: plain C, AVX2, AVX-512. Each
 * set is compiled twice: for windows of point sources, and for lists that may also hold linear
 * windows (window/window.h). All variants return the same results to the last bit, because each
 * lane does the same operations in the same order, without fused multiply-add. So a distance does
 * not depend on the machine. Stateless; any thread. */
#pragma once

#include "mesh/topology.h"
#include "window/children.h"
#include "kernel/ring.h"
#include "window/wedges.h"

/* The best straight path through a window of a side to the side's apex. Also the two windows whose
 * rays pass closest to the apex, on its left and on its right. */
struct gd__apex {
    /* input: the distance of the apex; output: a shorter distance, if a window gives one */
    double distance;
    bool improved;
    double x, y; /* as in struct gd__predecessor */
    uint32_t source;
    /* output: the last window whose rays pass left of the apex, and the first one whose rays pass
       right of it; GD_NONE if there is none */
    uint32_t last_left, first_right;
};

struct gd__kernel {
    const char *name;
    /* the kernel with the same lanes for lists that may contain linear windows */
    const struct gd__kernel *linear;

    /* Filters windows by the distances d0, d1 of the edge's ends (Xin and Wang 2009). Where the
     * path around an end is strictly shorter than the path through a window, no shortest path uses
     * the window. Removes these parts of the windows, and removes windows of which nothing is left.
     * Returns the number of windows that are left. */
    uint32_t (*filter)(const struct gd__windows *windows, uint32_t count, double length, double d0,
                       double d1);

    /* Keeps the windows whose smallest distance is within `bound`. Returns their number. */
    uint32_t (*within)(const struct gd__windows *windows, uint32_t count, double bound);

    /* Writes the windows of a side, at least one, as wedges of its edge to a chunk. The chunk's
     * form must be set. `mirrored` is true for side 1. Changes the form to WIDE if a window needs
     * it. Sets the chunk's count, exponent and side. Returns false if there are
     * gaps between the windows or if windows may be linear; gd__chunk_write handles these
     * cases. */
    bool (*store)(const struct gd__windows *windows, uint32_t count, double length, bool mirrored,
                  struct gd__chunk *out);

    /* Casts windows across the face of their side. Offers straight paths to the apex, records in
     * struct gd__apex the windows next to it, and appends children to the two other edges. If
     * `coalesce`, joins neighbouring children with the same source. Both lists must have room for
     * `count` windows. */
    void (*cast)(const struct gd_side *side, const struct gd__windows *windows, uint32_t count,
                 bool coalesce, struct gd__apex *apex, struct gd__children *left,
                 struct gd__children *right);

    /* Returns a lower bound of the lengths of paths from a position through the edges of a ring to
     * the target. The ring consists of the groups from `first` to before `end`. On the part of an
     * edge between two such positions, the linear interpolation of their results is also a lower
     * bound, if this part is not longer than `own`. Returns GD__RING_NOWHERE if there is no
     * path. */
    float (*ring)(const struct gd__ring_group *first, const struct gd__ring_group *end,
                  struct gd__place place, float own);
};

extern const struct gd__kernel gd__kernel_plain, gd__kernel_plain_linear;
#if defined(__x86_64__)
extern const struct gd__kernel gd__kernel_avx2, gd__kernel_avx2_linear, gd__kernel_avx512,
    gd__kernel_avx512_linear;
#endif

/* Returns the kernel in use for windows of point sources: the kernel that gd_cpu_select selected,
 * or otherwise the kernel with the most lanes that this machine supports. */
const struct gd__kernel *gd__kernel_in_use(void);
