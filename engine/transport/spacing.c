#include "transport/spacing.h"

#include "base/array.h"

enum { BISECTIONS = 60 };

static enum gd_status refuse_number(struct gd_detail *detail)
{
    return gd_fail(detail, GD_TOO_LARGE, "the curve would have more than %u samples; request fewer",
                   GD_SPLINE_PLACES);
}

static enum gd_status spacing_reserve(struct gd__parameters *list, double count,
                                      const struct gd_control *control, struct gd_detail *detail)
{
    if (count > GD_SPLINE_PLACES) return refuse_number(detail);
    return gd__array_extend(&list->values, &list->capacity, (uint64_t)count, sizeof *list->values,
                            control);
}

static enum gd_status spacing_add(struct gd__parameters *list, double value,
                                  const struct gd_control *control, struct gd_detail *detail)
{
    enum gd_status status = spacing_reserve(list, (double)list->count + 1, control, detail);
    if (!status) list->values[list->count++] = value;
    return status;
}

/* --- equal steps of the parameter ------------------------------------------------------------- */

static enum gd_status find_steps(const struct gd__sampler *sampler, uint32_t per_segment,
                                 struct gd__parameters *out, struct gd_detail *detail)
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
    struct gd__parameters *list;
    struct gd_detail *detail;
};

static enum gd_status collect_end(struct gd__sampler *sampler, const struct gd__polygon *leaf,
                                  const struct gd__route *chord)
{
    (void)chord;
    const struct collecting *collecting = sampler->user;
    return spacing_add(collecting->list, leaf->end, sampler->straightener.control,
                       collecting->detail);
}

static enum gd_status find_leaves(struct gd__sampler *sampler, struct gd__parameters *out,
                                  struct gd_detail *detail)
{
    struct collecting collecting = {out, detail};
    enum gd_status status = spacing_add(out, sampler->spline->knots[0].parameter,
                                        sampler->straightener.control, detail);
    if (status) return status;
    sampler->user = &collecting;
    sampler->visit = collect_end;
    return gd__sampler_walk(sampler);
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

static enum gd_status measure_leaf(struct gd__sampler *sampler, const struct gd__polygon *leaf,
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
                                  struct gd__parameters *out, const struct gd_control *control)
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

static enum gd_status find_lengths(struct gd__sampler *sampler, uint32_t count, double spacing,
                                   struct gd__parameters *out, struct gd_detail *detail)
{
    struct measuring measuring = {.detail = detail};
    sampler->user = &measuring;
    sampler->visit = measure_leaf;
    enum gd_status status = gd__sampler_walk(sampler);
    if (!status)
        status = put_lengths(&measuring, count, spacing, out, sampler->straightener.control);
    free(measuring.stretches);
    return status;
}

/* --- given parameters ------------------------------------------------------------------------- */

static enum gd_status spacing_copy_given(const struct gd__sampler *sampler,
                                         const struct gd_spline_sampling *sampling,
                                         struct gd__parameters *out, struct gd_detail *detail)
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

enum gd_status gd__spacing_find(struct gd__sampler *sampler,
                                const struct gd_spline_sampling *sampling,
                                struct gd__parameters *out, struct gd_detail *detail)
{
    double unit = sampler->mesh->unit;
    sampler->height = sampling->tolerance / unit;
    if (sampling->parameters) return spacing_copy_given(sampler, sampling, out, detail);
    if (sampling->per_segment) return find_steps(sampler, sampling->per_segment, out, detail);
    if (sampling->tolerance > 0) return find_leaves(sampler, out, detail);
    return find_lengths(sampler, sampling->even, sampling->spacing / unit, out, detail);
}
