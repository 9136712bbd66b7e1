/* Shared: optional test meshes from other projects, in the folder GEODESICD_SHARED (default:
 * ../shared beside the project). Without the folder a test that uses it prints a line and is
 * skipped. */
#pragma once

#include <stddef.h>

#include "gd/mesh.h"
#include "gd/polygons.h"

/* Returns the folder's path, or skips the running test. */
const char *test_shared_folder(void);

/* Reads a file of the folder. The caller frees the bytes, which end with a NUL. */
char *test_shared_file(const char *name, size_t *size);

/* Reads the polygons of a mesh, unchanged. The caller frees them. */
struct gd_polygons test_shared_polygons(const char *name);

/* Reads a mesh and separates its non-manifold parts. The caller releases it. */
struct gd_mesh *test_shared_mesh(const char *name);
