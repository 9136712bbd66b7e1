/* Decides which faces stay joined at an edge of more than two faces.
 *
 * DESIGN. Where solids touch along an edge, or a wall stands on a plate, a path on the surface of a
 * body should stay on that body. Look along the edge from its lower to its higher vertex, and go
 * round it counter-clockwise. A face that runs forward along the edge has the outside of its body
 * ahead and the inside behind; a backward face has the inside ahead. So the inside of a body
 * extends from a backward face to the next forward face. These two faces bound the same body, and
 * they stay joined. The pairs are found as matching brackets: each forward face takes the nearest
 * free backward face before it.
 *
 * Only faces that run in opposite directions are joined, so no pair makes a surface one-sided.
 * The remaining faces all run in the same direction. Each of them gets a border. */
#include "repair/face_pairing.h"

#include <stdlib.h>

#include "gd/polygons.h"

/* Computes the angles of the faces, measured from the first face, in [0, 2 pi). */
static void face_pairing_measure(struct gd__edge_face *edge_face, uint32_t count,
                                 struct gd_vec3 along)
{
    struct gd_vec3 axis = gd_vec3_unit(along), first = gd_vec3_unit(edge_face[0].across);
    for (uint32_t i = 0; i < count; i++) {
        struct gd_vec3 across = gd_vec3_unit(edge_face[i].across);
        double sine = gd_vec3_dot(gd_vec3_cross(first, across), axis);
        double cosine =
            gd_vec3_dot(first, across) - gd_vec3_dot(first, axis) * gd_vec3_dot(across, axis);
        double angle = i == 0 ? 0 : atan2(sine, cosine);
        edge_face[i].angle = angle < 0 ? angle + 2 * M_PI : angle;
    }
}

/* Compares faces by angle. Among faces at the same angle, backward faces come first. So a backward
 * and a forward face at the same angle become a pair with no space between them. */
static int face_pairing_compare(const void *x, const void *y)
{
    const struct gd__edge_face *a = x, *b = y;
    if (a->angle != b->angle) return a->angle < b->angle ? -1 : 1;
    if (a->forward != b->forward) return a->forward ? 1 : -1;
    return a->side < b->side ? -1 : a->side > b->side;
}

static void face_pairing_join(struct gd__edge_face *a, struct gd__edge_face *b)
{
    a->partner = b->side;
    b->partner = a->side;
}

/* Visits the faces twice, so that faces that still wait at the end are matched with faces at the
 * beginning. */
static void match(struct gd__edge_face *edge_face, uint32_t count)
{
    /* top of the stack of waiting backward faces, which is linked through `below` */
    uint32_t top = GD_NONE;
    for (uint64_t i = 0; i < 2 * (uint64_t)count; i++) {
        struct gd__edge_face *s = &edge_face[i % count];
        if (s->partner != GD_NONE) continue;
        if (!s->forward && i < count) {
            s->below = top;
            top = (uint32_t)i;
        } else if (s->forward && top != GD_NONE) {
            face_pairing_join(s, &edge_face[top]);
            top = edge_face[top].below;
        }
    }
}

void gd__edge_faces_pair(struct gd__edge_face *edge_face, uint32_t count, struct gd_vec3 along)
{
    face_pairing_measure(edge_face, count, along);
    for (uint32_t i = 0; i < count; i++) edge_face[i].partner = GD_NONE;
    qsort(edge_face, count, sizeof *edge_face, face_pairing_compare);
    match(edge_face, count);
}
