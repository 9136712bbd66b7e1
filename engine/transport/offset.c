#include "gd/offset.h"

#include <stdlib.h>

#include "base/tolerance.h"

enum gd_status gd_curve_offset(const struct gd_mesh *mesh, const struct gd_offset_request *offset,
                               const struct gd_control *control, struct gd_isoline *out,
                               struct gd_detail *detail)
{
    const struct gd_curve *curve = offset->curve;
    double distance = offset->distance;
    if (!(isfinite(distance) && distance > 0))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the distance is %.17g; it must be a length, more than 0", distance);
    struct gd_field_request request = {.seed_count = gd_curve_seed_count(curve),
                                       .radius = distance * (1 + GD_TOL_CHECK)};
    struct gd_field *field;
    enum gd_status status = gd_control_afford(control, request.seed_count * sizeof(struct gd_seed));
    if (status) return status;
    struct gd_seed *seeds = malloc(request.seed_count * sizeof *seeds);
    if (!seeds) return GD_NO_MEMORY;
    gd_curve_seeds(curve, 0, seeds);
    request.seeds = seeds;
    status = gd_field_build(mesh, &request, control, &field, detail);
    free(seeds);
    if (status) return status;
    status = gd_isoline_trace(field, distance, control, out);
    gd_field_release(field);
    return status;
}
