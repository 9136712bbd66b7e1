/* Laws of geodesic distances on any surface. A violation by more than 1e-9 fails the running test.
 * Functions that return a double, except law_distance, return the largest relative error. */
#pragma once

#include "tests/support/test.h"

/* Returns the distance from p to q, computed without a path. */
double law_distance(const struct gd_mesh *mesh, struct gd_point p, struct gd_point q);

/* Checks d(p,p) = 0, d(p,q) = d(q,p), d(p,q) <= d(p,r) + d(r,q). */
double law_metric(const struct gd_mesh *mesh, struct gd_point p, struct gd_point q,
                  struct gd_point r);

/* Checks the path from p to q: its ends, that consecutive points share a face, and that its length
 * is the distance. The mesh must be built from `polygons`. */
double law_path(const struct gd_mesh *mesh, const struct gd_polygons *polygons, struct gd_point p,
                struct gd_point q);

/* Checks that the distance from p changes along every edge by at most the edge's length. */
void law_lipschitz(const struct gd_mesh *mesh, const struct gd_polygons *polygons,
                   struct gd_point p);
