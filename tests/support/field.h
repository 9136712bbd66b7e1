/* Field: builds fields and computes distances for tests. Any error fails the test. */
#pragma once

#include "gd/curve.h"
#include "gd/field.h"

/* Builds the field of some seeds up to a radius. A radius of 0 builds the whole field. The caller
 * releases the field. */
struct gd_field *test_field(const struct gd_mesh *mesh, const struct gd_seed *seeds, uint32_t count,
                            double radius);
struct gd_field *test_field_from(const struct gd_mesh *mesh, struct gd_point point);
struct gd_field *test_field_of_curve(const struct gd_mesh *mesh, const struct gd_curve *curve,
                                     double offset);

double test_distance(const struct gd_field *field, const struct gd_point *point);

/* Returns the Euclidean distance of p from the segment between a and b. */
double test_distance_to_segment(struct gd_vec3 p, struct gd_vec3 a, struct gd_vec3 b);
