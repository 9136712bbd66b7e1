/* Closed forms: exact geodesic distances on surfaces that unfold into a plane. They are distances
 * on the polyhedron, not on the round surface that it approximates. */
#pragma once

#include <stdint.h>

/* Returns the distance between two points of the surface of a box, in which coordinate k is in
 * [0,size[k]]. Each point has a coordinate that is exactly 0 or size[k]. The distance is the
 * minimum over all sequences of faces that the straight line between the unfolded points
 * crosses. */
double closed_form_box(const double size[3], const double p[3], const double q[3]);

/* A fan of congruent triangles around an apex on the z axis (sample_cone, sample_saddle). Spoke i
 * has the azimuth 2 pi i / sectors, and z = corner_z[i % 2] at `radius`. */
struct closed_form_fan {
    double radius, apex_z, corner_z[2];
    uint32_t sectors;
};

double closed_form_fan(const struct closed_form_fan *fan, const double p[3], const double q[3]);

/* Returns the distance on the lateral surface of a prism over a regular polygon with this radius
 * and its first corner at azimuth 0 (sample_cylinder). */
double closed_form_prism(double radius, uint32_t sides, const double p[3], const double q[3]);

/* Returns the distance on a regular tetrahedron. A point has a weight for each corner, at least one
 * of them 0. The surface is the plane folded by half-turns about the points of a triangular
 * lattice. */
double closed_form_tetrahedron(double edge, const double p[4], const double q[4]);
