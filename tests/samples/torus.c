#include <math.h>

#include "tests/samples/builder.h"
#include "tests/samples/samples.h"

enum gd_status sample_torus(uint32_t columns, uint32_t rows, double major, double minor,
                            struct gd_polygons *out)
{
    struct sample_builder builder = {0};
    for (uint32_t row = 0; row < rows; row++) {
        double v = 2 * M_PI * row / rows, reach = major + minor * cos(v);
        for (uint32_t column = 0; column < columns; column++) {
            double u = 2 * M_PI * column / columns;
            sample_add_vertex(&builder, reach * cos(u), reach * sin(u), minor * sin(v));
        }
    }
    sample_add_lattice(
        &builder, (struct sample_lattice){
                      .columns = columns, .rows = rows, .wrap_columns = true, .wrap_rows = true});
    return sample_finish(&builder, out);
}
