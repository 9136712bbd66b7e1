/* Predecessor: how a vertex got its distance: the last leg of its shortest path. */
#ifndef GD_WINDOW_PREDECESSOR_H
#define GD_WINDOW_PREDECESSOR_H

#include <stdint.h>

/* Distance of a vertex that is not reached yet. Lengths in the inside unit stay far below. */
#define GD__FAR 1e300

/* The leg starts at (x, -y) in the frame of `side`, the side opposite to the
 * vertex: beyond the side where it crosses it (y >= 0), in the face itself where a seed lies there
 * (y < 0). The direction back is stored by its far end, not by the crossing: where the vertex lies
 * on or almost on that side, the crossing would not tell it. */
struct gd__predecessor {
    double x, y;
    uint32_t side; /* GD_NONE: the leg runs along an edge */
    /* pseudo-source in which the leg starts; GD_NONE: the path bends at (x, 0) of the side, the
       edge knows how it goes on */
    uint32_t source;
};

#endif
