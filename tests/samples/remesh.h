/* Remesh: replaces the triangulation of a closed surface. The new triangulation has a given number
 * of faces, and edge lengths of a given evenness. */
#pragma once

#include "gd/polygons.h"
#include "gd/status.h"

struct remeshing {
    /* number of faces of the result; even, and smaller than the mesh's number of faces */
    uint32_t faces;
    /* edge lengths vary by exp(+-contrast) along a wave in space of length about two */
    double contrast;
    double noise;     /* edge lengths also vary randomly by exp(+-noise) */
    uint32_t passes;  /* number of smoothing passes, which make edges and angles similar */
    double roughness; /* largest final displacement of coordinates, relative to the mean edge */
};

/* Collapses the shortest edges until `faces` faces remain. Then alternately flips edges (towards
 * valence six and Delaunay) and moves vertices within the surface to the centroid of their faces.
 * Returns GD_INVALID_ARGUMENT if the number of faces is odd or too small for the surface, or
 * GD_NO_MEMORY. The mesh is lost on failure. */
GD_MUST_USE enum gd_status sample_remesh(struct gd_polygons *mesh,
                                         const struct remeshing *remeshing, uint64_t seed);
