#include "gd/spline.h"
#include "transport/pieces.h"

enum gd_status gd_spline_curve(const struct gd_mesh *mesh, const struct gd_spline_request *request,
                               const struct gd_control *control, struct gd_curve *out,
                               struct gd_detail *detail)
{
    struct gd_spline spline;
    struct gd_spline_sampling sampling = *request->sampling;
    struct gd_spline_line line;
    enum gd_status status = gd_spline_build(mesh, request, control, &spline, detail);
    if (status) return status;
    sampling.spline = &spline;
    status = gd_spline_sample(mesh, &sampling, control, &line, detail);
    gd_spline_free(&spline);
    if (status) return status;
    struct gd__route route = {.points = line.path.points, .count = line.path.count};
    line.path.points = NULL;
    *out = gd__route_take_curve(&route, request->closed);
    gd_spline_line_free(&line);
    return GD_OK;
}
