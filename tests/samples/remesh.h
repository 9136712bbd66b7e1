/* Remesh: replaces the triangulation of a closed surface by one with a given number of faces and
 * edges of given evenness. */
#ifndef TESTS_SAMPLES_REMESH_H
#define TESTS_SAMPLES_REMESH_H

#include "gd/polygons.h"
#include "gd/status.h"

struct remeshing {
    uint32_t faces; /* even, smaller than the mesh's number of faces */
    /* edge lengths vary by exp(+-contrast) along a wave in space of length about two */
    double contrast;
    double noise;     /* and randomly by exp(+-noise) */
    uint32_t passes;  /* smoothing passes, which make edges and angles similar */
    double roughness; /* largest final displacement of coordinates, relative to the mean edge */
};

/* Collapses the shortest edges until `faces` are left. Then alternates between flipping edges
 * (towards valence six and Delaunay) and moving vertices within the surface to the centroid of
 * their faces. GD_NO_MEMORY; GD_INVALID_ARGUMENT: an odd number of faces, or too few for the
 * surface. The mesh is lost on failure. */
GD_MUST_USE enum gd_status sample_remesh(struct gd_polygons *mesh,
                                         const struct remeshing *remeshing, uint64_t seed);

#endif
