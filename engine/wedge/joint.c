#include "wedge/joint.h"

const struct gd__laid *gd__lay(const struct gd__wavefront *front, struct gd__laying *laying, uint32_t seed)
{
    struct gd__laid *laid = &laying->last[seed / 2 % 2];
    const struct gd__seed *s = &front->seeds[seed];
    if (laid->seed == seed) return laid;
    laid->seed = seed;
    laid->home = (struct gd__home){GD_NONE, GD_NONE};
    if (gd__segment_home(front->mesh, &s->point, &s->end, &laid->home) && laid->home.face != GD_NONE)
        gd__chords(front->mesh, laid->home.face, &s->point, &s->end, laid->chord);
    return laid;
}

static bool is_laid(const struct gd__laid *laid)
{
    return laid->home.edge != GD_NONE || laid->home.face != GD_NONE;
}

struct gd__joint gd__joint_of(const struct gd__wavefront *front, struct gd__laying *laying, uint32_t seed)
{
    const struct gd__seed *at = &front->seeds[seed];
    struct gd__joint joint = {.count = 0};
    for (uint32_t i = seed ? seed - 1 : 1; i <= seed + 1 && i < front->seed_count; i += 2) {
        const struct gd__seed *s = &front->seeds[i];
        if (!s->is_segment || s->offset != at->offset) continue;
        bool goes = gd_point_equal(&s->point, &at->point);
        if (!goes && !gd_point_equal(&s->end, &at->point)) continue;
        joint.turned[joint.count] = goes ? 1 : -1;
        joint.segment[joint.count] = gd__lay(front, laying, i);
        joint.count += is_laid(joint.segment[joint.count]);
    }
    return joint;
}

struct gd__spread gd__spread_in_face(const struct gd__joint *joint, int k)
{
    struct gd__spread spread = {.count = joint->count};
    for (int i = 0; i < joint->count; i++)
        spread.along[i] = gd__turned(joint->segment[i]->chord[k].along, joint->turned[i]);
    return spread;
}

static struct gd__local direction_from_edge(const struct gd__wavefront *front, uint32_t side,
                                            const struct gd__laid *laid)
{
    const struct gd_mesh *mesh = front->mesh;
    const struct gd__seed *s = &front->seeds[laid->seed];
    if (laid->home.edge != GD_NONE) {
        uint32_t edge = laid->home.edge;
        double x = gd__edge_parameter(mesh, edge, &s->end) - gd__edge_parameter(mesh, edge, &s->point);
        return (struct gd__local){copysign(1, side & 1 ? -x : x), 0};
    }
    const uint32_t *sides = mesh->face_side[laid->home.face];
    int k = gd__place_of_edge(sides, side >> 1);
    return gd__turned(laid->chord[k].along, 1 - 2 * (double)(sides[k] != side));
}

struct gd__spread gd__spread_from_edge(const struct gd__wavefront *front, const struct gd__joint *joint, uint32_t side)
{
    struct gd__spread spread = {.count = joint->count};
    for (int i = 0; i < joint->count; i++)
        spread.along[i] = gd__turned(direction_from_edge(front, side, joint->segment[i]), joint->turned[i]);
    return spread;
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

struct gd__part gd__part_behind(const struct gd__spread *spread, struct gd__local origin, struct gd__local destination)
{
    struct gd__part part = {0, 1};
    for (int i = 0; i < spread->count; i++)
        keep_behind(&part, gd__along(spread->along[i], origin), gd__along(spread->along[i], destination));
    return part;
}
