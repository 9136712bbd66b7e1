/* CGAL's Surface_mesh_shortest_path (S. Kiazyk, S. Loriot, E. Colin de Verdiere; the algorithm of
 * Chen and Han 1990 with the filter of Xin and Wang 2009) behind a C interface: an exact solver
 * that shares nothing with the engine. Not there on machines without CGAL (libcgal-dev). */
#ifndef TESTS_ORACLE_CGAL_DISTANCES_H
#define TESTS_ORACLE_CGAL_DISTANCES_H

#include "tests/oracle/cgal_polyline.h"

#ifdef __cplusplus
extern "C" {
#endif

bool cgal_is_available(void);

struct cgal_surface;

/* A surface of its own from oriented manifold triangles. NULL: CGAL is not there or does not take
 * them. */
struct cgal_surface *cgal_surface_create(const struct gd_polygons *triangles);
void cgal_surface_free(struct cgal_surface *surface);

/* Distances from one vertex to all, `out` having position_count places: INFINITY where there is no
 * path, NAN at vertices that no triangle uses. false: CGAL gave up. */
bool cgal_surface_solve(struct cgal_surface *surface, uint32_t source, double *out);

/* CGAL's path from a vertex to the source that was solved for last, in `line` (free it by
 * polyline_free). */
bool cgal_surface_path(struct cgal_surface *surface, uint32_t vertex, struct polyline *line);

#ifdef __cplusplus
}
#endif

#endif
