/* Grid: evaluates the surface over a base face at all dyadic places of a level. */
#pragma once

#include "base/pace.h"
#include "subdiv/walker.h"

enum { GD__LEVEL_MOST = 12 };

/* Returns the number of stages that a walker needs for grids of `level`. */
static inline uint32_t gd__grid_stages(uint32_t level)
{
    return level + 3;
}

/* Arrays for at least the (2^level + 1)^2 places of a grid. */
struct gd__grid_room {
    struct gd_vec3 *positions, *normals;
};

/* Computes positions and unit normals (0 if there is none) at (i,j) / 2^level, and stores them at
 * index i (2^level + 1) + j. The surface over a regular face is one polynomial. It is evaluated row
 * by row, because the places of a row share partial sums. An irregular face is divided into its
 * children, the faces of the next subdivision step. All children except the one at the irregular
 * corner are polynomials. `pace` may be NULL; each place is one step of the pace. Returns the
 * status of the pace. */
enum gd_status gd__grid(struct gd__walker *walker, uint32_t face, uint32_t level,
                        const struct gd__grid_room *room, struct gd__pace *pace);
