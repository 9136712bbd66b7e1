/* Triangle: lengths, area and shape of one face. Scaling by a power of two does not change relative
 * rounding errors. So the computed shape is the same, to the last bit, before and after the mesh is
 * scaled to the normalised unit. */
#pragma once

#include <stdint.h>

#include "gd/vec.h"

struct gd__triangle {
    struct gd_vec3 edge[3]; /* edge k runs from corner k to corner k + 1 */
    double length[3];
    uint32_t longest; /* index in `edge` of the longest edge */
    double double_area;
};

/* Measures a triangle by its three edge vectors, whose squares must neither overflow nor
 * underflow. */
static inline struct gd__triangle gd__triangle_measure(struct gd_vec3 edge0, struct gd_vec3 edge1,
                                                       struct gd_vec3 edge2)
{
    struct gd__triangle t = {.edge = {edge0, edge1, edge2}};
    for (uint32_t k = 0; k < 3; k++) t.length[k] = gd_vec3_length(t.edge[k]);
    t.longest = t.length[1] > t.length[0] ? 1 : 0;
    if (t.length[2] > t.length[t.longest]) t.longest = 2;
    /* the cross product of the two shorter edges is the most accurate one */
    uint32_t after = (t.longest + 1) % 3, before = (t.longest + 2) % 3;
    t.double_area = gd_vec3_length(gd_vec3_cross(t.edge[after], t.edge[before]));
    return t;
}

/* Returns the height over the longest edge, relative to that edge. */
static inline double gd__triangle_flatness(const struct gd__triangle *t)
{
    return t->double_area / (t->length[t->longest] * t->length[t->longest]);
}
