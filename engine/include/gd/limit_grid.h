/* Limit grid: the vertices of a limit mesh (gd/limit_mesh.h) without its topology. It serves to
 * trace lines. Building a grid takes a fraction of the time and memory of the mesh.
 *
 *     struct gd_limit_grid *grid;
 *     if (gd_limit_grid_build(surface, &options, NULL, &grid, &detail) == GD_OK) {
 *         struct gd_limit_grid_request request = {.start = place, .direction = v, .length = 2};
 *         gd_limit_grid_trace(grid, &request, NULL, &path, &detail);
 *         gd_limit_grid_free(grid);
 *     }
 *
 * A trace computes the triangles that it crosses from the vertices of the grid. Up to rounding, its
 * line is the one that gd_trace_follow computes on the limit mesh of the same level. A grid is
 * immutable: any number of threads may read it. */
#ifndef GD_LIMIT_GRID_H
#define GD_LIMIT_GRID_H

#include "gd/limit_mesh.h"
#include "gd/limit_path.h"
#include "gd/trace.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gd_limit_grid;

/* Returns an upper bound of the bytes that are needed to build the grid of a level. level <=
 * GD_LIMIT_LEVEL_MOST. */
size_t gd_limit_grid_cost(const struct gd_subdivision *surface, uint32_t level);

/* Builds the grid of a level. The caller frees `*out` by gd_limit_grid_free; `*out` keeps the
 * surface alive. `control` and `detail` may be NULL. Errors: GD_INVALID_ARGUMENT (the level),
 * GD_TOO_LARGE, GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Cost: about 0.1 us a vertex.
 * Thread-safe. */
GD_MUST_USE enum gd_status gd_limit_grid_build(const struct gd_subdivision *surface,
                                               const struct gd_limit_mesh_options *options,
                                               const struct gd_control *control,
                                               struct gd_limit_grid **out,
                                               struct gd_detail *detail);
void gd_limit_grid_free(struct gd_limit_grid *grid); /* NULL is allowed */
size_t gd_limit_grid_memsize(const struct gd_limit_grid *grid);
uint32_t gd_limit_grid_level(const struct gd_limit_grid *grid);

struct gd_limit_grid_request {
    struct gd_limit_point start;
    struct gd_vec3 direction; /* projected onto the surface as by gd_direction_along */
    double length;            /* >= 0 */
    enum gd_vertex_rule vertex_rule;
    uint32_t step_limit; /* largest number of points after the first; 0 means GD_LIMIT_STEPS */
};

/* Traces a straightest geodesic on the triangles of the grid. The positions of the path's steps lie
 * on the triangles. Some cases need the mesh, and the path then has no steps: the line begins at
 * the boundary, meets the boundary at a small angle or at a vertex, ends at a vertex, or crosses a
 * triangle without area. `control` and `detail` may be NULL; the caller frees `*out` by
 * gd_limit_path_free. Errors: those of gd_limit_place_check and gd_direction_along;
 * GD_INVALID_ARGUMENT (length not finite), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE.
 * Cost: about 0.2 us for each crossed triangle. Thread-safe. */
GD_MUST_USE enum gd_status gd_limit_grid_trace(const struct gd_limit_grid *grid,
                                               const struct gd_limit_grid_request *request,
                                               const struct gd_control *control,
                                               struct gd_limit_path *out, struct gd_detail *detail);

#ifdef __cplusplus
}
#endif

#endif
