/* Transforms: changes of a triangle mesh that preserve distances, scale them, or change them by
 * another known law. All work in place. */
#pragma once

#include "gd/polygons.h"
#include "gd/status.h"

/* Multiplies the coordinates of each axis by a factor. */
void sample_scale(struct gd_polygons *mesh, double x, double y, double z);

/* Moves and scales the mesh. Its bounding box is then centred at the origin, with 2 as the longest
 * side. */
void sample_fit(struct gd_polygons *mesh);

/* Applies a random rotation about the origin and a random translation by up to `reach` along each
 * axis. */
void sample_move(struct gd_polygons *mesh, double reach, uint64_t seed);

/* Moves every coordinate by up to `amplitude`. */
void sample_jitter(struct gd_polygons *mesh, double amplitude, uint64_t seed);

/* Flips each face with this probability. */
void sample_flip_faces(struct gd_polygons *mesh, double probability, uint64_t seed);

/* Shuffles vertices and faces, and rotates the corners of each face. `vertex_map` and `face_map`
 * receive the new index of each vertex and face; they may be NULL. On GD_NO_MEMORY nothing is
 * changed. */
GD_MUST_USE enum gd_status sample_renumber(struct gd_polygons *mesh, uint64_t seed,
                                           uint32_t *vertex_map, uint32_t *face_map);

/* Splits every triangle at the midpoints of its edges. Vertices keep their index. Triangle f
 * becomes 4f to 4f + 3: 4f + k at corner k, and 4f + 3 in the middle. GD_NO_MEMORY: nothing is
 * changed. */
GD_MUST_USE enum gd_status sample_subdivide(struct gd_polygons *mesh);

/* Appends the vertices and triangles of another mesh. GD_NO_MEMORY: nothing is changed. */
GD_MUST_USE enum gd_status sample_append(struct gd_polygons *mesh, const struct gd_polygons *other);
