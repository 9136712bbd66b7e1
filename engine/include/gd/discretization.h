/* Discretization: triangles whose vertices lie on a limit surface and remember where.
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

#ifdef __cplusplus
extern "C" {
#endif

struct gd_discretize_options {
    /* every edge of the control mesh becomes 2^level; from 1 on where it has polygons that are no
       quads (Loop: no triangles), at most 12 */
    uint32_t level;
    /* > 0: instead of `level`, so fine in every face that the triangles are this near to the
       surface */
    double tolerance;
    uint32_t max_faces; /* most triangles; 0: 2^28 */
};

/* Arrays of one item a vertex of `polygons`, which are triangles. */
struct gd_discretization {
    struct gd_polygons polygons;
    struct gd_limit_point *places; /* vertices on edges: in any of the faces */
    /* of unit length; on a crease that of one side; 0 where there is none */
    struct gd_vec3 *normals;
};

/* Frees the arrays and zeroes the struct. NULL and half-built ones are harmless. */
void gd_discretization_free(struct gd_discretization *discretization);

/* Triangles over the limit surface whose vertices lie on it exactly, at dyadic places: of a quad's
 * cells along the shorter diagonal, of a Loop triangle's cells as they are. With a tolerance each
 * face has its own level and neighbours are joined without cracks: an edge is as fine as the finer
 * face beside it. How near the triangles are is measured, not proven: at points two levels finer,
 * across the surface, and from edges' chords. `options` and `control` may be NULL (level 0); the
 * caller frees `*out`. Errors: GD_INVALID_ARGUMENT (level, tolerance), GD_TOO_LARGE (over
 * max_faces, or the tolerance asks for more than level 12), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED,
 * GD_DEADLINE. Linear time, some 0.2 us a vertex, and for each control face that isn't regular some
 * 10 us a level. 120 bytes a vertex. Thread-safe. */
GD_MUST_USE enum gd_status gd_discretize(const struct gd_subdivision *surface,
                                         const struct gd_discretize_options *options,
                                         const struct gd_control *control,
                                         struct gd_discretization *out, struct gd_detail *detail);

#ifdef __cplusplus
}
#endif

#endif
