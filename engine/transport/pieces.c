#include "transport/pieces.h"

enum gd_status gd__route_of_curve(const struct gd_mesh *mesh, const struct gd_curve *curve,
                                  const struct gd_control *control, struct gd__route *out)
{
    enum gd_status status = gd__route_add(out, &curve->points[0], 0, control);
    for (uint32_t i = 1; i < curve->count + curve->closed && !status; i++) {
        const struct gd_point *point = &curve->points[i % curve->count];
        status = gd__route_add(out, point, gd__route_run(mesh, &out->points[out->count - 1], point),
                               control);
    }
    return status;
}

struct gd_curve gd__route_take_curve(struct gd__route *route, bool closed)
{
    struct gd_curve curve = {.points = route->points, .count = route->count, .closed = closed};
    while (closed && curve.count > 1 &&
           gd_point_equal(&curve.points[0], &curve.points[curve.count - 1]))
        curve.count--;
    *route = (struct gd__route){0};
    return curve;
}

/* The state of a walk along a route that is being divided at given lengths. */
struct walk {
    const struct gd__route *route;
    uint32_t at;          /* the last point passed */
    struct gd_point here; /* the current point */
    double gone;          /* length walked up to `at` */
};

/* Replaces `out` by the part of the route from the current position to a given length. */
static enum gd_status walk_to(struct gd__straightener *s, struct walk *walk, double length,
                              struct gd__route *out)
{
    const struct gd_mesh *mesh = s->mesh;
    gd__route_clear(out);
    enum gd_status status = gd__route_add(out, &walk->here, 0, s->control);
    while (!status && walk->at + 1 < walk->route->count) {
        const struct gd_point *from = &walk->route->points[walk->at], *to = from + 1;
        double run = gd__route_run(mesh, from, to);
        if (walk->gone + run > length) {
            double part = run > 0 ? fmax(length - walk->gone, 0) / run : 0;
            walk->here = gd__route_between(mesh, from, to, part);
            return gd__route_add(out, &walk->here, 0, s->control);
        }
        walk->gone += run;
        walk->here = *to;
        walk->at++;
        status = gd__route_add(out, to, 0, s->control);
    }
    return status;
}

enum gd_status gd__pieces_tighten(struct gd__straightener *s, const struct gd__route *route,
                                  const double *lengths, uint32_t count, struct gd__route *out,
                                  struct gd_point *marks)
{
    struct walk walk = {.route = route, .here = route->points[0]};
    struct gd__route piece = {0}, line = {0};
    enum gd_status status = GD_OK;
    gd__route_clear(out);
    for (uint32_t i = 0; i < count && !status; i++) {
        bool is_last = i + 1 == count && lengths[i] >= route->length;
        status = walk_to(s, &walk, is_last ? INFINITY : lengths[i], &piece);
        if (!status && i) status = gd__straighten(s, &piece, &line);
        if (!status && i)
            status = gd__route_join(out, line.points, line.count, line.length, false, s->control);
        if (!status && marks) marks[i] = walk.here;
        if (!status) status = gd_control_check(s->control, s->progress);
    }
    gd__route_free(&piece);
    gd__route_free(&line);
    return status;
}
