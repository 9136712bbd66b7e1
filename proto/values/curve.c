#include "proto/values/curve.h"

void proto_located_curve_free(struct proto_located_curve *located)
{
    proto_located_points_free(&located->points);
    proto_located_spline_free(&located->spline);
    *located = (struct proto_located_curve){0};
}

bool proto_curve_locate(const struct gd_mesh *mesh, const struct proto_curve *curve,
                        struct proto_located_curve *out, struct proto_problem *problem)
{
    static const enum gd_curve_kind kinds[] = {[PROTO_CURVE_POINTS] = GD_CURVE_POINTS,
                                               [PROTO_CURVE_VERTICES] = GD_CURVE_VERTICES,
                                               [PROTO_CURVE_BOUNDARY] = GD_CURVE_BOUNDARY};
    struct proto_located_curve located = {.curve = curve};
    if (curve->form == PROTO_CURVE_SPLINE) {
        if (!proto_spline_locate(mesh, &curve->spline, &located.spline, problem)) return false;
        *out = located;
        return true;
    }
    if (curve->form == PROTO_CURVE_POINTS &&
        !proto_points_locate(mesh, &curve->points, &located.points, problem))
        return false;
    located.request = (struct gd_curve_request){
        .kind = kinds[curve->form],
        .closed = curve->closed || curve->form == PROTO_CURVE_BOUNDARY,
        .points = located.points.points,
        .vertices = (const struct gd_vertex *)curve->vertices.items,
        .count = located.points.count + curve->vertices.count, /* one of them is 0 */
        .boundary = curve->boundary};
    *out = located;
    return true;
}

enum gd_status proto_curve_resolve(const struct gd_mesh *mesh,
                                   const struct proto_located_curve *located,
                                   const struct gd_landmarks *landmarks,
                                   const struct gd_control *control, struct gd_curve *out,
                                   struct gd_detail *detail)
{
    if (located->curve->form != PROTO_CURVE_SPLINE) {
        struct gd_curve_request request = located->request;
        request.landmarks = landmarks;
        return gd_curve_resolve(mesh, &request, control, out, detail);
    }
    struct gd_spline_request request = located->spline.request;
    request.landmarks = landmarks;
    request.sampling = &located->spline.sampling;
    return gd_spline_curve(mesh, &request, control, out, detail);
}

bool proto_curve_fail(const struct proto_located_curve *located, enum gd_status status,
                      struct gd_detail *detail, struct proto_problem *problem)
{
    const struct proto_curve *curve = located->curve;
    if (curve->form == PROTO_CURVE_SPLINE)
        return proto_spline_fail(curve->spline.place, status, detail, problem);
    proto_problem_from_status(problem, status, detail);
    if (detail->text[0]) proto_problem_at(problem, curve->place);
    return false;
}
