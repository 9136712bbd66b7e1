/* Limit mesh: the discretization of a limit surface at one level, with maps between places of the
 * limit surface (gd/limit.h) and points of the mesh.
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
 * Triangles are numbered by control face and then by cell, so that both maps are computed without a
 * table. A place and its point have the same (u,v). Vertices of the mesh lie on the limit surface.
 * At other points, a place and its point differ in space by O(4^-level). A limit mesh is immutable:
 * any number of threads may read it. */
#ifndef GD_LIMIT_MESH_H
#define GD_LIMIT_MESH_H

#include "gd/limit.h"
#include "gd/mesh.h"
#include "gd/point.h"

GD_EXTERN_C_BEGIN

#define GD_LIMIT_LEVEL_MOST 12

struct gd_limit_mesh;

/* Returns the coarsest level: 1 if a Catmull-Clark control mesh has polygons other than quads,
 * otherwise 0. */
uint32_t gd_limit_mesh_least_level(const struct gd_subdivision *surface);

/* Returns the finest level with at most 2^17 triangles, or the coarsest level if all levels have
 * more. */
uint32_t gd_limit_mesh_usual_level(const struct gd_subdivision *surface);

/* Returns an upper bound of the bytes that are needed to build the mesh of a level. level <=
 * GD_LIMIT_LEVEL_MOST. */
size_t gd_limit_mesh_cost(const struct gd_subdivision *surface, uint32_t level);

struct gd_limit_mesh_options {
    uint32_t level;     /* from gd_limit_mesh_least_level to GD_LIMIT_LEVEL_MOST */
    uint32_t max_faces; /* largest number of triangles; 0 means 2^28 */
};

/* Builds the mesh of a level. The caller frees `*out` by gd_limit_mesh_free; `*out` keeps the
 * surface alive. `control` and `detail` may be NULL. Errors: those of gd_discretize
 * (GD_INVALID_ARGUMENT, GD_TOO_LARGE) and of gd_mesh_build (mostly GD_DEGENERATE_FACE, where the
 * surface is as thin as a line). Cost: linear time, about 0.5 us a vertex; memory: see
 * gd_limit_mesh_cost; the mesh keeps half of it. Thread-safe. */
GD_MUST_USE enum gd_status gd_limit_mesh_build(const struct gd_subdivision *surface,
                                               const struct gd_limit_mesh_options *options,
                                               const struct gd_control *control,
                                               struct gd_limit_mesh **out,
                                               struct gd_detail *detail);
void gd_limit_mesh_free(struct gd_limit_mesh *fine); /* NULL is allowed */
size_t gd_limit_mesh_memsize(const struct gd_limit_mesh *fine);

/* The results of the following functions are borrowed and valid as long as the limit mesh. */
const struct gd_subdivision *gd_limit_mesh_surface(const struct gd_limit_mesh *fine);
const struct gd_mesh *gd_limit_mesh_mesh(const struct gd_limit_mesh *fine);
/* Returns normals of the limit surface, one for each vertex index. */
const struct gd_vec3 *gd_limit_mesh_normals(const struct gd_limit_mesh *fine);
uint32_t gd_limit_mesh_level(const struct gd_limit_mesh *fine);

/* Computes the mesh point of a place. Errors: those of gd_limit_place_check. O(1); O(log faces) if
 * the control mesh has polygons other than quads. Thread-safe. */
GD_MUST_USE enum gd_status gd_limit_mesh_point(const struct gd_limit_mesh *fine,
                                               const struct gd_limit_point *place,
                                               struct gd_point *out, struct gd_detail *detail);

/* Returns the place of a mesh point. For a point on an edge between two faces, the place is in one
 * of these faces. Cost: as gd_limit_mesh_point. */
struct gd_limit_point gd_limit_mesh_place(const struct gd_limit_mesh *fine,
                                          const struct gd_point *point);

GD_EXTERN_C_END

#endif
