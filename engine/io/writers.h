/* Writers: functions that write both meshes and results. */
#pragma once

#include "gd/polygons.h"
#include "gd/result_file.h"
#include "gd/status.h"
#include "io/output.h"

void gd__write_xyz(struct gd__output *output, const double position[3], const char *separator);

/* Writes the mesh as `v` and `f` statements. */
void gd__write_obj(struct gd__output *output, const struct gd_polygons *polygons);

/* Writes the mesh as binary PLY. Unless `distances` is NULL, its vertices have a property
 * `distance`. */
void gd__write_ply(struct gd__output *output, const struct gd_polygons *polygons,
                   const double *distances);

/* Write a result as glTF, as in gd/result_file.h: as binary (GLB), or as JSON with embedded data.
 * Errors: GD_NOT_TRIANGLES, GD_EXTENT, GD_TOO_LARGE, GD_INVALID_ARGUMENT (nothing to write),
 * GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__glb_write(struct gd__output *output, const struct gd_result *result);
GD_MUST_USE enum gd_status gd__gltf_write(struct gd__output *output,
                                          const struct gd_result *result);

/* Moves the bytes to `out`, or frees them if writing failed. Returns `status`, or the error of the
 * output. */
GD_MUST_USE enum gd_status gd__output_finish(struct gd__output *output, enum gd_status status,
                                             char **out, size_t *size);
