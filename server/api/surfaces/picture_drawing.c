#include "server/api/surfaces/picture_drawing.h"

#define POINTS_MOST 4000000u /* points of all layers */

struct gd_picture_layer *server_drawn_add(struct server_picture_layers *layers, uint32_t i)
{
    const struct proto_picture_layer *wanted = &layers->wanted->items[i];
    struct gd_picture_layer *drawn = &layers->drawn[layers->count++];
    *drawn = (struct gd_picture_layer){.id = i,
                                       .name = wanted->label.text[0] ? wanted->label.text : NULL,
                                       .colour = wanted->has_color ? wanted->color : 0,
                                       .width = wanted->has_width ? wanted->width : 0,
                                       .hidden = wanted->has_hidden ? (enum gd_hidden)wanted->hidden
                                                                    : GD_HIDDEN_FAINT};
    return drawn;
}

struct gd_vec3 *server_drawn_points(struct server_picture_layers *layers,
                                    struct server_query *query, uint64_t count)
{
    layers->points += count;
    if (layers->points > POINTS_MOST) {
        (void)proto_problem_exceed(
            query->problem, NULL, POINTS_MOST,
            "the lines of this layer and of those before it have %llu points, more than %u; ask "
            "for fewer or shorter lines",
            (unsigned long long)layers->points, POINTS_MOST);
        return NULL;
    }
    struct gd_vec3 *points = server_query_allocate(query, count, sizeof *points);
    if (!points) server_query_refuse(query, GD_BUDGET, "the figure");
    return points;
}

struct gd_vec3 *server_drawn_lines(struct server_picture_layers *layers, struct server_query *query,
                                   const uint32_t shape[2], struct gd_picture_layer *drawn)
{
    struct gd_vec3 *points = server_drawn_points(layers, query, (uint64_t)shape[0] * shape[1]);
    uint32_t *first = server_query_allocate(query, shape[0] + (size_t)1, sizeof *first);
    if (points && !first) server_query_refuse(query, GD_BUDGET, "the figure");
    if (!points || !first) return NULL;
    for (uint32_t k = 0; k <= shape[0]; k++) first[k] = k * shape[1];
    drawn->points = points;
    drawn->first = first;
    drawn->count = shape[0];
    return points;
}
