#include <stdlib.h>

#include "base/array.h"
#include "gd/spline.h"
#include "line/turn.h"
#include "transport/polygon.h"

/* --- sampler ---------------------------------------------------------------------------------- */

/* Sampler: walks along a spline, leaf by leaf. A leaf is a control polygon that is almost
 * straight. */
struct sampler {
    const struct gd_mesh *mesh;
    const struct gd_spline *spline;
    struct gd__straightener straightener;
    /* progress before the walk, and the walk's part of the whole progress */
    double progress, share;
    /* largest distance of a leaf from its chord; if 0, it is a fixed fraction of the length of the
       segment's polygon */
    double height;
    bool is_whole; /* true if each segment is one leaf */
    /* Called for each leaf in order, with its chord. */
    enum gd_status (*visit)(struct sampler *sampler, const struct gd__polygon *leaf,
                            const struct gd__route *chord);
    void *user;
    struct gd__route route, line; /* scratch */
};

/* Largest number of halvings. After far fewer halvings, a length is smaller than rounding
 * errors. */
enum { DEPTH = 32 };

/* Flatness of a leaf: its largest distance from its chord, relative to the length of the polygon of
 * its segment. In a leaf, the point for any parameter is computed by one construction of de
 * Casteljau, without further halvings. Further halvings would change this point by about the square
 * of this value, times the surface's curvature. */
#define HEIGHT_PART 1e-3

static void sampler_free(struct sampler *sampler)
{
    gd__straightener_free(&sampler->straightener);
    gd__route_free(&sampler->route);
    gd__route_free(&sampler->line);
}

static enum gd_status sampler_walk(struct sampler *sampler, const struct gd__polygon *polygon,
                                   double height, int depth);

static enum gd_status halve(struct sampler *sampler, const struct gd__polygon *polygon,
                            double height, int depth)
{
    struct gd__polygon left = {0}, right = {0};
    double touching;
    enum gd_status status =
        gd__polygon_divide(&sampler->straightener, polygon, 0.5, &left, &right, &touching);
    if (!status) status = sampler_walk(sampler, &left, height, depth + 1);
    if (!status) status = sampler_walk(sampler, &right, height, depth + 1);
    gd__polygon_free(&left);
    gd__polygon_free(&right);
    return status;
}

static enum gd_status sampler_walk(struct sampler *sampler, const struct gd__polygon *polygon,
                                   double height, int depth)
{
    struct gd__route chord = {0};
    const struct gd_spline *spline = sampler->spline;
    struct gd__straightener *straightener = &sampler->straightener;
    straightener->progress = sampler->progress + sampler->share * polygon->begin /
                                                     spline->knots[spline->count].parameter;
    enum gd_status status = gd_control_check(straightener->control, straightener->progress);
    if (!status) status = gd__polygon_chord(straightener, polygon, &sampler->route, &chord);
    if (!status && depth < DEPTH && !sampler->is_whole &&
        gd__polygon_height(gd__polygon_length(polygon), chord.length) > height)
        status = halve(sampler, polygon, height, depth);
    else if (!status)
        status = sampler->visit(sampler, polygon, &chord);
    gd__route_free(&chord);
    return status;
}

static enum gd_status walk_segment(struct sampler *sampler, const struct gd_spline_segment *segment)
{
    struct gd__polygon polygon = {.begin = segment->begin, .end = segment->end};
    enum gd_status status = GD_OK;
    for (int k = 0; k < 3 && !status; k++)
        status = gd__route_join(&polygon.arms[k], segment->arms[k].points, segment->arms[k].count,
                                segment->arms[k].length / sampler->mesh->unit, false,
                                sampler->straightener.control);
    double height =
        sampler->height > 0 ? sampler->height : HEIGHT_PART * gd__polygon_length(&polygon);
    if (!status) status = sampler_walk(sampler, &polygon, height, 0);
    gd__polygon_free(&polygon);
    return status;
}

/* Walks the whole spline. Errors: those of the visitor and of gd__straighten. */
static enum gd_status sampler_walk_all(struct sampler *sampler)
{
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < sampler->spline->count && !status; i++)
        status = walk_segment(sampler, &sampler->spline->segments[i]);
    return status;
}

/* --- spacing ---------------------------------------------------------------------------------- */

/* Spacing: computes the parameters at which a spline is sampled. */

