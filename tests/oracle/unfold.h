/* An exact geodesic solver for small meshes, right by simplicity: no wedges, no contests, nothing
 * shared with the engine.
 *
 * A shortest path is a chain of straight pieces between vertices (every vertex is taken for a
 * possible turning point). A straight piece is found by unfolding: from its first vertex, every
 * sequence of faces that a cone of directions can pass is laid out in the plane, depth first; it
 * ends where it would be longer than a known path to every point of the edge ahead. Points that are
 * no vertices are first made vertices by splitting the face or the edge that they lie in, which
 * changes no distance. Meant for some hundred faces. */
#ifndef TESTS_ORACLE_UNFOLD_H
#define TESTS_ORACLE_UNFOLD_H

#include <stdint.h>

struct unfold_mesh;

/* A mesh of its own, faces oriented anyhow, with room for `insertions` points. NULL: memory is
 * out. */
struct unfold_mesh *unfold_create(const double (*positions)[3], uint32_t position_count,
                                  const uint32_t *corners, uint32_t face_count,
                                  uint32_t insertions);
void unfold_free(struct unfold_mesh *mesh);

/* The vertex at a point of one of the original faces; a new one unless the point is a vertex.
 * Weights of exactly zero put the point on an edge or a vertex. */
uint32_t unfold_insert(struct unfold_mesh *mesh, uint32_t face, const double barycentric[3]);

/* Distances from one vertex to all, `out` having position_count + insertions places; INFINITY where
 * there is no path. */
void unfold_distances(struct unfold_mesh *mesh, uint32_t source, long double *out);

#endif
