/* Refine: subdivides a net by one step. */
#pragma once

#include "subdiv/scheme.h"

/* Returns the child of the side's face at the origin of `side`. This origin is the child's corner
 * 0. With Loop, the fourth child, in the middle of a face, is 4 * face + 3. */
static inline uint32_t gd__child_at_corner(const struct gd__net *net, uint32_t side)
{
    return net->arity == 3 ? 4 * (side / 3) + side % 3 : side;
}

/* Numbers the edges in net->edge, and returns the number of edges. */
uint32_t gd__number_edges(struct gd__net *net);

/* Subdivides `net` into `out`. The caller creates `out` by gd__net_create with room for the new
 * elements. `out` has a point for each point and each edge of `net`, and with Catmull-Clark also
 * for each face. It has a face for each corner of `net` (Catmull-Clark), or four faces for each
 * face (Loop). The vertex rule is applied only to points 0 to `settled` - 1, because the fans of
 * other points are incomplete. `fan` is scratch memory. Children are numbered as by
 * gd__child_at_corner. Point i of `net` is point i of `out`. The sharpnesses of semi-sharp tags
 * decrease by 1. */
void gd__net_refine(struct gd__net *net, uint32_t settled, struct gd__fan *fan,
                    struct gd__net *out);
