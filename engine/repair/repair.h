/* What the parts of merging and of gd__repair hand to each other. Each edits work->triangle (vertex
 * indices, the order of faces kept), and notes in mesh->repair what it did. */
#ifndef GD_REPAIR_REPAIR_H
#define GD_REPAIR_REPAIR_H

#include "mesh/construction.h"

/* The steps of gd_mesh_build that are in this room. */
enum gd_status gd__merge_vertices(struct gd__construction *work);
enum gd_status gd__repair(struct gd__construction *work);

/* Appends to the text of an error that the weld moved another vertex to one of these, if it did. */
void gd__blame_weld(const struct gd__construction *work, const uint32_t *vertices, uint32_t count);

void gd__mended_add(struct gd_mended *mended, uint32_t a, uint32_t b);

/* Lets representative[i] of each vertex that a face uses name the lowest vertex that represents
 * itself and lies within the tolerance. Expected linear time for every input. GD_INVALID_ARGUMENT,
 * GD_NO_MEMORY, GD_CANCELLED, GD_DEADLINE. */
enum gd_status gd__weld_vertices(struct gd__construction *work);

/* original[i]: the first of the polygons with the same set of vertices as polygon i; itself for one
 * without corners. GD_NO_MEMORY, and the status of the pace. */
enum gd_status gd__find_duplicates(const struct gd_polygons *polygons, struct gd__pace *pace,
                                   uint32_t *original);

/* Takes the triangles whose first corner is GD_NONE out of the row. GD_NO_MEMORY. */
enum gd_status gd__compact_triangles(struct gd__construction *work);

/* The parts of gd__repair. */
enum gd_status gd__flatten_faces(struct gd__construction *work);
enum gd_status gd__split_faces(struct gd__construction *work);

static inline uint32_t gd__index_of_triangle(const struct gd__construction *work, uint32_t triangle)
{
    return work->face_index ? work->face_index[triangle] : triangle;
}

static inline struct gd_vec3 gd__input_position(const struct gd__construction *work, uint32_t index)
{
    const double *p = work->input->positions[index];
    return (struct gd_vec3){p[0], p[1], p[2]};
}

#endif
