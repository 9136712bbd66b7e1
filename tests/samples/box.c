#include "tests/samples/builder.h"
#include "tests/samples/samples.h"
#include "tests/samples/transform.h"

static bool all_solid(const struct sample_voxels *voxels, const uint32_t cell[3])
{
    (void)voxels, (void)cell;
    return true;
}

enum gd_status sample_box(const double size[3], const uint32_t cells[3], struct gd_polygons *out)
{
    struct sample_builder builder = {0};
    sample_add_voxels(&builder, &(struct sample_voxels){{cells[0], cells[1], cells[2]}, all_solid});
    sample_scale(&builder.mesh, size[0] / cells[0], size[1] / cells[1], size[2] / cells[2]);
    return sample_finish(&builder, out);
}
