/* Predecessor: the last leg of the shortest path to a vertex. */
#ifndef GD_WINDOW_PREDECESSOR_H
#define GD_WINDOW_PREDECESSOR_H

#include <stdint.h>

/* Distance of a vertex that is not reached yet. All lengths in the normalised unit are far
 * smaller. */
#define GD__FAR 1e300

/* The leg starts at (x, -y) in the frame of `side`, the side opposite to the vertex. For y >= 0 the
 * leg crosses that side. For y < 0 it starts at a seed in the face itself. The leg's start defines
 * its direction: if the vertex lies almost on the side, the crossing would not determine it. */
struct gd__predecessor {
    double x, y;
    uint32_t side; /* GD_NONE means that the leg runs along an edge */
    /* The pseudo-source where the leg starts. GD_NONE means the path bends at (x, 0) of the side,
       and the wedges of the edge define the rest of the path. */
    uint32_t source;
};

#endif
