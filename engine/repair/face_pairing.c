/* Which faces stay together at an edge that belongs to more than two.
 *
 * DESIGN. Where solids touch along an edge, or a wall stands on a plate, a path on a body's skin
 * should stay on that body. Seen along the edge, from its lower to its higher vertex, and going
 * round counter-clockwise: a face that runs forward along the edge has its outside ahead and its
 * inside behind, a backward one the other way about. So the inside of a body reaches from a
 * backward face to the next forward one: these two are its skin, and they stay joined. As brackets
 * are matched: each forward face takes the nearest free backward face before it.
 *
 * Only faces that run in opposite directions are joined, so that no pairing makes a surface
 * one-sided. What is left over, faces that all run alike, is joined to nothing: there each gets a
 * border. */
#include "repair/face_pairing.h"

#include <stdlib.h>

#include "gd/polygons.h"

static struct gd_vec3 normalised(struct gd_vec3 v)
{
    double largest = fmax(fmax(fabs(v.x), fabs(v.y)), fabs(v.z));
    v = (struct gd_vec3){v.x / largest, v.y / largest, v.z / largest};
    return gd_vec3_scale(v, 1 / gd_vec3_length(v));
}

/* Angles from the first edge_face's on, in [0, 2 pi). */
static void measure(struct gd__edge_face *edge_face, uint32_t count, struct gd_vec3 along)
{
    struct gd_vec3 axis = normalised(along), first = normalised(edge_face[0].across);
    for (uint32_t i = 0; i < count; i++) {
        struct gd_vec3 across = normalised(edge_face[i].across);
        double sine = gd_vec3_dot(gd_vec3_cross(first, across), axis);
        double cosine =
            gd_vec3_dot(first, across) - gd_vec3_dot(first, axis) * gd_vec3_dot(across, axis);
        double angle = i == 0 ? 0 : atan2(sine, cosine);
        edge_face[i].angle = angle < 0 ? angle + 2 * M_PI : angle;
    }
}

/* By angle; where faces lie on each other the backward ones come first, so that they enclose
 * nothing. */
static int compare(const void *x, const void *y)
{
    const struct gd__edge_face *a = x, *b = y;
    if (a->angle != b->angle) return a->angle < b->angle ? -1 : 1;
    if (a->forward != b->forward) return a->forward ? 1 : -1;
    return a->side < b->side ? -1 : a->side > b->side;
}

static void join(struct gd__edge_face *a, struct gd__edge_face *b)
{
    a->partner = b->side;
    b->partner = a->side;
}

/* Twice round: what waits at the end is taken from the beginning. */
static void match(struct gd__edge_face *edge_face, uint32_t count)
{
    uint32_t top = GD_NONE; /* of the stack of backward faces that wait, threaded through `below` */
    for (uint64_t i = 0; i < 2 * (uint64_t)count; i++) {
        struct gd__edge_face *s = &edge_face[i % count];
        if (s->partner != GD_NONE) continue;
        if (!s->forward && i < count) {
            s->below = top;
            top = (uint32_t)i;
        } else if (s->forward && top != GD_NONE) {
            join(s, &edge_face[top]);
            top = edge_face[top].below;
        }
    }
}

void gd__edge_faces_pair(struct gd__edge_face *edge_face, uint32_t count, struct gd_vec3 along)
{
    measure(edge_face, count, along);
    for (uint32_t i = 0; i < count; i++) edge_face[i].partner = GD_NONE;
    qsort(edge_face, count, sizeof *edge_face, compare);
    match(edge_face, count);
}
