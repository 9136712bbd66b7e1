#include "transport/polygon.h"

void gd__polygon_free(struct gd__polygon *polygon)
{
    for (int k = 0; k < 3; k++) gd__route_free(&polygon->arms[k]);
    *polygon = (struct gd__polygon){0};
}

/* The state of de Casteljau's construction. */
struct construction {
    struct gd__straightener *straightener;
    double part;
    struct gd__route route; /* scratch memory for the line to be straightened next */
};

/* Divides a line at the fraction c->part of its length, and replaces `before` and `behind` by the
 * two parts. */
static enum gd_status polygon_cut(const struct construction *c, const struct gd__route *line,
                                  struct gd__route *before, struct gd__route *behind)
{
    const struct gd_control *control = c->straightener->control;
    struct gd__route whole = {0};
    uint32_t at;
    enum gd_status status =
        gd__route_join(&whole, line->points, line->count, line->length, false, control);
    if (!status) status = gd__route_split(c->straightener->mesh, &whole, c->part, control, &at);
    gd__route_clear(before);
    gd__route_clear(behind);
    if (!status)
        status =
            gd__route_join(before, whole.points, at + 1, c->part * line->length, false, control);
    if (!status)
        status = gd__route_join(behind, whole.points + at, whole.count - at,
                                (1 - c->part) * line->length, false, control);
    gd__route_free(&whole);
    return status;
}

/* Straightens two joined lines, from the beginning of the first to the end of the second. */
static enum gd_status pull(struct construction *c, const struct gd__route *first,
                           const struct gd__route *second, struct gd__route *out)
{
    const struct gd_control *control = c->straightener->control;
    gd__route_clear(&c->route);
    enum gd_status status =
        gd__route_join(&c->route, first->points, first->count, 0, false, control);
    if (!status)
        status = gd__route_join(&c->route, second->points, second->count, 0, false, control);
    return status ? status : gd__straighten(c->straightener, &c->route, out);
}

enum gd_status gd__polygon_divide(struct gd__straightener *straightener,
                                  const struct gd__polygon *polygon, double part,
                                  struct gd__polygon *left, struct gd__polygon *right,
                                  double *touching)
{
    struct construction c = {straightener, part, {0}};
    struct gd__route inner[2] = {0}, second[2] = {0}, third = {0};
    double at = polygon->begin + part * (polygon->end - polygon->begin);
    left->begin = polygon->begin, left->end = right->begin = at, right->end = polygon->end;
    enum gd_status status = polygon_cut(&c, &polygon->arms[0], &left->arms[0], &third);
    if (!status) status = polygon_cut(&c, &polygon->arms[1], &inner[0], &inner[1]);
    if (!status) status = pull(&c, &third, &inner[0], &second[0]);
    if (!status) status = polygon_cut(&c, &polygon->arms[2], &third, &right->arms[2]);
    if (!status) status = pull(&c, &inner[1], &third, &second[1]);
    if (!status) status = polygon_cut(&c, &second[0], &left->arms[1], &inner[0]);
    if (!status) status = polygon_cut(&c, &second[1], &inner[1], &right->arms[1]);
    if (!status) status = pull(&c, &inner[0], &inner[1], &third);
    if (!status) status = polygon_cut(&c, &third, &left->arms[2], &right->arms[0]);
    if (!status) *touching = third.length;
    for (int k = 0; k < 2; k++) {
        gd__route_free(&inner[k]);
        gd__route_free(&second[k]);
    }
    gd__route_free(&third);
    gd__route_free(&c.route);
    return status;
}

enum gd_status gd__polygon_join(const struct gd__polygon *polygon, bool backwards,
                                struct gd__route *out, const struct gd_control *control)
{
    enum gd_status status = GD_OK;
    for (int k = 0; k < 3 && !status; k++) {
        const struct gd__route *arm = &polygon->arms[backwards ? 2 - k : k];
        status = gd__route_join(out, arm->points, arm->count, arm->length, backwards, control);
    }
    return status;
}

enum gd_status gd__polygon_chord(struct gd__straightener *straightener,
                                 const struct gd__polygon *polygon, struct gd__route *scratch,
                                 struct gd__route *out)
{
    gd__route_clear(scratch);
    enum gd_status status = gd__polygon_join(polygon, false, scratch, straightener->control);
    return status ? status : gd__straighten(straightener, scratch, out);
}
