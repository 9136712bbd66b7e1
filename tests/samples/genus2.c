#include <math.h>
#include <stdlib.h>

#include "tests/samples/builder.h"
#include "tests/samples/samples.h"
#include "tests/samples/transform.h"

/* Returns whether a cell is solid. Of the 5 x 3 x 1 blocks, (1,1) and (3,1) are holes. */
static bool is_slab(const struct sample_voxels *voxels, const uint32_t cell[3])
{
    uint32_t block = voxels->size[2], column = cell[0] / block, row = cell[1] / block;
    return row != 1 || column % 2 == 0;
}

/* Moves each vertex halfway to the mean of its neighbours. `sum` is scratch memory with one element
 * for each vertex. */
static void smooth(struct gd_polygons *mesh, double (*sum)[4])
{
    for (uint32_t v = 0; v < mesh->position_count; v++)
        sum[v][0] = sum[v][1] = sum[v][2] = sum[v][3] = 0;
    for (uint32_t slot = 0; slot < 3 * mesh->polygon_count; slot++) {
        double *into = sum[mesh->corners[slot]];
        const double *from = mesh->positions[mesh->corners[slot % 3 == 2 ? slot - 2 : slot + 1]];
        for (int k = 0; k < 3; k++) into[k] += from[k];
        into[3] += 1;
    }
    for (uint32_t v = 0; v < mesh->position_count; v++)
        for (int k = 0; k < 3; k++)
            mesh->positions[v][k] = 0.5 * (mesh->positions[v][k] + sum[v][k] / sum[v][3]);
}

/* Displaces the surface by waves of amplitude `bump` in space. The waves do not tear the
 * surface. */
static void wave(struct gd_polygons *mesh, double bump)
{
    for (uint32_t v = 0; v < mesh->position_count; v++) {
        double *p = mesh->positions[v], x = p[0], y = p[1], z = p[2];
        p[0] += bump * sin(9 * y + 4 * z);
        p[1] += bump * sin(8 * x + 5 * z);
        p[2] += bump * sin(7 * x) * cos(9 * y);
    }
}

enum gd_status sample_genus2(uint32_t cells, double bump, struct gd_polygons *out)
{
    struct sample_builder builder = {0};
    sample_add_voxels(&builder, &(struct sample_voxels){{5 * cells, 3 * cells, cells}, is_slab});
    struct gd_polygons *mesh = &builder.mesh;
    double(*sum)[4] = malloc((mesh->position_count + 1) * sizeof *sum);
    if (!sum) builder.failed = true;
    if (!builder.failed) {
        for (uint32_t pass = 0; pass < cells; pass++) smooth(mesh, sum);
        sample_scale(mesh, 0.2 / cells, 0.2 / cells, 0.2 / cells);
        wave(mesh, bump);
    }
    free(sum);
    return sample_finish(&builder, out);
}
