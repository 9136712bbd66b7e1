/* Refine: one step of subdivision of a net. */
#ifndef GD_SUBDIV_REFINE_H
#define GD_SUBDIV_REFINE_H

#include "subdiv/scheme.h"

/* The child of a face at one of its corners, which is its corner 0; `side` begins at that corner.
 * Loop's fourth child is 4 face + 3. */
static inline uint32_t gd__child_at_corner(const struct gd__net *net, uint32_t side)
{
    return net->arity == 3 ? 4 * (side / 3) + side % 3 : side;
}

/* Numbers the edges into net->edge and returns how many there are. */
uint32_t gd__number_edges(struct gd__net *net);

/* Subdivides `net` into `out`, made by gd__net_create with room for points + edges (+ faces where
 * the scheme has face points) points and for a child a corner (Loop: four a face). Points 0 to
 * `settled` - 1 are moved by the vertex rule, the others, whose fans are not whole, aren't. `fan`
 * is scratch. Children are numbered as gd__child_at_corner says; point i of `net` is point i of
 * `out`. Semi-sharp tags lose 1. */
void gd__net_refine(struct gd__net *net, uint32_t settled, struct gd__fan *fan,
                    struct gd__net *out);

#endif
