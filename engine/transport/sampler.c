#include "transport/sampler.h"

/* Largest number of halvings. After far fewer halvings, a length is smaller than rounding
 * errors. */
enum { DEPTH = 32 };

/* Flatness of a leaf: its largest distance from its chord, relative to the length of the polygon of
 * its segment. In a leaf, the point for any parameter is computed by one construction of de
 * Casteljau, without further halvings. Further halvings would change this point by about the square
 * of this value, times the surface's curvature. */
#define HEIGHT_PART 1e-3

void gd__sampler_free(struct gd__sampler *sampler)
{
    gd__straightener_free(&sampler->straightener);
    gd__route_free(&sampler->route);
    gd__route_free(&sampler->line);
}

static enum gd_status sampler_walk(struct gd__sampler *sampler, const struct gd__polygon *polygon,
                                   double height, int depth);

static enum gd_status halve(struct gd__sampler *sampler, const struct gd__polygon *polygon,
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

static enum gd_status sampler_walk(struct gd__sampler *sampler, const struct gd__polygon *polygon,
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

static enum gd_status walk_segment(struct gd__sampler *sampler,
                                   const struct gd_spline_segment *segment)
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

enum gd_status gd__sampler_walk(struct gd__sampler *sampler)
{
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < sampler->spline->count && !status; i++)
        status = walk_segment(sampler, &sampler->spline->segments[i]);
    return status;
}
