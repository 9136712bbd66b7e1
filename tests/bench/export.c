/* gd_bench export: writes a mesh in a form that every solver accepts: an OBJ file of oriented
 * triangles without unreferenced vertices. */
#include <stdio.h>
#include <stdlib.h>

#include "gd/io.h"
#include "tests/bench/bench.h"

/* Removes the vertices that no face uses; the others keep their order. */
static void drop_unreferenced(struct gd_polygons *triangles)
{
    uint32_t corners = 3 * triangles->polygon_count, count = 0;
    uint32_t *to = bench_allocate(sizeof *to * triangles->position_count);
    for (uint32_t i = 0; i < triangles->position_count; i++) to[i] = GD_NONE;
    for (uint32_t i = 0; i < corners; i++) to[triangles->corners[i]] = 0;
    for (uint32_t i = 0; i < triangles->position_count; i++) {
        if (to[i] == GD_NONE) continue;
        for (int k = 0; k < 3; k++) triangles->positions[count][k] = triangles->positions[i][k];
        to[i] = count++;
    }
    for (uint32_t i = 0; i < corners; i++) triangles->corners[i] = to[triangles->corners[i]];
    triangles->position_count = count;
    free(to);
}

static bool write_mesh(const struct gd_mesh *mesh)
{
    struct gd_polygons triangles;
    char *text = NULL;
    size_t size = 0;
    bench_require(gd_mesh_polygons(mesh, &triangles), NULL);
    drop_unreferenced(&triangles);
    bench_require(gd_write_polygons(&triangles, GD_FORMAT_OBJ, &text, &size), NULL);
    gd_polygons_free(&triangles);
    bool written = fwrite(text, 1, size, stdout) == size && fflush(stdout) == 0;
    if (!written) perror("gd_bench");
    free(text);
    return written;
}

int bench_export(char **arguments)
{
    struct bench_options options = {.runs = 1};
    if (!bench_take_options(&arguments, &options)) return BENCH_USAGE;
    struct gd_mesh *mesh = bench_open(*arguments, &options);
    if (!mesh) return EXIT_FAILURE;
    bool written = write_mesh(mesh);
    gd_mesh_release(mesh);
    return written ? EXIT_SUCCESS : EXIT_FAILURE;
}
