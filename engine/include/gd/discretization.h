/* Discretization: a triangulation with vertices on a limit surface, and the (face, u, v) of each
 * vertex.
 *
 *     struct gd_discretization fine;
 *     const struct gd_discretize_options options = {.level = 5};
 *     if (gd_discretize(surface, &options, NULL, &fine, NULL) == GD_OK) {
 *         ...gd_mesh_create(&fine.polygons, ...)...
 *         gd_discretization_free(&fine);
 *     } */
#ifndef GD_DISCRETIZATION_H
#define GD_DISCRETIZATION_H

#include "gd/limit.h"

GD_EXTERN_C_BEGIN

struct gd_discretize_options {
    /* Every edge of the control mesh becomes 2^level edges. At least 1 if the mesh has polygons
       that are not quads (Loop: triangles), at most 12. */
    uint32_t level;
    /* > 0: replaces `level` by the largest distance between triangles and surface; each face gets
       the level that it needs */
    double tolerance;
    uint32_t max_faces; /* largest number of triangles; 0 means 2^28 */
};

/* `polygons` are triangles. The other arrays have one entry for each vertex. */
struct gd_discretization {
    struct gd_polygons polygons;
    /* for a vertex on an edge: its place in one of the edge's two faces */
    struct gd_limit_point *places;
    /* Unit normals. On a crease: the normal of one side. 0 where no normal exists. */
    struct gd_vec3 *normals;
};

/* Frees the arrays and zeroes the struct. Accepts NULL and partly built structs. */
void gd_discretization_free(struct gd_discretization *discretization);

/* Triangulates the limit surface. The vertices lie exactly on it, at dyadic (u,v). Cells of quads
 * are divided along the shorter diagonal; cells of Loop triangles are triangles already. With a
 * tolerance each face has its own level, and an edge has the level of its finer face, so that there
 * are no cracks. The distance between triangles and surface is measured at sample points two levels
 * finer and on the chords of edges; it is not a proven bound. `options` and `control` may be NULL
 * (level 0); the caller frees `*out` by gd_discretization_free. Errors: GD_INVALID_ARGUMENT (level,
 * tolerance), GD_TOO_LARGE (over max_faces, or the tolerance needs more than level 12),
 * GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Cost: linear time, about 0.2 us a vertex and
 * 10 us a level for each irregular control face; 120 bytes a vertex. Thread-safe. */
GD_MUST_USE enum gd_status gd_discretize(const struct gd_subdivision *surface,
                                         const struct gd_discretize_options *options,
                                         const struct gd_control *control,
                                         struct gd_discretization *out, struct gd_detail *detail);

GD_EXTERN_C_END

#endif
