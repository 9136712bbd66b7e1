/* Grid: the surface over a base face at all dyadic places of a level. */
#ifndef GD_SUBDIV_GRID_H
#define GD_SUBDIV_GRID_H

#include "base/pace.h"
#include "subdiv/walker.h"

enum { GD__LEVEL_MOST = 12 };

/* What the walker of a grid of `level` needs. */
static inline uint32_t gd__grid_stages(uint32_t level)
{
    return level + 3;
}

/* Arrays of the (2^level + 1)^2 places of a grid, or more. */
struct gd__grid_room {
    struct gd_vec3 *positions, *normals;
};

/* Positions and unit normals, 0 where there is none, at (i,j) / 2^level to index
 * i (2^level + 1) + j.
 * A regular face is one polynomial, whose values on a row share the row's sums; of another one all
 * children but those at its irregular corner are. A step of the pace (NULL: none) is a place; its
 * status is returned. */
enum gd_status gd__grid(struct gd__walker *walker, uint32_t face, uint32_t level,
                        const struct gd__grid_room *room, struct gd__pace *pace);

#endif
