#include "tests/fuzz/patched.h"
#include "tests/fuzz/promise.h"

#include <stdlib.h>
#include <string.h>

const struct gd_mesh *patched_surface(void)
{
    static struct gd_mesh *mesh;
    static double positions[9][3] = {{0, 0, 1},       {1, 0, 0},      {0.3, 0.3, 0},
                                     {0, 1, 0},       {-0.3, 0.3, 0}, {-1, 0, 0},
                                     {-0.3, -0.3, 0}, {0, -1, 0},     {0.3, -0.3, 0}};
    static uint32_t corners[] = {0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5,
                                 0, 5, 6, 0, 6, 7, 0, 7, 8, 0, 8, 1};
    struct gd_polygons polygons = {
        .positions = positions, .position_count = 9, .polygon_count = 8, .corners = corners};
    if (!mesh) promise(gd_mesh_build(&polygons, NULL, NULL, &mesh, NULL) == GD_OK);
    return mesh;
}

char *patched_copy(const void *image, size_t length, const uint8_t *data, size_t size, size_t *left)
{
    char *patched = malloc(length);
    promise(patched != NULL);
    memcpy(patched, image, length);
    *left = length - (size && data[0] == 0xff ? data[size - 1] : 0);
    for (; size >= 4; data += 4, size -= 4)
        patched[(data[0] << 16 | data[1] << 8 | data[2]) % length] = (char)data[3];
    return patched;
}
