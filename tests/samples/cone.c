#include <math.h>

#include "tests/samples/builder.h"
#include "tests/samples/samples.h"

/* Makes a fan whose corners are alternately at z = +amplitude and z = -amplitude. The vertices of
 * the outermost ring are first, and the apex is last. */
static enum gd_status make_fan(double radius, double apex, double amplitude, uint32_t sectors,
                               uint32_t rings, struct gd_polygons *out)
{
    struct sample_builder builder = {0};
    for (uint32_t ring = rings; ring > 0; ring--) {
        double s = (double)ring / rings;
        for (uint32_t sector = 0; sector < sectors; sector++) {
            double u = 2 * M_PI * sector / sectors, z = sector % 2 ? -amplitude : amplitude;
            sample_add_vertex(&builder, s * radius * cos(u), s * radius * sin(u),
                              apex + s * (z - apex));
        }
    }
    sample_add_lattice(
        &builder, (struct sample_lattice){.columns = sectors, .rows = rings, .wrap_columns = true});
    uint32_t top = sample_add_vertex(&builder, 0, 0, apex), inner = (rings - 1) * sectors;
    for (uint32_t sector = 0; sector < sectors; sector++)
        sample_add_triangle(&builder, inner + sector, inner + (sector + 1) % sectors, top);
    return sample_finish(&builder, out);
}

enum gd_status sample_cone(double radius, double height, uint32_t sectors, uint32_t rings,
                           struct gd_polygons *out)
{
    return make_fan(radius, height, 0, sectors, rings, out);
}

enum gd_status sample_saddle(double radius, double amplitude, uint32_t sectors, uint32_t rings,
                             struct gd_polygons *out)
{
    if (sectors % 2) return GD_INVALID_ARGUMENT;
    return make_fan(radius, 0, amplitude, sectors, rings, out);
}
