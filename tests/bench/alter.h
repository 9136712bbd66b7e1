/* Alter: larger and rougher forms of any triangle mesh, so that one model gives a family of sizes.
 * Both work in place. */
#ifndef TESTS_BENCH_ALTER_H
#define TESTS_BENCH_ALTER_H

#include "gd/polygons.h"
#include "gd/status.h"

/* Splits every triangle at the middles of its edges, `levels` times. GD_TOO_LARGE: more than 2^28
 * triangles; GD_NO_MEMORY. */
GD_MUST_USE enum gd_status alter_subdivide(struct gd_polygons *mesh, uint32_t levels);

/* Moves every vertex along its normal (the mean of its faces', by area) by up to `amplitude` mean
 * edges to either side, evenly spread, from a fixed seed. GD_NO_MEMORY: nothing is changed. */
GD_MUST_USE enum gd_status alter_roughen(struct gd_polygons *mesh, double amplitude);

#endif
