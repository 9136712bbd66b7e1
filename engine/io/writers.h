/* Writers: what meshes and results are both written by. */
#ifndef GD_IO_WRITERS_H
#define GD_IO_WRITERS_H

#include "gd/polygons.h"
#include "gd/status.h"
#include "io/output.h"

void gd__write_xyz(struct gd__output *output, const double position[3], const char *separator);

/* The mesh as `v` and `f` statements. */
void gd__write_obj(struct gd__output *output, const struct gd_polygons *polygons);

/* The mesh as binary PLY, with `distance` as a property of its vertices unless `distances` is
 * NULL. */
void gd__write_ply(struct gd__output *output, const struct gd_polygons *polygons,
                   const double *distances);

/* Hands over what was written without failure, else frees it. `status`, or GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__output_finish(struct gd__output *output, enum gd_status status,
                                             char **out, size_t *size);

#endif
