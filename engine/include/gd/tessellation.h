/* Tessellation: triangles between points of a parametric surface that remember their (u, v).
 *
 *     struct gd_tessellation *tessellation;
 *     if (gd_tessellation_build(surface, NULL, NULL, &tessellation, &detail) == GD_OK) {
 *         const struct gd_mesh *mesh = gd_tessellation_mesh(tessellation);
 *         double uv[2];
 *         gd_tessellation_vertex(tessellation, (struct gd_vertex){12}, uv);
 *     }
 *
 * The vertices are a grid of the domain, unless `steps` are given one that contains all lines of
 * the surface; closed directions are welded, a pole is one vertex. A tessellation is immutable once
 * built: any number of threads may read it. It keeps its surface alive. */
#ifndef GD_TESSELLATION_H
#define GD_TESSELLATION_H

#include "gd/mesh.h"
#include "gd/parametric.h"
#include "gd/point.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gd_tessellation;

#define GD_TESSELLATION_FACES     4096 /* about so many when nothing is said */
#define GD_TESSELLATION_FACES_MAX 16777216

#define GD_TESSELLATION_STEPS_LEAST 3 /* around a closed direction fewer make no mesh */

/* All zero: about GD_TESSELLATION_FACES triangles. */
struct gd_tessellation_options {
    uint32_t faces; /* about so many triangles; more where lines or `deviation` ask for it */
    /* length > 0: how far, about, an edge may be from the surface; 0: no matter */
    double deviation;
    /* instead of both: even steps in u and in v, at least GD_TESSELLATION_STEPS_LEAST each; 0 both:
       as those say */
    uint32_t steps[2];
};

/* Errors: GD_INVALID_ARGUMENT (options out of range), GD_TOO_LARGE (more than
 * GD_TESSELLATION_FACES_MAX triangles), those of gd_mesh_build (a surface whose grid is no mesh,
 * because it is flat or folds onto itself), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE.
 * O(faces). */
GD_MUST_USE enum gd_status gd_tessellation_build(const struct gd_parametric *surface,
                                                 const struct gd_tessellation_options *options,
                                                 const struct gd_control *control,
                                                 struct gd_tessellation **out,
                                                 struct gd_detail *detail);

struct gd_tessellation *gd_tessellation_retain(const struct gd_tessellation *tessellation);
void gd_tessellation_release(const struct gd_tessellation *tessellation); /* NULL is harmless */
size_t gd_tessellation_memsize(const struct gd_tessellation *tessellation);

/* Borrowed, valid as long as the tessellation. Vertices and faces of the mesh are numbered as in
 * `polygons`. */
const struct gd_parametric *gd_tessellation_surface(const struct gd_tessellation *tessellation);
const struct gd_mesh *gd_tessellation_mesh(const struct gd_tessellation *tessellation);
const struct gd_polygons *gd_tessellation_polygons(const struct gd_tessellation *tessellation);

/* (u, v) of a vertex: of the copies that a weld joined, the lowest one. */
void gd_tessellation_vertex(const struct gd_tessellation *tessellation, struct gd_vertex vertex,
                            double uv[2]);

/* (u, v) of a point of the mesh, between those of its face's corners. At a pole the parameter along
 * it is that of the face. */
void gd_tessellation_parameters(const struct gd_tessellation *tessellation,
                                const struct gd_point *point, double uv[2]);

/* The point of the mesh with parameters (u, v). GD_INVALID_ARGUMENT: outside the domain. */
GD_MUST_USE enum gd_status gd_tessellation_point(const struct gd_tessellation *tessellation,
                                                 double u, double v, struct gd_point *out,
                                                 struct gd_detail *detail);

#ifdef __cplusplus
}
#endif

#endif
