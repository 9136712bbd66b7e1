/* Limit shortest: the shortest path between two places of a limit surface. */
#ifndef GD_LIMIT_SHORTEST_H
#define GD_LIMIT_SHORTEST_H

#include "gd/limit_mesh.h"
#include "gd/limit_path.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gd_limit_shortest {
    /* on the limit surface; INFINITY: no path leads there, and there are no steps */
    double distance;
    double mesh_distance;  /* on the mesh, exact */
    double error_estimate; /* of `distance` */
    /* the path is a geodesic of the limit surface; else the mesh's, laid onto it */
    bool relaxed;
    struct gd_limit_step *steps; /* step_count >= 1, from one place to the other */
    uint32_t step_count;
};

/* Frees the steps and zeroes the struct. NULL is harmless. */
void gd_limit_shortest_free(struct gd_limit_shortest *shortest);

/* The shortest path from ends[0] to ends[1]: the exact one on the mesh is looked for, and relaxed
 * onto the limit surface (gd_limit_relax). That is answered unless it does not converge, or is
 * longer than the mesh's path is when its places are joined on the limit surface: this is a curve
 * there, so it bounds the distance from above. Then that curve is the answer, and what it and the
 * mesh's path differ by the estimate of its error, both being of the same order. Where two ways are
 * nearly as short the mesh decides, and the answer may be the longer one by O(4^-level). `control`
 * and `detail` may be NULL; the caller frees `*out`. Errors: those of gd_limit_place_check; of
 * gd_pair_solve; GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE, GD_INTERNAL. Thread-safe.
 * Cost: a search on the mesh, and some ten traces. */
GD_MUST_USE enum gd_status gd_limit_shortest_find(const struct gd_limit_mesh *fine,
                                                  const struct gd_limit_point ends[2],
                                                  const struct gd_control *control,
                                                  struct gd_limit_shortest *out,
                                                  struct gd_detail *detail);

#ifdef __cplusplus
}
#endif

#endif
