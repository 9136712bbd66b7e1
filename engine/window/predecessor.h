/* Predecessor: the last leg of the shortest path to a vertex. */
#pragma once

#include <stdint.h>

/* Distance of a vertex that no path has reached yet. All lengths in the normalised unit are far
 * smaller. */
#define GD__FAR 1e300

/* The leg starts at (x, -y) in the frame of `side`, the side opposite to the vertex. For y >= 0 the
 * leg crosses that side. For y < 0 it starts at a seed in the face itself. The struct stores the
 * leg's start, and not its crossing with the side: if the vertex lies almost on the side, the
 * crossing does not determine the leg's direction. */
struct gd__predecessor {
    double x, y;
    uint32_t side; /* GD_NONE means that the leg runs along an edge */
    /* The pseudo-source where the leg starts. If GD_NONE, the path bends at (x, 0) of the side, and
       the wedges of the edge determine the rest of the path. */
    uint32_t source;
};
