/* Transforms: changes of a triangle mesh under which distances stay, scale, or follow another law.
 * All work in place. */
#ifndef TESTS_SAMPLES_TRANSFORM_H
#define TESTS_SAMPLES_TRANSFORM_H

#include "gd/polygons.h"
#include "gd/status.h"

/* Multiplies the coordinates of each axis. */
void sample_scale(struct gd_polygons *mesh, double x, double y, double z);

/* Moves and scales the mesh so that its bounding box is centred at the origin and its longest side
 * is 2. */
void sample_fit(struct gd_polygons *mesh);

/* A random rotation about the origin and a random translation by up to `reach` along each axis. */
void sample_move(struct gd_polygons *mesh, double reach, uint64_t seed);

/* Moves every coordinate by up to `amplitude`. */
void sample_jitter(struct gd_polygons *mesh, double amplitude, uint64_t seed);

/* Turns over each face with the given probability. */
void sample_flip_faces(struct gd_polygons *mesh, double probability, uint64_t seed);

/* Shuffles vertices and faces and rotates the corners of each face. `vertex_map` and `face_map`
 * (may be NULL) receive the new index of each old one. GD_NO_MEMORY: nothing is changed. */
GD_MUST_USE enum gd_status sample_renumber(struct gd_polygons *mesh, uint64_t seed,
                                           uint32_t *vertex_map, uint32_t *face_map);

/* Splits every triangle at the middles of its edges. Vertices keep their index, triangle f becomes
 * 4f to 4f + 3, the last one in the middle and 4f + k at corner k. GD_NO_MEMORY: nothing is
 * changed. */
GD_MUST_USE enum gd_status sample_subdivide(struct gd_polygons *mesh);

/* Adds the vertices and triangles of another mesh behind its own. GD_NO_MEMORY: nothing is
 * changed. */
GD_MUST_USE enum gd_status sample_append(struct gd_polygons *mesh, const struct gd_polygons *other);

#endif
