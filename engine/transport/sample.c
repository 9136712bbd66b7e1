#include <stdlib.h>

#include "transport/spacing.h"
#include "line/turn.h"

/* A sampling in progress. */
struct sampling {
    struct gd__sampler sampler;
    struct gd__parameters parameters;
    struct gd_spline_place *places;
    uint32_t count; /* number of places so far */
    struct gd__route path;
    /* the polyline from the last sampled place to the beginning of the current leaf */
    struct gd__route pending;
    bool is_at_end; /* true if the polyline so far ends at the last sampled place */
};

void gd_spline_line_free(struct gd_spline_line *line)
{
    if (!line) return;
    gd_path_free(&line->path);
    free(line->places);
    *line = (struct gd_spline_line){0};
}

/* --- one sampled place ------------------------------------------------------------------------ */

/* Computes the direction of the curve at the beginning (side 0) or the end (side 1) of a polygon.
 * Leaves *found false if the polygon has the length 0. */
static enum gd_status direction_at(const struct gd_mesh *mesh, const struct gd__polygon *polygon,
                                   int side, bool *found, struct gd_direction *out)
{
    double turn;
    for (int k = 0; k < 3 && !*found; k++) {
        const struct gd__route *arm = &polygon->arms[side ? 2 - k : k];
        if (arm->count < 2) continue;
        const struct gd_point *at = &arm->points[side ? arm->count - 1 : 0];
        enum gd_status status = side ? gd__route_back(mesh, arm->points, arm->count, &turn)
                                     : gd__route_ahead(mesh, arm->points, arm->count, &turn);
        if (status) return status;
        struct gd_direction way = gd__turn_direction(mesh, at, turn);
        *out = side ? gd_direction_opposite(mesh, at, &way) : way;
        *found = true;
    }
    return GD_OK;
}

/* Appends the place where the two parts of a leaf meet. */
static enum gd_status sample_describe(struct sampling *s, const struct gd__polygon *left,
                                      const struct gd__polygon *right, double parameter,
                                      double speed)
{
    const struct gd_mesh *mesh = s->sampler.mesh;
    const struct gd__route *end = &left->arms[2];
    struct gd_spline_place place = {.parameter = parameter, .speed = speed};
    bool found = false;
    place.point = end->count ? end->points[end->count - 1] : right->arms[0].points[0];
    enum gd_status status = direction_at(mesh, right, 0, &found, &place.tangent);
    if (!status) status = direction_at(mesh, left, 1, &found, &place.tangent);
    if (!found) place.tangent = gd_trace_fan(mesh, &place.point, 1, 0);
    if (!status) s->places[s->count++] = place;
    return status;
}

/* --- the polyline ----------------------------------------------------------------------------- */

/* Extends the polyline from the last place to the next place. The next place is the end of `left`,
 * the first part of the current leaf. */
static enum gd_status sample_reach(struct sampling *s, const struct gd__polygon *left,
                                   const struct gd_point *point)
{
    const struct gd_control *control = s->sampler.straightener.control;
    struct gd__route *line = &s->sampler.line;
    if (!s->path.count) return gd__route_add(&s->path, point, 0, control);
    enum gd_status status = gd__polygon_join(left, false, &s->pending, control);
    if (!status) status = gd__straighten(&s->sampler.straightener, &s->pending, line);
    if (!status)
        status = gd__route_join(&s->path, line->points, line->count, line->length, false, control);
    return status;
}

static enum gd_status sample_put(struct sampling *s, const struct gd__polygon *left,
                                 const struct gd__polygon *right, double parameter, double speed)
{
    enum gd_status status = sample_describe(s, left, right, parameter, speed);
    if (!status) status = sample_reach(s, left, &s->places[s->count - 1].point);
    if (!status) s->places[s->count - 1].along = s->path.length * s->sampler.mesh->unit;
    gd__route_clear(&s->pending);
    if (!status)
        status = gd__route_add(&s->pending, &s->places[s->count - 1].point, 0,
                               s->sampler.straightener.control);
    if (!status)
        status = gd__polygon_join(left, true, &s->pending, s->sampler.straightener.control);
    return status;
}

