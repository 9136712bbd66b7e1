#include "tests/samples/builder.h"
#include "tests/samples/samples.h"

enum gd_status sample_grid(uint32_t columns, uint32_t rows, double width, double height,
                           struct gd_polygons *out)
{
    struct sample_builder builder = {0};
    for (uint32_t row = 0; row <= rows; row++)
        for (uint32_t column = 0; column <= columns; column++)
            sample_add_vertex(&builder, width * column / columns, height * row / rows, 0);
    sample_add_lattice(&builder, (struct sample_lattice){.columns = columns + 1, .rows = rows + 1});
    return sample_finish(&builder, out);
}
