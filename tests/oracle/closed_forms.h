/* Closed forms: exact geodesic distances on surfaces that unfold into the plane, those of the
 * polyhedron, not of the round solid. */
#ifndef TESTS_ORACLE_CLOSED_FORMS_H
#define TESTS_ORACLE_CLOSED_FORMS_H

#include <stdint.h>

/* On the surface of the box [0,size[k]] between two of its points (each with a coordinate that is
 * exactly 0 or size[k]): the least over all sequences of faces that the straight line between the
 * unfolded points passes. */
double closed_form_box(const double size[3], const double p[3], const double q[3]);

/* On a fan of congruent triangles round an apex on the z axis, whose spoke i points to azimuth 2 pi
 * i / sectors and to z = corner_z[i % 2] at `radius`: sample_cone and sample_saddle. */
struct closed_form_fan {
    double radius, apex_z, corner_z[2];
    uint32_t sectors;
};

double closed_form_fan(const struct closed_form_fan *fan, const double p[3], const double q[3]);

/* On the mantle of the prism over a regular polygon of that radius, its first corner at azimuth 0:
 * sample_cylinder. */
double closed_form_prism(double radius, uint32_t sides, const double p[3], const double q[3]);

/* On a regular tetrahedron: a face is three of the corners 0 to 3, a point on it has a weight for
 * each corner, one of them 0. The surface is the plane folded up by half-turns about the points of
 * a triangular lattice. */
double closed_form_tetrahedron(double edge, const double p[4], const double q[4]);

#endif