static enum gd_status put_place(struct sampling *s, const struct gd__polygon *leaf,
                                double parameter)
{
    static const struct gd__polygon none = {0};
    struct gd__polygon left = {0}, right = {0};
    double span = leaf->end - leaf->begin, part = (parameter - leaf->begin) / span, touching,
           scale = 3 * s->sampler.mesh->unit / span;
    s->is_at_end = !(part < 1);
    if (!(part > 0)) return sample_put(s, &none, leaf, parameter, leaf->arms[0].length * scale);
    if (s->is_at_end) return sample_put(s, leaf, &none, parameter, leaf->arms[2].length * scale);
    enum gd_status status =
        gd__polygon_divide(&s->sampler.straightener, leaf, part, &left, &right, &touching);
    if (!status) status = sample_put(s, &left, &right, parameter, touching * scale);
    gd__polygon_free(&left);
    gd__polygon_free(&right);
    return status;
}

static enum gd_status visit(struct gd__sampler *sampler, const struct gd__polygon *leaf,
                            const struct gd__route *chord)
{
    struct sampling *s = (struct sampling *)sampler;
    const struct gd_control *control = sampler->straightener.control;
    enum gd_status status = GD_OK;
    s->is_at_end = false;
    while (!status && s->count < s->parameters.count && s->parameters.values[s->count] <= leaf->end)
        status = put_place(s, leaf, s->parameters.values[s->count]);
    if (status || !s->path.count) return status;
    if (!s->is_at_end)
        return gd__route_join(&s->pending, chord->points, chord->count, 0, false, control);
    gd__route_clear(&s->pending);
    return gd__route_add(&s->pending, &s->places[s->count - 1].point, 0, control);
}

/* --- public call ------------------------------------------------------------------------------ */

static enum gd_status sample_check(const struct gd_spline_sampling *sampling,
                                   struct gd_detail *detail)
{
    int ways = (sampling->per_segment != 0) + (sampling->even != 0) + (sampling->tolerance != 0) +
               (sampling->spacing != 0) + (sampling->parameters != NULL);
    if (ways != 1)
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "give exactly one of samples, tolerance, spacing and parameters, with a "
                       "value other than 0");
    if (!(isfinite(sampling->tolerance) && sampling->tolerance >= 0 &&
          isfinite(sampling->spacing) && sampling->spacing >= 0))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "tolerance and spacing must be finite lengths greater than 0");
    if (sampling->evaluation == GD_SPLINE_DE_CASTELJAU && !sampling->per_segment &&
        !sampling->parameters)
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "de Casteljau's algorithm needs given parameters or equal steps of the "
                       "parameter; use samples or parameters");
    if (sampling->parameters && !sampling->count)
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the list of parameters is empty; give at least one parameter");
    return GD_OK;
}

static enum gd_status sample_all(struct sampling *s, const struct gd_spline_sampling *sampling,
                                 struct gd_detail *detail)
{
    enum gd_status status = gd__spacing_find(&s->sampler, sampling, &s->parameters, detail);
    if (!status)
        status = gd_control_afford(s->sampler.straightener.control,
                                   s->parameters.count * sizeof *s->places);
    if (status) return status;
    s->places = malloc(s->parameters.count * sizeof *s->places);
    if (!s->places) return GD_NO_MEMORY;
    s->sampler.visit = visit;
    s->sampler.progress = 0.5;
    s->sampler.is_whole = sampling->evaluation == GD_SPLINE_DE_CASTELJAU;
    return gd__sampler_walk(&s->sampler);
}

enum gd_status gd_spline_sample(const struct gd_mesh *mesh,
                                const struct gd_spline_sampling *sampling,
                                const struct gd_control *control, struct gd_spline_line *out,
                                struct gd_detail *detail)
{
    struct sampling s = {.sampler = {.mesh = mesh,
                                     .spline = sampling->spline,
                                     .share = 0.5,
                                     .straightener = {.mesh = mesh, .control = control}}};
    enum gd_status status = sample_check(sampling, detail);
    if (!status) status = sample_all(&s, sampling, detail);
    if (!status && s.count < s.parameters.count) status = GD_INTERNAL;
    if (!status)
        *out = (struct gd_spline_line){gd__route_take(mesh, &s.path), s.places, s.count,
                                       s.parameters.step * mesh->unit};
    else
        free(s.places);
    free(s.parameters.values);
    gd__route_free(&s.path);
    gd__route_free(&s.pending);
    gd__sampler_free(&s.sampler);
    return status;
}
