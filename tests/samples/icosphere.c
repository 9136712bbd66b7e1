#include <math.h>

#include "tests/samples/builder.h"
#include "tests/samples/samples.h"
#include "tests/samples/transform.h"

static enum gd_status make_icosahedron(struct gd_polygons *out)
{
    static const uint32_t faces[20][3] = {
        {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
        {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
        {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    struct sample_builder builder = {0};
    double golden = 0.5 * (1 + sqrt(5));
    for (int rectangle = 0; rectangle < 3; rectangle++) {
        for (int corner = 0; corner < 4; corner++) {
            double p[3] = {corner % 2 ? 1 : -1, corner / 2 ? -golden : golden, 0};
            sample_add_vertex(&builder, p[(3 - rectangle) % 3], p[(4 - rectangle) % 3],
                              p[(5 - rectangle) % 3]);
        }
    }
    for (int f = 0; f < 20; f++)
        sample_add_triangle(&builder, faces[f][0], faces[f][1], faces[f][2]);
    return sample_finish(&builder, out);
}

static void project(struct gd_polygons *mesh, double radius)
{
    for (uint32_t i = 0; i < mesh->position_count; i++) {
        double *p = mesh->positions[i],
               factor = radius / sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        for (int k = 0; k < 3; k++) p[k] *= factor;
    }
}

enum gd_status sample_icosphere(uint32_t level, double radius, struct gd_polygons *out)
{
    struct gd_polygons mesh;
    enum gd_status status = make_icosahedron(&mesh);
    if (status != GD_OK) return status;
    project(&mesh, radius);
    for (uint32_t i = 0; i < level && status == GD_OK; i++) {
        status = sample_subdivide(&mesh);
        project(&mesh, radius);
    }
    if (status == GD_OK)
        *out = mesh;
    else
        gd_polygons_free(&mesh);
    return status;
}
