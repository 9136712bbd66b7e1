#include "subdiv/net.h"

void gd__net_create(struct gd__net *net, struct gd__arrays *arrays, uint32_t arity, size_t points,
                    size_t sides)
{
    *net = (struct gd__net){.arity = arity};
    net->points = gd__arrays_take(arrays, points, sizeof *net->points);
    net->corner = gd__arrays_zeroed(arrays, points, sizeof *net->corner);
    net->origin = gd__arrays_take(arrays, sides, sizeof *net->origin);
    net->twin = gd__arrays_take(arrays, sides, sizeof *net->twin);
    net->edge = gd__arrays_take(arrays, sides, sizeof *net->edge);
    net->sharpness = gd__arrays_zeroed(arrays, sides, sizeof *net->sharpness);
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
