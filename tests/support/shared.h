/* Shared: meshes that no one here made, where they are at hand: the folder named by
 * GEODESICD_SHARED, or ../shared beside the project. A test that asks for one is skipped where
 * there is no such folder, with a line that says so. */
#ifndef TESTS_SUPPORT_SHARED_H
#define TESTS_SUPPORT_SHARED_H

#include <stddef.h>

#include "gd/mesh.h"
#include "gd/polygons.h"

/* The folder's path. */
const char *test_shared_folder(void);

/* A file of the folder, as test_read_file has it; the caller frees it. */
char *test_shared_file(const char *name, size_t *size);

/* The mesh of that name, as it was made; the caller frees the polygons. */
struct gd_polygons test_shared_polygons(const char *name);

/* The same built, and cut apart where it is no surface; the caller releases it. */
struct gd_mesh *test_shared_mesh(const char *name);

#endif
