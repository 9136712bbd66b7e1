/* Writes a result as glTF: one scene of one node, as binary (GLB) or as JSON with embedded data.
 * The contents are described in gd/result_file.h. */
#ifndef GD_IO_GLTF_WRITE_H
#define GD_IO_GLTF_WRITE_H

#include "gd/result_file.h"
#include "io/output.h"

/* Write a result. Errors: GD_NOT_TRIANGLES, GD_NON_FINITE, GD_TOO_LARGE, GD_INVALID_ARGUMENT
 * (nothing to write). The output reports missing memory. */
GD_MUST_USE enum gd_status gd__glb_write(struct gd__output *output, const struct gd_result *result);
GD_MUST_USE enum gd_status gd__gltf_write(struct gd__output *output,
                                          const struct gd_result *result);

#endif
