/* Bisection: divides a surface by a plane through a source so that two wavefronts from the source
 * have equal work at all times. */
#ifndef GD_PARTITION_BISECTION_H
#define GD_PARTITION_BISECTION_H

#include "mesh/topology.h"

/* Assigns a part, 0 or 1, to each face and its sides. A boundary side has the part of its other
 * side. Sets bit 1 << part of a vertex for each part that has one of its faces. The plane is chosen
 * from a thousand faces in 0.3 ms for any size of the surface. The rest takes linear time, about 10
 * ns a face. The result depends on the surface and the source only. */
void gd__bisection_divide(const struct gd_mesh *mesh, struct gd_vec3 source, uint8_t *side_part,
                          uint8_t *vertex_parts);

#endif
