#include "wavefront/polyline_vertex.h"

void gd__segment_place(const struct gd__wavefront *front, struct gd__placed_segment *placed,
                       uint32_t seed)
{
    const struct gd_mesh *mesh = front->mesh;
    const struct gd__seed *s = &front->seeds[seed];
    placed->seed = seed;
    placed->face = s->face;
    if (s->face != GD_NONE) {
        gd__chords(mesh, s->face, &s->point, &s->end, placed->chord);
        return;
    }
    placed->edge = gd__edge_between(mesh, &s->point, &s->end);
    placed->forward = copysign(1, gd__edge_parameter(mesh, placed->edge, &s->end) -
                                      gd__edge_parameter(mesh, placed->edge, &s->point));
}

/* Removes the part of the side that is not behind the joint with respect to one segment. `first`
 * and `last` are the positions of the side's ends relative to the joint, along the direction of the
 * segment. */
static void keep_behind(struct gd__part *part, double first, double last)
{
    if (first <= 0 && last <= 0) return;
    double crossing = first > 0 && last > 0 ? 1 : first / (first - last);
    if (first > 0)
        part->from = part->from > crossing ? part->from : crossing;
    else
        part->to = part->to < crossing ? part->to : crossing;
}

struct gd__part gd__part_behind(const struct gd__segment_directions *directions,
                                struct gd__local origin, struct gd__local destination)
{
    struct gd__part part = {0, 1};
    for (int i = 0; i < 2; i++)
        keep_behind(&part, gd__local_dot(directions->along[i], origin),
                    gd__local_dot(directions->along[i], destination));
    return part;
}
