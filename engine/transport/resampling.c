#include "gd/resampling.h"

#include <stdlib.h>

#include "transport/pieces.h"

void gd_resampling_free(struct gd_resampling *resampling)
{
    if (!resampling) return;
    gd_curve_free(&resampling->curve);
    free(resampling->points);
    *resampling = (struct gd_resampling){0};
}

static enum gd_status resample(struct gd__straightener *s, const struct gd_curve *curve,
                               uint32_t count, struct gd_resampling *out, struct gd_detail *detail)
{
    struct gd__route route = {0}, line = {0};
    uint32_t steps = count - !curve->closed, places = steps + 1;
    double *lengths = malloc(places * sizeof *lengths);
    out->points = malloc(places * sizeof *out->points);
    enum gd_status status = lengths && out->points
                                ? gd__route_of_curve(s->mesh, curve, s->control, &route)
                                : GD_NO_MEMORY;
    if (!status && !(route.length > 0))
        status = gd_fail(detail, GD_INVALID_ARGUMENT,
                         "the curve is a point: it has no length to be divided");
    for (uint32_t i = 0; i < places && !status; i++)
        lengths[i] = i == steps ? INFINITY : route.length * i / steps;
    if (!status) status = gd__pieces_tighten(s, &route, lengths, places, &line, out->points);
    if (!status) {
        out->count = count;
        out->curve = gd__route_take_curve(&line, curve->closed);
    }
    free(lengths);
    gd__route_free(&route);
    gd__route_free(&line);
    return status;
}

enum gd_status gd_curve_resample(const struct gd_mesh *mesh,
                                 const struct gd_resampling_request *request,
                                 const struct gd_control *control, struct gd_resampling *out,
                                 struct gd_detail *detail)
{
    uint32_t count = request->count;
    if (count < 2)
        return gd_fail(detail, GD_INVALID_ARGUMENT, "a curve is resampled by at least two points");
    if (count > GD_RESAMPLING_POINTS)
        return gd_fail(detail, GD_TOO_LARGE, "a curve is resampled by at most %u points",
                       GD_RESAMPLING_POINTS);
    enum gd_status status =
        gd_control_afford(control, (count + (size_t)1) * (sizeof(double) + sizeof *out->points));
    if (status) return status;
    struct gd__straightener straightener = {.mesh = mesh, .control = control};
    struct gd_resampling resampling = {0};
    status = resample(&straightener, request->curve, count, &resampling, detail);
    gd__straightener_free(&straightener);
    if (status)
        gd_resampling_free(&resampling);
    else
        *out = resampling;
    return status;
}
