#include "subdiv/net.h"

void gd__net_create(struct gd__net *net, struct gd__arena *arena, uint32_t arity, size_t points,
                    size_t sides)
{
    *net = (struct gd__net){.arity = arity};
    net->points = gd__arena_take(arena, points, sizeof *net->points);
    net->corner = gd__arena_zeroed(arena, points, sizeof *net->corner);
    net->origin = gd__arena_take(arena, sides, sizeof *net->origin);
    net->twin = gd__arena_take(arena, sides, sizeof *net->twin);
    net->edge = gd__arena_take(arena, sides, sizeof *net->edge);
    net->sharpness = gd__arena_zeroed(arena, sides, sizeof *net->sharpness);
}

/* Returns the side at the clockwise end of the fan, or `side` itself if the fan is closed. */
static uint32_t fan_begin(const struct gd__net *net, uint32_t side, bool *closed)
{
    uint32_t begin = side;
    while (net->twin[begin] != GD_NONE) {
        begin = gd__net_next(net, net->twin[begin]);
        if (begin == side) break;
    }
    *closed = net->twin[begin] != GD_NONE;
    return begin;
}

void gd__fan_around(const struct gd__net *net, uint32_t side, struct gd__fan *fan)
{
    uint32_t begin = fan_begin(net, side, &fan->closed), at = begin;
    fan->count = 0;
    do {
        fan->sides[fan->count++] = at;
        at = net->twin[gd__net_previous(net, at)];
    } while (at != GD_NONE && at != begin);
}
