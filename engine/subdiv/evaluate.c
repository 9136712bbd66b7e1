#include "gd/limit.h"

#include <math.h>

#include "subdiv/walker.h"

static const struct gd_vec3 nowhere = {NAN, NAN, NAN};

/* Computes the principal curvatures from the first and second fundamental forms; NaN without a
 * normal. */
static void curvatures(const struct gd__jet *jet, struct gd_vec3 normal, double out[2])
{
    double e = gd_vec3_dot(jet->s, jet->s), f = gd_vec3_dot(jet->s, jet->t),
           g = gd_vec3_dot(jet->t, jet->t);
    double l = gd_vec3_dot(jet->ss, normal), m = gd_vec3_dot(jet->st, normal),
           n = gd_vec3_dot(jet->tt, normal);
    double area = e * g - f * f, mean = (e * n - 2 * f * m + g * l) / (2 * area),
           gauss = (l * n - m * m) / area;
    double spread = sqrt(fmax(mean * mean - gauss, 0));
    out[0] = mean - spread;
    out[1] = mean + spread;
}

static struct gd_limit_jet jet_of_vertex(const struct gd__vertex *vertex,
                                         const struct gd__chart *frame)
{
    struct gd__jet jet = {.s = vertex->s, .t = vertex->t};
    /* the axes of the chart are replaced by axes of length 1, so that the tangents keep their
       lengths */
    struct gd__chart turn = *frame;
    for (int i = 0; i < 2; i++) {
        turn.s[i] = (turn.s[i] > 0) - (turn.s[i] < 0);
        turn.t[i] = (turn.t[i] > 0) - (turn.t[i] < 0);
    }
    jet = gd__chart_jet(&turn, &jet);
    /* at a spike, a derivative can be zero: then the direction does not exist */
    if (!(gd_vec3_length(jet.s) > 0)) jet.s = nowhere;
    if (!(gd_vec3_length(jet.t) > 0)) jet.t = nowhere;
    return (struct gd_limit_jet){.position = vertex->position,
                                 .normal = vertex->normal,
                                 .du = jet.s,
                                 .dv = jet.t,
                                 .curvatures = {NAN, NAN},
                                 .singular = true};
}

/* Returns the chart whose axes run along the two edges at a corner, as the vertex' tangents do.
 * These are the face's own axes, rotated from corner 0 to corner `corner`. */
static struct gd__chart corner_frame(const struct gd_subdivision *surface,
                                     const struct gd__chart *base, uint32_t corner)
{
    return gd__chart_child(base, &surface->rules->children[corner]);
}

static struct gd_limit_jet evaluate_vertex(struct gd__walker *walker, uint32_t face,
                                           uint32_t corner, const struct gd__chart *frame)
{
    struct gd__vertex vertex;
    gd__corner_limit(walker, face, corner, &vertex);
    struct gd__chart at = corner_frame(walker->surface, frame, corner);
    return jet_of_vertex(&vertex, &at);
}

static struct gd_limit_jet limit_jet_at(struct gd__walker *walker,
                                        const struct gd_limit_point *place)
{
    uint32_t face, piece_corner, corner;
    struct gd__face_place local = gd__face_place_of(walker->surface, place);
    struct gd__chart frame = gd__base_frame(walker->surface, local.face, &face, &piece_corner);
    if (!gd__cell_at(walker, &local, 0, 0, &corner))
        return evaluate_vertex(walker, local.face, corner, &frame);
    struct gd__jet jet = gd__cell_jet(walker, local.s, local.t);
    jet = gd__chart_jet(&frame, &jet);
    struct gd_vec3 normal = gd_vec3_cross(jet.s, jet.t);
    double area = gd_vec3_length(normal);
    normal = area > 0 && area < INFINITY ? gd_vec3_scale(normal, 1 / area) : nowhere;
    struct gd_limit_jet out = {.position = jet.p,
                               .normal = normal,
                               .du = jet.s,
                               .dv = jet.t,
                               .duu = jet.ss,
                               .duv = jet.st,
                               .dvv = jet.tt};
    curvatures(&jet, normal, out.curvatures);
    return out;
}

enum gd_status gd_limit_evaluate_many(const struct gd_subdivision *surface,
                                      const struct gd_limit_places *places,
                                      const struct gd_control *control, struct gd_limit_jet *out,
                                      struct gd_detail *detail)
{
    size_t count = places->count;
    struct gd__walker walker;
    enum gd_status status = gd__walker_create(&walker, surface, 3, control);
    if (status) return status;
    for (size_t i = 0; !status && i < count; i++) {
        struct gd_limit_point place = places->items[i];
        if (i % 64 == 0) status = gd_control_check(control, (double)i / (double)count);
        if (!status) status = gd__place_check(surface, &place, detail);
        if (!status) out[i] = limit_jet_at(&walker, &place);
    }
    gd__walker_free(&walker);
    return status;
}

enum gd_status gd_limit_evaluate(const struct gd_subdivision *surface,
                                 const struct gd_limit_point *place, struct gd_limit_jet *out,
                                 struct gd_detail *detail)
{
    struct gd_limit_jet jet;
    enum gd_status status =
        gd_limit_evaluate_many(surface, &(struct gd_limit_places){place, 1}, NULL, &jet, detail);
    if (!status) *out = jet;
    return status;
}
