/* Landmarks: the distances of all vertices from a few chosen points. They give lower bounds of the
 * distance between two points, which make searches faster.
 *
 * By the triangle inequality, |d(l, p) - d(l, q)| <= d(p, q) for each landmark l (Goldberg and
 * Harrelson 2005, "Computing the shortest path: A* search meets graph theory"). Distances are
 * stored in 16 bits, and bounds are rounded down, so that results are the same with and without
 * landmarks. Landmarks are immutable: any number of threads may use them. */
#ifndef GD_LANDMARKS_H
#define GD_LANDMARKS_H

#include <stdint.h>

#include "gd/control.h"
#include "gd/mesh.h"

GD_EXTERN_C_BEGIN

struct gd_landmarks;

/* Builds `count` landmarks, at most 32. Each landmark is the vertex that is farthest from the
 * previous ones. Landmarks keep the mesh alive. The caller owns `*out`. Errors:
 * GD_INVALID_ARGUMENT (count is 0 or more than 32), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED,
 * GD_DEADLINE, GD_INTERNAL, GD_RUNAWAY. Cost: count + 1 propagations without wedges (the first
 * propagation only chooses the first landmark), and 64 bytes a vertex for any number of landmarks.
 * Thread-safe. */
GD_MUST_USE enum gd_status gd_landmarks_build(const struct gd_mesh *mesh, uint32_t count,
                                              const struct gd_control *control,
                                              struct gd_landmarks **out);
void gd_landmarks_release(const struct gd_landmarks *landmarks); /* NULL is allowed */
uint32_t gd_landmarks_count(const struct gd_landmarks *landmarks);
size_t gd_landmarks_memsize(const struct gd_landmarks *landmarks);

/* gd_landmarks_image_size returns the size of a binary image of the landmarks;
 * gd_landmarks_write_image writes that many bytes. Any little-endian machine can open the image. */
size_t gd_landmarks_image_size(const struct gd_landmarks *landmarks);
void gd_landmarks_write_image(const struct gd_landmarks *landmarks, void *bytes);

/* Creates landmarks from an image. Values are not verified; use a checksum for them. Errors:
 * GD_UNRECOGNIZED, GD_INVALID_ARGUMENT (an image of another mesh), GD_TRUNCATED, GD_NON_FINITE,
 * GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd_landmarks_open_image(const struct gd_mesh *mesh, const void *bytes,
                                                   size_t size, struct gd_landmarks **out);

GD_EXTERN_C_END

#endif
