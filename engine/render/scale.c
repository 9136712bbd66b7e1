#include "render/scale.h"

#include "field/layout.h"

/* upper limit of levels, relative to the range, because the isoline at the largest distance would
 * be a point */
#define BELOW (1 - 1e-9)

struct gd__scale gd__scale_of(double range, uint32_t wanted)
{
    static const double factors[] = {1, 2, 2.5, 5, 10};
    double ideal = range / wanted, power = pow(10, floor(log10(ideal))), best = power;
    for (size_t i = 0; i < sizeof factors / sizeof *factors; i++)
        if (fabs(log(factors[i] * power / ideal)) < fabs(log(best / ideal)))
            best = factors[i] * power;
    return (struct gd__scale){range, best, (uint32_t)(range / best * BELOW)};
}

double gd__field_range(const struct gd_field *field)
{
    const struct gd_mesh *mesh = field->mesh;
    double largest = 0, range;
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        if (field->distance[v] < GD__FAR && field->distance[v] > largest)
            largest = field->distance[v];
    range = largest * mesh->unit;
    if (isfinite(gd_field_reach(field)))
        range = fmin(gd_field_reach(field), range + mesh->summary.edge_length.max);
    return range > 0 && isfinite(range) ? range : 1;
}
