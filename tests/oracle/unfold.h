/* A simple exact geodesic solver for small meshes. It stores no windows on edges and shares no code
 * with the engine.
 *
 * A shortest path is a chain of straight segments between vertices; a path may bend at any vertex.
 * Unfolding finds the segments. From the first vertex, the solver lays out in the plane every
 * sequence of faces that a cone of directions can pass, depth first. A sequence ends where, for
 * every point of the next edge, a path through the sequence is longer than a known path. Points
 * that are not vertices are inserted by splitting their face or edge, which changes no distance.
 * Suitable for some hundred faces. */
#pragma once

#include <stdint.h>

struct unfold_mesh;

/* Copies a mesh, whose faces may have any orientation, with room for `insertions` points. Returns
 * NULL if out of memory. */
struct unfold_mesh *unfold_create(const double (*positions)[3], uint32_t position_count,
                                  const uint32_t *corners, uint32_t face_count,
                                  uint32_t insertions);
void unfold_free(struct unfold_mesh *mesh);

/* Returns the vertex at a point of an original face. Adds it unless the point is a vertex already.
 * Weights of exactly zero place the point on an edge or a vertex. */
uint32_t unfold_insert(struct unfold_mesh *mesh, uint32_t face, const double barycentric[3]);

/* Computes distances from one vertex to all vertices. `out` has position_count + insertions
 * elements: INFINITY where there is no path. */
void unfold_distances(struct unfold_mesh *mesh, uint32_t source, long double *out);
