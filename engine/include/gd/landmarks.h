/* Landmarks: distances of all vertices from a few places, which bound the distance of any two
 * points from below and so narrow searches.
 *
 * By the triangle inequality |d(l, p) - d(l, q)| <= d(p, q) for each landmark l (Goldberg and
 * Harrelson 2005, "Computing the shortest path: A* search meets graph theory"). Kept as floats,
 * rounded to the safe side where they are used: answers are the same with them and without.
 * Immutable once built; any number of threads may use them. */
#ifndef GD_LANDMARKS_H
#define GD_LANDMARKS_H

#include <stdint.h>

#include "gd/control.h"
#include "gd/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gd_landmarks;

/* Builds up to 16 landmarks, each as far as can be from those before. They keep the mesh alive.
 * Errors: GD_INVALID_ARGUMENT (count is 0 or more than 16), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED,
 * GD_DEADLINE, GD_INTERNAL, GD_RUNAWAY.
 * Cost: count + 1 propagations that store no wedges (the first only finds where the first landmark
 * goes), and 64 bytes a vertex, however many landmarks. */
GD_MUST_USE enum gd_status gd_landmarks_build(const struct gd_mesh *mesh, uint32_t count,
                                              const struct gd_control *control,
                                              struct gd_landmarks **out);
struct gd_landmarks *gd_landmarks_retain(const struct gd_landmarks *landmarks);
void gd_landmarks_release(const struct gd_landmarks *landmarks); /* NULL is harmless */
uint32_t gd_landmarks_count(const struct gd_landmarks *landmarks);
size_t gd_landmarks_memsize(const struct gd_landmarks *landmarks);

/* As bytes, to be stored: how many, and writing them. Little-endian machines of any kind read each
 * other's. */
size_t gd_landmarks_image_size(const struct gd_landmarks *landmarks);
void gd_landmarks_write_image(const struct gd_landmarks *landmarks, void *bytes);

/* GD_UNRECOGNIZED, GD_INVALID_ARGUMENT (of another mesh), GD_TRUNCATED, GD_NON_FINITE,
 * GD_NO_MEMORY. That the numbers are the ones written is for the caller's checksum to say. */
GD_MUST_USE enum gd_status gd_landmarks_open_image(const struct gd_mesh *mesh, const void *bytes,
                                                   size_t size, struct gd_landmarks **out);

#ifdef __cplusplus
}
#endif

#endif
