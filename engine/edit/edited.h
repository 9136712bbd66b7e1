/* Functions that all edits use: they read a mesh and write the arrays of a result. C++ code cannot
 * include mesh/topology.h, so it reads a mesh by these functions. */
#pragma once

#include "gd/edit.h"
#include "gd/point.h"

#ifdef __cplusplus
extern "C" {
#endif

/* --- reading; vertices, sides and faces have internal numbers (mesh/topology.h) --------------- */

struct gd__edit_counts {
    uint32_t vertices, edges, faces;
    uint32_t indices, face_indices; /* number of indices of the input */
};

struct gd__edit_side {
    uint32_t destination; /* a vertex */
    /* next side around the face; for a boundary side, the next side around the hole */
    uint32_t next;
    uint32_t face; /* GD_NONE at the boundary */
};

struct gd__edit_counts gd__edit_counts(const struct gd_mesh *mesh);
struct gd__edit_side gd__edit_side(const struct gd_mesh *mesh, uint32_t side);

/* Returns a side that begins at the vertex. For a boundary vertex, this is the boundary side. */
uint32_t gd__edit_leaving(const struct gd_mesh *mesh, uint32_t vertex);

/* Returns the side from corner 0 of a face. */
uint32_t gd__edit_first_side(const struct gd_mesh *mesh, uint32_t face);

/* Returns the vertex or face of an index of the input. Returns GD_NONE if the index has no vertex
 * or face, or if its vertex was merged into the vertex of another index. */
uint32_t gd__edit_vertex(const struct gd_mesh *mesh, uint32_t index);
uint32_t gd__edit_face(const struct gd_mesh *mesh, uint32_t index);

/* Returns the position of a vertex in the unit box. This is the surface's bounding box, moved so
 * that its corner with the smallest coordinates is the origin, and scaled so that its longest side
 * has length 1. */
struct gd_vec3 gd__edit_place(const struct gd_mesh *mesh, uint32_t vertex);

/* Returns the length of the unit box's sides in the mesh's unit. */
double gd__edit_box_size(const struct gd_mesh *mesh);

/* --- results ---------------------------------------------------------------------------------- */

/* Allocates the arrays for that many vertices and triangles. Error: GD_NO_MEMORY (nothing is
 * allocated). */
GD_MUST_USE enum gd_status gd__edited_allocate(struct gd_edited *edited, uint32_t vertices,
                                               uint32_t faces);

/* Copies the position of a vertex of the mesh to vertex `at` of the result. The origin of vertex
 * `at` becomes the vertex of the mesh. */
void gd__edited_keep(struct gd_edited *edited, uint32_t at, const struct gd_mesh *mesh,
                     uint32_t vertex);

/* Writes all vertices and faces of the mesh to the beginning of the arrays, in the order of their
 * indices. Sets number[v] to the number of the internal vertex v in the result. The pace may stop
 * the function early. */
struct gd__pace;
void gd__edited_copy(struct gd_edited *edited, const struct gd_mesh *mesh, uint32_t *number,
                     struct gd__pace *pace);

/* Measures edited->largest_distance. The first `kept` faces of the result must be faces of the
 * mesh, and all of them if `kept` is their number. If there is anything to measure, builds
 * edited->mesh. Errors: those of gd_edit_deviation. */
GD_MUST_USE enum gd_status gd__edited_measure(struct gd_edited *edited, const struct gd_mesh *mesh,
                                              uint32_t kept, const struct gd_control *control,
                                              struct gd_detail *detail);

/* Converts a point of the mesh to an origin. */
struct gd_origin gd__origin_of(const struct gd_mesh *mesh, const struct gd_point *point);

/* Computes one level of subdivision. Ignores options->levels. */
GD_MUST_USE enum gd_status gd__subdivide_once(const struct gd_mesh *mesh,
                                              const struct gd_subdivide_options *options,
                                              const struct gd_control *control,
                                              struct gd_edited *out, struct gd_detail *detail);

#ifdef __cplusplus
}
#endif
