/* Local: places in the plane of a face, in the frame of one of its sides (topology.h). Inside unit. */
#ifndef GD_MESH_LOCAL_H
#define GD_MESH_LOCAL_H

#include "mesh/topology.h"

struct gd__local {
    double x, y;
};

/* From barycentric coordinates: those of the side's destination and of its apex; the origin has the rest. */
static inline struct gd__local gd__side_local(const struct gd_side *s, double destination, double apex)
{
    return (struct gd__local){destination * s->length + apex * s->left_length * s->left_x,
                              apex * s->left_length * s->left_y};
}

#endif
