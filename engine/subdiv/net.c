#include "subdiv/net.h"

#include <stdlib.h>

enum {
    PER_SIDE = 3 * sizeof(uint32_t) + sizeof(float),
    PER_POINT = sizeof(struct gd_vec3) + sizeof(float)
};

size_t gd__net_size(size_t points, size_t faces, size_t sides, bool polygons)
{
    return points * PER_POINT + sides * PER_SIDE +
           (polygons ? (faces + 1 + sides) * sizeof(uint32_t) : 0);
}

enum gd_status gd__net_create(struct gd__net *net, uint32_t arity, size_t points, size_t faces,
                              size_t sides, bool polygons)
{
    struct gd__net made = {.arity = arity};
    made.points = malloc((points + 1) * sizeof *made.points);
    made.corner = calloc(points + 1, sizeof *made.corner);
    made.origin = malloc((sides + 1) * sizeof *made.origin);
    made.twin = malloc((sides + 1) * sizeof *made.twin);
    made.edge = malloc((sides + 1) * sizeof *made.edge);
    made.sharpness = calloc(sides + 1, sizeof *made.sharpness);
    bool whole =
        made.points && made.corner && made.origin && made.twin && made.edge && made.sharpness;
    if (polygons) {
        made.first = malloc((faces + 1) * sizeof *made.first);
        made.face_of = malloc((sides + 1) * sizeof *made.face_of);
        whole = whole && made.first && made.face_of;
    }
    if (!whole) {
        gd__net_free(&made);
        return GD_NO_MEMORY;
    }
    *net = made;
    return GD_OK;
}

void gd__net_free(struct gd__net *net)
{
    free(net->points);
    free(net->corner);
    free(net->first);
    free(net->origin);
    free(net->twin);
    free(net->edge);
    free(net->sharpness);
    free(net->face_of);
    *net = (struct gd__net){0};
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