/* A growing array of parameters. An all-zero struct is empty. */
struct parameters {
    double *values; /* owned, ascending */
    uint32_t count, capacity;
    double step; /* arc length of a step, in the mesh's unit; 0 if the steps differ */
};

enum { BISECTIONS = 60 };

static enum gd_status refuse_number(struct gd_detail *detail)
{
    return gd_fail(detail, GD_TOO_LARGE, "the curve would have more than %u samples; request fewer",
                   GD_SPLINE_PLACES);
}

static enum gd_status spacing_reserve(struct parameters *list, double count,
                                      const struct gd_control *control, struct gd_detail *detail)
{
    if (count > GD_SPLINE_PLACES) return refuse_number(detail);
    return gd__array_extend(&list->values, &list->capacity, (uint64_t)count, sizeof *list->values,
                            control);
}

static enum gd_status spacing_add(struct parameters *list, double value,
                                  const struct gd_control *control, struct gd_detail *detail)
{
    enum gd_status status = spacing_reserve(list, (double)list->count + 1, control, detail);
    if (!status) list->values[list->count++] = value;
    return status;
}

/* --- equal steps of the parameter ------------------------------------------------------------- */

static enum gd_status find_steps(const struct sampler *sampler, uint32_t per_segment,
                                 struct parameters *out, struct gd_detail *detail)
{
    const struct gd_spline *spline = sampler->spline;
    enum gd_status status = spacing_reserve(out, (double)per_segment * spline->count + 1,
                                            sampler->straightener.control, detail);
    if (status) return status;
    for (uint32_t i = 0; i < spline->count; i++) {
        double begin = spline->segments[i].begin, span = spline->segments[i].end - begin;
        for (uint32_t k = 0; k < per_segment; k++)
            out->values[out->count++] = begin + span * k / per_segment;
    }
    out->values[out->count++] = spline->knots[spline->count].parameter;
    return GD_OK;
}

/* --- by tolerance ----------------------------------------------------------------------------- */

struct collecting {
    struct parameters *list;
    struct gd_detail *detail;
};

static enum gd_status collect_end(struct sampler *sampler, const struct gd__polygon *leaf,
                                  const struct gd__route *chord)
{
    (void)chord;
    const struct collecting *collecting = sampler->user;
    return spacing_add(collecting->list, leaf->end, sampler->straightener.control,
                       collecting->detail);
}

static enum gd_status find_leaves(struct sampler *sampler, struct parameters *out,
                                  struct gd_detail *detail)
{
    struct collecting collecting = {out, detail};
    enum gd_status status = spacing_add(out, sampler->spline->knots[0].parameter,
                                        sampler->straightener.control, detail);
    if (status) return status;
    sampler->user = &collecting;
    sampler->visit = collect_end;
    return sampler_walk_all(sampler);
}

/* --- by arc length ---------------------------------------------------------------------------- */

/* A leaf of the subdivision. The struct describes the arc length in the leaf as a function of the
 * parameter. This function is nearly cubic, and the speeds at both ends are known. The length of
 * the leaf is estimated by the mean of the lengths of its chord and its polygon (J. Gravesen's
 * estimate for cubics, with an error of fourth order). */
struct stretch {
    double begin, end; /* parameters */
    double length, first_speed, last_speed;
};

struct measuring {
    struct stretch *stretches;
    uint32_t count, capacity;
    struct gd_detail *detail;
};

static enum gd_status measure_leaf(struct sampler *sampler, const struct gd__polygon *leaf,
                                   const struct gd__route *chord)
{
    struct measuring *measuring = sampler->user;
    if (measuring->count == GD_SPLINE_PLACES) return refuse_number(measuring->detail);
    enum gd_status status =
        gd__array_extend(&measuring->stretches, &measuring->capacity, measuring->count + 1ULL,
                         sizeof *measuring->stretches, sampler->straightener.control);
    if (status) return status;
    measuring->stretches[measuring->count++] =
        (struct stretch){.begin = leaf->begin,
                         .end = leaf->end,
                         .length = 0.5 * (gd__polygon_length(leaf) + chord->length),
                         .first_speed = 3 * leaf->arms[0].length,
                         .last_speed = 3 * leaf->arms[2].length};
    return GD_OK;
}

static double length_at(const struct stretch *s, double t)
{
    return t * (s->first_speed * (1 - t) * (1 - t) +
                t * (s->length * (3 - 2 * t) - s->last_speed * (1 - t)));
}

