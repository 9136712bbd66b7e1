/* Discretization: a triangulation with vertices on a limit surface, and the (face, u, v) of each
 * vertex.
 *
 *     struct gd_discretization fine;
 *     const struct gd_discretize_options options = {.level = 5};
 *     if (gd_discretize(surface, &options, NULL, &fine, NULL) == GD_OK) {
 *         ...gd_mesh_build(&fine.polygons, ...)...
 *         gd_discretization_free(&fine);
 *     } */
#ifndef GD_DISCRETIZATION_H
#define GD_DISCRETIZATION_H

#include "gd/limit.h"

GD_EXTERN_C_BEGIN

struct gd_discretize_options {
    /* Every edge of the control mesh is divided into 2^level edges. At most 12. At least 1 if a
       Catmull-Clark mesh has polygons other than quads. */
    uint32_t level;
    /* If > 0, `level` is ignored. Each face then gets the level that it needs: the distance between
       triangles and surface is at most `tolerance`. */
    double tolerance;
    uint32_t max_faces; /* largest number of triangles; 0 means 2^28 */
};

/* `polygons` are triangles. The other arrays have one entry for each vertex. */
struct gd_discretization {
    struct gd_polygons polygons;
    /* a vertex on an edge has its place in one of the edge's two faces */
    struct gd_limit_point *places;
    /* Unit normals; on a crease, the normal of one side; 0 where there is no normal. */
    struct gd_vec3 *normals;
};

/* Frees the arrays and zeroes the struct. Accepts NULL and partly built structs. */
void gd_discretization_free(struct gd_discretization *discretization);

/* Triangulates the limit surface. The vertices lie exactly on it, at dyadic (u,v). Cells of quads
 * are divided along the shorter diagonal. Cells of Loop triangles are already triangles. If there
 * is a tolerance, each face has its own level, and an edge has the level of its finer face, so that
 * there are no cracks. The distance between triangles and surface is measured at the vertices of
 * the grid that is two levels finer; for a vertex on a side of a face, it is the distance from the
 * side's chord. The measured distance is not a proven bound. `control` may be NULL. `options` may
 * be NULL, which means level 0. The caller frees `*out` by gd_discretization_free. Errors:
 * GD_INVALID_ARGUMENT (level, tolerance), GD_TOO_LARGE (more than max_faces, or the tolerance needs
 * a level above 10; a tolerance far out of reach fails after a few coarse levels), GD_NO_MEMORY,
 * GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Cost: linear time, about 0.2 us a vertex and 10 us a level
 * for each irregular control face; 120 bytes a vertex. Thread-safe. */
GD_MUST_USE enum gd_status gd_discretize(const struct gd_subdivision *surface,
                                         const struct gd_discretize_options *options,
                                         const struct gd_control *control,
                                         struct gd_discretization *out, struct gd_detail *detail);

GD_EXTERN_C_END

#endif
