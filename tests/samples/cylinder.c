#include <math.h>

#include "tests/samples/builder.h"
#include "tests/samples/samples.h"

enum gd_status sample_cylinder(double radius, double height, uint32_t sides, uint32_t rings,
                               struct gd_polygons *out)
{
    struct sample_builder builder = {0};
    for (uint32_t ring = 0; ring <= rings; ring++) {
        for (uint32_t side = 0; side < sides; side++) {
            double u = 2 * M_PI * side / sides;
            sample_add_vertex(&builder, radius * cos(u), radius * sin(u), height * ring / rings);
        }
    }
    sample_add_lattice(&builder, (struct sample_lattice){
                                     .columns = sides, .rows = rings + 1, .wrap_columns = true});
    return sample_finish(&builder, out);
}
