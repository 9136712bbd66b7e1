/* Tessellation: a triangulation of a parametric surface, with the (u, v) of each vertex.
 *
 *     struct gd_tessellation *tessellation;
 *     if (gd_tessellation_build(surface, NULL, NULL, &tessellation, &detail) == GD_OK) {
 *         const struct gd_mesh *mesh = gd_tessellation_mesh(tessellation);
 *         double uv[2];
 *         gd_tessellation_vertex(tessellation, (struct gd_vertex){12}, uv);
 *     }
 *
 * The vertices form a grid in the domain. Unless `steps` is set, the grid contains all lines of the
 * surface. Closed directions are welded; a pole is one vertex. A tessellation is immutable: any
 * number of threads may read it. A tessellation keeps its surface alive. */
#ifndef GD_TESSELLATION_H
#define GD_TESSELLATION_H

#include "gd/mesh.h"
#include "gd/parametric.h"
#include "gd/point.h"

GD_EXTERN_C_BEGIN

struct gd_tessellation;

#define GD_TESSELLATION_FACES     4096 /* approximate default number of triangles */
#define GD_TESSELLATION_FACES_MAX 16777216

/* with fewer steps around a closed direction, the mesh would be invalid */
#define GD_TESSELLATION_STEPS_LEAST 3

/* If all members are zero, there are about GD_TESSELLATION_FACES triangles. */
struct gd_tessellation_options {
    uint32_t faces; /* approximate number of triangles; more if lines or `deviation` need them */
    /* approximate limit on the distance of an edge from the surface, a length; 0 means no limit */
    double deviation;
    /* Numbers of equal steps in u and in v, which replace `faces` and `deviation`. Each is at least
       GD_TESSELLATION_STEPS_LEAST, or both are 0, which means unused. */
    uint32_t steps[2];
    /* largest number of triangles of an untrimmed surface, at most GD_TESSELLATION_FACES_MAX; 0
       means GD_TESSELLATION_FACES_MAX */
    uint32_t max_faces;
};

/* Builds a tessellation; the caller owns `*out`. Errors: GD_INVALID_ARGUMENT (options out of
 * range), GD_TOO_LARGE (more than max_faces triangles; nothing is built then), those of
 * gd_mesh_build (the grid is not a valid mesh, because the surface is flat or folds onto itself),
 * GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. O(faces). Thread-safe. */
GD_MUST_USE enum gd_status gd_tessellation_build(const struct gd_parametric *surface,
                                                 const struct gd_tessellation_options *options,
                                                 const struct gd_control *control,
                                                 struct gd_tessellation **out,
                                                 struct gd_detail *detail);

void gd_tessellation_release(const struct gd_tessellation *tessellation); /* NULL is allowed */
size_t gd_tessellation_memsize(const struct gd_tessellation *tessellation);

/* Return the surface, mesh and polygons of a tessellation, borrowed and valid as long as the
 * tessellation. The mesh numbers vertices and faces as the polygons do. */
const struct gd_parametric *gd_tessellation_surface(const struct gd_tessellation *tessellation);
const struct gd_mesh *gd_tessellation_mesh(const struct gd_tessellation *tessellation);
const struct gd_polygons *gd_tessellation_polygons(const struct gd_tessellation *tessellation);

/* Returns (u, v) of a vertex. If a vertex has several (u, v), because copies were welded, returns
 * the lowest. O(1). */
void gd_tessellation_vertex(const struct gd_tessellation *tessellation, struct gd_vertex vertex,
                            double uv[2]);

/* Returns (u, v) of a point of the mesh, interpolated in its face. At a pole, the parameter along
 * the pole is interpolated from the other corners of the face. O(1). */
void gd_tessellation_parameters(const struct gd_tessellation *tessellation,
                                const struct gd_point *point, double uv[2]);

/* Computes the point of the mesh with parameters (u, v). Error: GD_INVALID_ARGUMENT (outside the
 * domain). O(log steps). Thread-safe. */
GD_MUST_USE enum gd_status gd_tessellation_point(const struct gd_tessellation *tessellation,
                                                 double u, double v, struct gd_point *out,
                                                 struct gd_detail *detail);

GD_EXTERN_C_END

#endif
