#include "tests/support/shared.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

#include "gd/io.h"
#include "tests/support/test.h"

enum { PATH_LENGTH = 4096 };

const char *test_shared_folder(void)
{
    const char *named = getenv("GEODESICD_SHARED"), *folder = named ? named : "../shared";
    struct stat status;
    if (stat(folder, &status) != 0) {
        print_message("# skipped: there is no folder %s\n", folder);
        skip();
    }
    return folder;
}

char *test_shared_file(const char *name, size_t *size)
{
    char path[PATH_LENGTH];
    snprintf(path, sizeof path, "%s/%s", test_shared_folder(), name);
    char *bytes = test_read_file(path, size);
    if (!bytes) fail_msg("%s can't be read", path);
    return bytes;
}

struct gd_polygons test_shared_polygons(const char *name)
{
    char file[PATH_LENGTH];
    size_t size = 0;
    struct gd_polygons polygons = {0};
    struct gd_detail detail = {0};
    snprintf(file, sizeof file, "meshes/%s.obj", name);
    char *bytes = test_shared_file(file, &size);
    check_ok(gd_read_polygons(bytes, size, NULL, &polygons, &detail), &detail);
    free(bytes);
    return polygons;
}

struct gd_mesh *test_shared_mesh(const char *name)
{
    struct gd_polygons polygons = test_shared_polygons(name);
    struct gd_mesh *mesh = NULL;
    struct gd_detail detail = {0};
    check_ok(gd_mesh_build(&polygons, &(struct gd_mesh_options){.repair_split = true}, NULL, &mesh,
                           &detail),
             &detail);
    gd_polygons_free(&polygons);
    return mesh;
}
