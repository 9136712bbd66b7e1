#include <math.h>

#include "tests/samples/builder.h"
#include "tests/samples/samples.h"
#include "tests/samples/transform.h"

enum gd_status sample_tetrahedron(double edge, uint32_t level, struct gd_polygons *out)
{
    static const int corners[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    static const uint32_t faces[4][3] = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
    struct sample_builder builder = {0};
    double s = edge / sqrt(8);
    for (int i = 0; i < 4; i++)
        sample_add_vertex(&builder, s * corners[i][0], s * corners[i][1], s * corners[i][2]);
    for (int f = 0; f < 4; f++)
        sample_add_triangle(&builder, faces[f][0], faces[f][1], faces[f][2]);
    struct gd_polygons mesh;
    enum gd_status status = sample_finish(&builder, &mesh);
    if (status != GD_OK) return status;
    for (uint32_t i = 0; i < level && status == GD_OK; i++) status = sample_subdivide(&mesh);
    if (status == GD_OK)
        *out = mesh;
    else
        gd_polygons_free(&mesh);
    return status;
}
