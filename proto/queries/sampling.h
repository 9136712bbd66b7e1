/* Sampling: the answer of points that cover a surface evenly. */
#ifndef PROTO_SAMPLING_H
#define PROTO_SAMPLING_H

#include "proto/http/options.h"
#include "proto/values/point.h"

/* Writes the points, by the geometry as elsewhere, [x,y,z] or left out, and their radii; a radius
 * that is not finite is null. `snap`: how far the first point was moved; NAN: it was not. */
void proto_sampling_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                           const struct gd_point *points, const double *radii, uint32_t count,
                           double snap, const struct proto_options *options);

#endif
