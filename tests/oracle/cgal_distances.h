/* A C interface to CGAL's Surface_mesh_shortest_path (S. Kiazyk, S. Loriot, E. Colin de Verdiere;
 * the algorithm of Chen and Han 1990 with the filter of Xin and Wang 2009). It is an exact solver
 * that shares no code with the engine. Without CGAL (libcgal-dev) it is not available. */
#pragma once

#include "tests/oracle/cgal_polyline.h"

#ifdef __cplusplus
extern "C" {
#endif

bool cgal_is_available(void);

struct cgal_surface;

/* Copies a surface of oriented manifold triangles. Returns NULL if CGAL is not available or rejects
 * the triangles. */
struct cgal_surface *cgal_surface_create(const struct gd_polygons *triangles);
void cgal_surface_free(struct cgal_surface *surface);

/* Computes distances from one vertex to all vertices. `out` has position_count elements: INFINITY
 * where there is no path, NAN at vertices without triangles. Returns false if CGAL failed. */
bool cgal_surface_solve(struct cgal_surface *surface, uint32_t source, double *out);

/* Writes CGAL's path from a vertex to the source of the last solution. The caller frees `line` by
 * polyline_free. */
bool cgal_surface_path(struct cgal_surface *surface, uint32_t vertex, struct polyline *line);

#ifdef __cplusplus
}
#endif
