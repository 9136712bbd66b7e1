#include "construction/ring.h"

static void link_ring(const double (*positions)[3], const uint32_t *vertex, uint32_t count,
                      struct gd__ring_corner *corner)
{
    const double *origin = positions[vertex[0]];
    double extent = 0;
    for (uint32_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++)
            extent = fmax(extent, fabs(positions[vertex[i]][k] - origin[k]));
    }
    for (uint32_t i = 0; i < count; i++) {
        const double *p = positions[vertex[i]];
        corner[i] = (struct gd__ring_corner){
            .position = {(p[0] - origin[0]) / extent, (p[1] - origin[1]) / extent,
                         (p[2] - origin[2]) / extent},
            .vertex = vertex[i],
            .previous = i ? i - 1 : count - 1,
            .next = i + 1 < count ? i + 1 : 0,
            .reflex_slot = GD_NONE,
        };
    }
}

/* Returns Newell's normal: the sum of the cross products of consecutive corners along the ring. It
 * is twice the area vector. */
static struct gd_vec3 ring_normal_of(const struct gd__ring_corner *corner, uint32_t count)
{
    struct gd_vec3 normal = {0, 0, 0};
    for (uint32_t i = 0; i < count; i++)
        normal =
            gd_vec3_add(normal, gd_vec3_cross(corner[i].position, corner[corner[i].next].position));
    return normal;
}

/* Projects the ring by removing the coordinate in which its normal is largest. This does not change
 * orientations, nor whether a corner lies in a triangle. */
static void ring_project(struct gd__ring_corner *corner, uint32_t count)
{
    struct gd_vec3 n = ring_normal_of(corner, count), size = {fabs(n.x), fabs(n.y), fabs(n.z)};
    for (uint32_t i = 0; i < count; i++) {
        struct gd_vec3 p = corner[i].position;
        struct gd__ring_corner *c = &corner[i];
        if (size.x >= size.y && size.x >= size.z) {
            c->x = n.x < 0 ? -p.y : p.y;
            c->y = p.z;
        } else if (size.y >= size.z) {
            c->x = n.y < 0 ? -p.z : p.z;
            c->y = p.x;
        } else {
            c->x = n.z < 0 ? -p.x : p.x;
            c->y = p.y;
        }
    }
}

void gd__ring_make(const double (*positions)[3], const uint32_t *vertex, uint32_t count,
                   struct gd__ring_corner *corner)
{
    link_ring(positions, vertex, count, corner);
    ring_project(corner, count);
}

double gd__ring_shape(const struct gd__ring_corner *a, const struct gd__ring_corner *b,
                      const struct gd__ring_corner *c)
{
    struct gd_vec3 u = gd_vec3_sub(b->position, a->position),
                   v = gd_vec3_sub(c->position, a->position);
    struct gd_vec3 w = gd_vec3_sub(c->position, b->position);
    double squares = gd_vec3_dot(u, u) + gd_vec3_dot(v, v) + gd_vec3_dot(w, w);
    return squares > 0 ? 2 * sqrt(3) * gd_vec3_length(gd_vec3_cross(u, v)) / squares : 0;
}

bool gd__ring_may_join(const struct gd__edge_set *edges, const struct gd__ring_corner *a,
                       const struct gd__ring_corner *b)
{
    bool apart = a->position.x != b->position.x || a->position.y != b->position.y ||
                 a->position.z != b->position.z;
    return apart && !gd__edge_set_contains(edges, a->vertex, b->vertex);
}
