/* Limit shortest: the shortest path between two places of a limit surface. */
#ifndef GD_LIMIT_SHORTEST_H
#define GD_LIMIT_SHORTEST_H

#include "gd/limit_mesh.h"
#include "gd/limit_path.h"

GD_EXTERN_C_BEGIN

struct gd_limit_shortest {
    /* distance on the limit surface; INFINITY if there is no path; there are no steps then */
    double distance;
    double mesh_distance;  /* exact distance on the mesh */
    double error_estimate; /* estimated error of `distance` */
    /* true if the path is a geodesic of the limit surface; false if it is the path on the mesh,
       projected onto the limit surface */
    bool relaxed;
    struct gd_limit_step *steps; /* step_count >= 1, from ends[0] to ends[1] */
    uint32_t step_count;
};

/* Frees the steps and zeroes the struct. NULL is allowed. */
void gd_limit_shortest_free(struct gd_limit_shortest *shortest);

/* Computes the shortest path from ends[0] to ends[1]. Computes the exact path on the mesh, and from
 * it a geodesic of the limit surface (gd_limit_relax). If this fails, the result is the mesh's path
 * projected onto the limit surface. The projected path is also the result if the geodesic is longer
 * by more than the error estimate. The length of the projected path is an upper bound of the
 * distance. The error estimate is the difference between this length and mesh_distance, plus the
 * distances by which the mesh path's ends are displaced along the surface. If two paths are nearly
 * equally short, the result is the path that is shorter on the mesh. The result may then be longer
 * than the shortest path by O(4^-level). `control` and `detail` may be NULL; the caller frees
 * `*out` by gd_limit_shortest_free. Errors: those of gd_limit_place_check and gd_pair_solve;
 * GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE, GD_INTERNAL. Cost: a search on the mesh, and
 * about ten traces. Thread-safe. */
GD_MUST_USE enum gd_status gd_limit_shortest_find(const struct gd_limit_mesh *fine,
                                                  const struct gd_limit_point ends[2],
                                                  const struct gd_control *control,
                                                  struct gd_limit_shortest *out,
                                                  struct gd_detail *detail);

GD_EXTERN_C_END

#endif
