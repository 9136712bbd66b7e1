/* The C++ part of test_edit_mesh.c. Each function returns the first violated law, or NULL if all
 * laws hold. */
#pragma once

#include "gd/edit.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Checks the copy of a mesh against a mesh that OpenMesh builds from its polygons by add_face. */
const char *edit_mesh_check_copy(const struct gd_mesh *mesh, const struct gd_polygons *polygons);

/* Keeps every third face, deletes the others, and checks the remaining faces. */
const char *edit_mesh_check_rest(const struct gd_mesh *mesh, const struct gd_polygons *polygons);

/* Runs many copies. Each copy is cancelled at another check of the control. */
const char *edit_mesh_check_stop(const struct gd_mesh *mesh);

/* Throws each kind of exception through gd_edit::guarded. */
const char *edit_mesh_check_guard(void);

#ifdef __cplusplus
}
#endif
