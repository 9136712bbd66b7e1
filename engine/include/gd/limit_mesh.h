/* Limit mesh: the discretization of a level as a mesh to walk on, with the way from places of the
 * limit surface to points of the mesh and back.
 *
 *     struct gd_limit_mesh_options options = {.level = gd_limit_mesh_usual_level(surface)};
 *     struct gd_limit_mesh *fine;
 *     if (gd_limit_mesh_build(surface, &options, NULL, &fine, &detail) == GD_OK) {
 *         gd_limit_mesh_point(fine, &place, &point, NULL);
 *         ...gd_trace_follow(gd_limit_mesh_mesh(fine), &point, ...,
 *                            with gd_limit_mesh_normals(fine))...
 *         gd_limit_mesh_free(fine);
 *     }
 *
 * Triangles are numbered face by face and cell by cell, so that no table tells them: a place's
 * triangle, and a triangle's places, are found by arithmetic. Between the vertices, which lie on
 * the surface, a place and its point have the same coordinates (u,v) of the face; in space they are
 * apart by what the triangle and the surface are, O(4^-level). Immutable once built, and read by
 * any number of threads. */
#ifndef GD_LIMIT_MESH_H
#define GD_LIMIT_MESH_H

#include "gd/limit.h"
#include "gd/mesh.h"
#include "gd/point.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GD_LIMIT_LEVEL_MOST 12

struct gd_limit_mesh;

/* 0; 1 where the control mesh has polygons that are no quads (Loop: never). */
uint32_t gd_limit_mesh_least_level(const struct gd_subdivision *surface);

/* The finest level of at most 2^17 triangles; the least one where there is none. */
uint32_t gd_limit_mesh_usual_level(const struct gd_subdivision *surface);

/* Bytes that building the mesh of a level takes at most. level <= GD_LIMIT_LEVEL_MOST. */
size_t gd_limit_mesh_cost(const struct gd_subdivision *surface, uint32_t level);

struct gd_limit_mesh_options {
    uint32_t level;     /* from gd_limit_mesh_least_level to GD_LIMIT_LEVEL_MOST */
    uint32_t max_faces; /* most triangles; 0: 2^28 */
};

/* The caller frees `*out`, which keeps the surface alive; `control` and `detail` may be NULL.
 * Errors: those of gd_discretize (GD_INVALID_ARGUMENT, GD_TOO_LARGE) and of gd_mesh_build
 * (GD_DEGENERATE_FACE above all: the surface is flat like a line somewhere). Linear time, some 0.5
 * us a vertex; memory as gd_limit_mesh_cost, of which a half stays. */
GD_MUST_USE enum gd_status gd_limit_mesh_build(const struct gd_subdivision *surface,
                                               const struct gd_limit_mesh_options *options,
                                               const struct gd_control *control,
                                               struct gd_limit_mesh **out,
                                               struct gd_detail *detail);
void gd_limit_mesh_free(struct gd_limit_mesh *fine); /* NULL is harmless */
size_t gd_limit_mesh_memsize(const struct gd_limit_mesh *fine);

/* Borrowed, valid as long as the limit mesh. */
const struct gd_subdivision *gd_limit_mesh_surface(const struct gd_limit_mesh *fine);
const struct gd_mesh *gd_limit_mesh_mesh(const struct gd_limit_mesh *fine);
/* the surface's, one a vertex index */
const struct gd_vec3 *gd_limit_mesh_normals(const struct gd_limit_mesh *fine);
uint32_t gd_limit_mesh_level(const struct gd_limit_mesh *fine);

/* The mesh's point at a place. Errors: those of gd_limit_place_check. O(1), with polygons O(log
 * faces). */
GD_MUST_USE enum gd_status gd_limit_mesh_point(const struct gd_limit_mesh *fine,
                                               const struct gd_limit_point *place,
                                               struct gd_point *out, struct gd_detail *detail);

/* The place of a point of the mesh; on edges between faces in any of them. The same cost. */
struct gd_limit_point gd_limit_mesh_place(const struct gd_limit_mesh *fine,
                                          const struct gd_point *point);

#ifdef __cplusplus
}
#endif

#endif
