/* Functions that the steps of merging and repair share. Each step changes vertex indices in
 * work->triangle, keeps the order of the faces, and records its changes in mesh->repair. */
#pragma once

#include "mesh/construction.h"

/* The steps of gd_mesh_build in this folder. */
enum gd_status gd__merge_vertices(struct gd__construction *work);
enum gd_status gd__repair(struct gd__construction *work);

/* Appends a sentence to the text of an error if the weld merged another vertex into one of
 * `vertices`. */
void gd__blame_weld(const struct gd__construction *work, const uint32_t *vertices, uint32_t count);

/* Sets representative[i] for each vertex i that a face uses. Among the vertices that represent
 * themselves and are within the tolerance of vertex i, it is the one with the lowest number.
 * Expected linear time for every input. Errors: GD_INVALID_ARGUMENT, GD_NO_MEMORY, GD_CANCELLED,
 * GD_DEADLINE. */
enum gd_status gd__weld_vertices(struct gd__construction *work);

/* Sets original[i] to the first polygon with the same set of vertices as polygon i, or to i if
 * polygon i has no corners. Errors: GD_NO_MEMORY, and those of the pace. */
enum gd_status gd__find_duplicates(const struct gd_polygons *polygons, struct gd__pace *pace,
                                   uint32_t *original);

/* Removes the triangles whose first corner is GD_NONE. Errors: GD_NO_MEMORY. */
enum gd_status gd__compact_triangles(struct gd__construction *work);

/* The steps of gd__repair. */
enum gd_status gd__flatten_faces(struct gd__construction *work);
enum gd_status gd__split_faces(struct gd__construction *work);

static inline uint32_t gd__index_of_triangle(const struct gd__construction *work, uint32_t triangle)
{
    return work->face_index ? work->face_index[triangle] : triangle;
}
