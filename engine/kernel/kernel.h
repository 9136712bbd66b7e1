/* Kernel: what is done to all windows of a list, or to all vertices of a ring, at once, several
 * lanes at a time.
 *
 * One source (kernel_lanes.h) is compiled for each set of lanes: plain C, AVX2, AVX-512; and for
 * each twice: for windows of points, and for lists in which there may be linear ones
 * (window/window.h) too. All give the same results to the last bit: each lane does the same
 * operations in the same order, none of them fused, so a distance does not depend on the machine.
 * Stateless; any thread. */
#ifndef GD_KERNEL_KERNEL_H
#define GD_KERNEL_KERNEL_H

#include "mesh/topology.h"
#include "window/children.h"
#include "kernel/ring.h"
#include "window/wedges.h"

/* The best straight way found to the apex of a side through one of its windows, and which windows
 * pass beside it. */
struct gd__apex {
    double distance; /* in: what the apex has; out: shorter, if a way is */
    bool improved;
    double x, y; /* struct gd__predecessor */
    uint32_t source;
    /* out: the last window to its left, the first one to its right; GD_NONE: none */
    uint32_t last_left, first_right;
};

struct gd__kernel {
    const char *name;

    /* Filter by the distances d0, d1 of the edge's ends (Xin and Wang 2009): where the way round an
     * end is strictly shorter than a window, no shortest path uses it. Trims windows and closes
     * ranks; returns how many are left. */
    uint32_t (*filter)(const struct gd__windows *windows, uint32_t count, double length, double d0,
                       double d1);

    /* Keeps the windows that come within `bound` somewhere; returns how many. */
    uint32_t (*within)(const struct gd__windows *windows, uint32_t count, double bound);

    /* Writes windows of a side, at least one, as wedges of its edge to arrays behind each other at
     * `data`, `mirrored` for side 1; returns how many wedges. 0 where windows leave gaps between
     * them, or may be linear: gd__wedges_write does those. */
    uint32_t (*store)(const struct gd__windows *windows, uint32_t count, double length,
                      bool mirrored, double *data);

    /* Casts windows across the face of their side: offers straight ways to its apex, notes which
     * windows pass beside it, and appends their children on the two other edges, joining neighbours
     * that see one source if `coalesce`. Both lists have room for as many. */
    void (*cast)(const struct gd_side *side, const struct gd__windows *windows, uint32_t count,
                 bool coalesce, struct gd__apex *apex, struct gd__children *left,
                 struct gd__children *right);

    /* Lower bound of the ways from a place through the edges of groups [first, end) of a ring, and
     * from parts of edges between such places, none longer than `own`, as a linear function;
     * GD__RING_NOWHERE of none. */
    float (*ring)(const struct gd__ring_group *first, const struct gd__ring_group *end,
                  struct gd__place place, float own);
};

extern const struct gd__kernel gd__kernel_plain, gd__kernel_plain_linear;
#if defined(__x86_64__)
extern const struct gd__kernel gd__kernel_avx2, gd__kernel_avx2_linear, gd__kernel_avx512,
    gd__kernel_avx512_linear;
#endif

/* The kernel in use: the widest that this machine has, or what gd_cpu_select forced. It takes
 * windows of points; */
const struct gd__kernel *gd__kernel_in_use(void);

/* and the one of the same lanes that takes linear windows too. */
const struct gd__kernel *gd__kernel_in_use_linear(void);

#endif
