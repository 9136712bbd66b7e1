/* Remesh: another triangulation of a closed surface, with a given number of faces and edges as even
 * or uneven as wanted. */
#ifndef TESTS_SAMPLES_REMESH_H
#define TESTS_SAMPLES_REMESH_H

#include "gd/polygons.h"
#include "gd/status.h"

struct remeshing {
    uint32_t faces; /* even, below what the mesh has */
    /* edges grow and shrink by exp(+-contrast) along a wave in space of about two units */
    double contrast;
    double noise;     /* and by exp(+-noise) at random */
    uint32_t passes;  /* of evening out afterwards, which makes edges and angles alike */
    double roughness; /* in the end every coordinate moves by up to this part of the mean edge */
};

/* Collapses the shortest edges until `faces` are left, then flips edges towards valence six and to
 * Delaunay and moves vertices within the surface to the centroid of their faces, in turns.
 * GD_NO_MEMORY; GD_INVALID_ARGUMENT: an odd number of faces, or so few that they can't carry the
 * surface. The mesh is lost on failure. */
GD_MUST_USE enum gd_status sample_remesh(struct gd_polygons *mesh,
                                         const struct remeshing *remeshing, uint64_t seed);

#endif
