#include "wavefront/polyline_vertex.h"

static void lay_along_edge(const struct gd_mesh *mesh, struct gd__laid *laid,
                           const struct gd__seed *s)
{
    laid->edge = gd__edge_between(mesh, &s->point, &s->end);
    laid->forward = copysign(1, gd__edge_parameter(mesh, laid->edge, &s->end) -
                                    gd__edge_parameter(mesh, laid->edge, &s->point));
}

void gd__lay_anew(const struct gd__wavefront *front, struct gd__laid *laid, uint32_t seed)
{
    const struct gd__seed *s = &front->seeds[seed];
    laid->seed = seed;
    laid->face = s->face;
    if (s->face != GD_NONE)
        gd__chords(front->mesh, s->face, &s->point, &s->end, laid->chord);
    else
        lay_along_edge(front->mesh, laid, s);
}

/* Keeps what is not ahead, where its ends are so far ahead of a joint. */
static void keep_behind(struct gd__part *part, double first, double last)
{
    if (first <= 0 && last <= 0) return;
    double crossing = first > 0 && last > 0 ? 1 : first / (first - last);
    if (first > 0)
        part->from = part->from > crossing ? part->from : crossing;
    else
        part->to = part->to < crossing ? part->to : crossing;
}

struct gd__part gd__part_behind(const struct gd__spread *spread, struct gd__local origin,
                                struct gd__local destination)
{
    struct gd__part part = {0, 1};
    for (int i = 0; i < 2; i++)
        keep_behind(&part, gd__along(spread->along[i], origin),
                    gd__along(spread->along[i], destination));
    return part;
}
