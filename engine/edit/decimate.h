/* Runs OpenMesh's decimater once. */
#pragma once

#include "gd/edit.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Collapses edges until options->faces are left or no collapse is allowed. `most_distance` is a
 * bound, in the unit box, on the root of the mean squared distance from the planes of the merged
 * faces. INFINITY means no bound. Does not set the result's distance. Errors: GD_NO_MEMORY,
 * GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__decimate(const struct gd_mesh *mesh,
                                        const struct gd_simplify_options *options,
                                        double most_distance, const struct gd_control *control,
                                        struct gd_edited *out);

#ifdef __cplusplus
}
#endif
