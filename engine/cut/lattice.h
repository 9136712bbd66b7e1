/* Lattice: sites in a face.
 *
 * A site (plane/site.h) holds the barycentric coordinates of corners 1 and 2 of the face
 * (mesh/topology.h) in units of 2^-50. Barycentric coordinates are an affine map of the face, so
 * three points have the same orientation as in the face. Points of the face's sides are exactly on
 * the sides; for example, the coordinates of a point on side 1 sum to GD__LATTICE. */
#pragma once

#include <math.h>

#include "plane/site.h"

#define GD__LATTICE (INT64_C(1) << 50)

static inline int64_t gd__to_lattice(double weight)
{
    return llround(weight * (double)GD__LATTICE);
}

static inline double gd__from_lattice(int64_t part)
{
    return (double)part / (double)GD__LATTICE; /* this division is exact */
}
