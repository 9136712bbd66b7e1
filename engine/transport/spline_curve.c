#include <stdlib.h>

#include "gd/spline.h"

/* Moves the points of the line into a curve; a closed curve does not repeat its first point. */
static struct gd_curve spline_curve_take(struct gd_spline_line *line, bool closed)
{
    struct gd_curve curve = {
        .points = line->path.points, .count = line->path.count, .closed = closed};
    while (closed && curve.count > 1 &&
           gd_point_equal(&curve.points[0], &curve.points[curve.count - 1]))
        curve.count--;
    line->path.points = NULL;
    return curve;
}

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
    *out = spline_curve_take(&line, request->closed);
    gd_spline_line_free(&line);
    return GD_OK;
}