static double parameter_at(const struct stretch *s, double length)
{
    double low = 0, high = 1;
    for (int i = 0; i < BISECTIONS; i++) {
        double middle = 0.5 * (low + high);
        if (length_at(s, middle) < length)
            low = middle;
        else
            high = middle;
    }
    return s->begin + low * (s->end - s->begin);
}

/* Computes the parameters of `count` steps of equal arc length. If `count` is 0, chooses the number
 * of steps so that their length is near `spacing`. */
static enum gd_status put_lengths(const struct measuring *measuring, uint32_t count, double spacing,
                                  struct parameters *out, const struct gd_control *control)
{
    const struct stretch *s = measuring->stretches, *last = s + measuring->count - 1;
    double total = 0, gone = 0;
    for (size_t i = 0; i < measuring->count; i++) total += s[i].length;
    double steps = count ? count : fmax(1, round(total / spacing));
    out->step = total / steps;
    enum gd_status status = spacing_reserve(out, steps + 1, control, measuring->detail);
    if (status) return status;
    for (uint32_t k = 0; k < steps; k++) {
        double target = total * k / steps;
        for (; s < last && gone + s->length < target; s++) gone += s->length;
        out->values[out->count++] = parameter_at(s, target - gone);
    }
    out->values[out->count++] = last->end;
    return GD_OK;
}

static enum gd_status find_lengths(struct sampler *sampler, uint32_t count, double spacing,
                                   struct parameters *out, struct gd_detail *detail)
{
    struct measuring measuring = {.detail = detail};
    sampler->user = &measuring;
    sampler->visit = measure_leaf;
    enum gd_status status = sampler_walk_all(sampler);
    if (!status)
        status = put_lengths(&measuring, count, spacing, out, sampler->straightener.control);
    free(measuring.stretches);
    return status;
}

/* --- given parameters ------------------------------------------------------------------------- */

static enum gd_status spacing_copy_given(const struct sampler *sampler,
                                         const struct gd_spline_sampling *sampling,
                                         struct parameters *out, struct gd_detail *detail)
{
    double last = sampler->spline->knots[sampler->spline->count].parameter, least = 0;
    enum gd_status status =
        spacing_reserve(out, sampling->count, sampler->straightener.control, detail);
    for (uint32_t i = 0; i < sampling->count && !status; i++) {
        double value = sampling->parameters[i];
        if (!(value >= least && value <= last))
            return gd_fail(
                detail, GD_INVALID_ARGUMENT,
                "parameter %u is %.17g; parameters ascend, and run from 0 to %.17g on this curve",
                i, value, last);
        out->values[out->count++] = least = value;
    }
    return status;
}

/* Computes the parameters of a sampling. Sets the sampler's visitor and height, so the caller must
 * set its own visitor afterwards. The caller frees `out` also on failure. Errors: GD_TOO_LARGE, and
 * those of sampler_walk_all. */
static enum gd_status spacing_find(struct sampler *sampler,
                                   const struct gd_spline_sampling *sampling,
                                   struct parameters *out, struct gd_detail *detail)
{
    double unit = sampler->mesh->unit;
    sampler->height = sampling->tolerance / unit;
    if (sampling->parameters) return spacing_copy_given(sampler, sampling, out, detail);
    if (sampling->per_segment) return find_steps(sampler, sampling->per_segment, out, detail);
    if (sampling->tolerance > 0) return find_leaves(sampler, out, detail);
    return find_lengths(sampler, sampling->even, sampling->spacing / unit, out, detail);
}

/* A sampling in progress. */
struct sampling {
    struct sampler sampler;
    struct parameters parameters;
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

static enum gd_status visit(struct sampler *sampler, const struct gd__polygon *leaf,
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
    enum gd_status status = spacing_find(&s->sampler, sampling, &s->parameters, detail);
    if (!status)
        status = gd_control_afford(s->sampler.straightener.control,
                                   s->parameters.count * sizeof *s->places);
    if (status) return status;
    s->places = malloc(s->parameters.count * sizeof *s->places);
    if (!s->places) return GD_NO_MEMORY;
    s->sampler.visit = visit;
    s->sampler.progress = 0.5;
    s->sampler.is_whole = sampling->evaluation == GD_SPLINE_DE_CASTELJAU;
    return sampler_walk_all(&s->sampler);
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
    sampler_free(&s.sampler);
    return status;
}
