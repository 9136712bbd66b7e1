/* Laws: what every geodesic distance obeys, on whatever surface. Each check fails the running test
 * when a law is broken by more than 1e-9 and returns the largest relative error. */
#ifndef TESTS_SUPPORT_LAWS_H
#define TESTS_SUPPORT_LAWS_H

#include "tests/support/test.h"

/* Distance from p to q, without a path. */
double law_distance(const struct gd_mesh *mesh, struct gd_point p, struct gd_point q);

/* d(p,p) = 0, d(p,q) = d(q,p), d(p,q) <= d(p,r) + d(r,q). */
double law_metric(const struct gd_mesh *mesh, struct gd_point p, struct gd_point q,
                  struct gd_point r);

/* The path from p to q runs on the surface, consecutive points in one face, from p to q, and is as
 * long as the distance. The polygons are those that the mesh was built from. */
double law_path(const struct gd_mesh *mesh, const struct gd_polygons *polygons, struct gd_point p,
                struct gd_point q);

/* Along every edge the distance from p changes by no more than the edge's length. */
void law_lipschitz(const struct gd_mesh *mesh, const struct gd_polygons *polygons,
                   struct gd_point p);

#endif
