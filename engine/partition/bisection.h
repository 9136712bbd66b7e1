/* Halves: a surface cut in two by a plane through a source, so that two wavefronts that set out
 * there are equally busy all the time. */
#ifndef GD_PARTITION_BISECTION_H
#define GD_PARTITION_BISECTION_H

#include "mesh/topology.h"

/* A face belongs to one half, 0 or 1, and with it its sides; a boundary side has the half of its
 * other side. Of vertices bit 1 << half is set for each half that has a face there. Finds the plane
 * by a thousand faces, whatever the surface's size: 0.3 ms; what follows is linear, some 10 ns a
 * face. Depends on nothing but the surface and the source. */
void gd__bisection_divide(const struct gd_mesh *mesh, struct gd_vec3 source, uint8_t *side_part,
                          uint8_t *vertex_parts);

#endif
