/* Point sets: the weighted mean of points of a surface, and points that cover a surface evenly. */
#pragma once

#include "gd/mean.h"
#include "generated/requests.h"
#include "proto/http/options.h"
#include "proto/values/point.h"

void proto_mean_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                       const struct gd_mean *mean, const struct proto_options *options);

/* Writes the points and their radii. The geometry selects the form of the points: in full, as
 * [x,y,z], or not at all. A radius that is not finite is null. `snap` is the distance by which the
 * first point was moved onto the surface; NAN means that it was not moved. */
void proto_sampling_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                           const struct gd_point *points, const double *radii, uint32_t count,
                           double snap, const struct proto_options *options);
