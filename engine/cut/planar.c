#include "cut/planar.h"

#include "base/tolerance.h"

#define FIRST_CAPACITY 64
#define MOST_SITES     (UINT32_C(1) << 14)

void gd__planar_free(struct gd__planar *planar)
{
    gd__plane_free(&planar->plane);
    *planar = (struct gd__planar){.budget = planar->budget, .pace = planar->pace};
}

/* The angle at `apex` from `p` to `q`: its sine and its cosine, both multiplied by `legs`. `legs`
 * is the product of the lengths of both legs. */
struct angle {
    double sine, cosine, legs;
};

static struct angle planar_angle_at(struct gd__local apex, struct gd__local p, struct gd__local q)
{
    double px = p.x - apex.x, py = p.y - apex.y, qx = q.x - apex.x, qy = q.y - apex.y;
    return (struct angle){px * qy - py * qx, px * qx + py * qy, hypot(px, py) * hypot(qx, qy)};
}

/* Returns true if a side is not Delaunay: the angles opposite to it sum to more than pi. */
static bool is_bad(const struct gd__plane *plane, struct gd__plane_side side)
{
    const uint32_t *corner = plane->triangles[side.triangle].corner;
    const struct gd__local *place = ((const struct gd__planar *)plane)->places;
    struct gd__local a = place[corner[side.k]], b = place[corner[gd__corner_after(side.k)]];
    struct angle at_c = planar_angle_at(place[corner[gd__corner_before(side.k)]], a, b),
                 at_d = planar_angle_at(place[gd__plane_opposite(plane, side)], b, a);
    return at_c.sine * at_d.cosine + at_c.cosine * at_d.sine <
               -GD_TOL_DELAUNAY * at_c.legs * at_d.legs &&
           gd__plane_is_convex(plane, side);
}

static enum gd_status planar_reserve(struct gd__planar *planar, uint32_t capacity)
{
    enum gd_status status = gd__budget_take(planar->budget, gd__plane_bytes(capacity) +
                                                                capacity * sizeof *planar->places);
    if (status) return status;
    gd__planar_free(planar);
    planar->places = gd__arena_take(&planar->plane.arena, capacity, sizeof *planar->places);
    return gd__plane_create(&planar->plane, capacity);
}

enum gd_status gd__planar_begin(struct gd__planar *planar, uint32_t count)
{
    uint32_t capacity = FIRST_CAPACITY;
    if (count > MOST_SITES) return GD_TOO_LARGE;
    while (capacity < count) capacity *= 2;
    enum gd_status status =
        capacity > planar->plane.capacity ? planar_reserve(planar, capacity) : GD_OK;
    planar->pace.control = planar->budget->control;
    planar->plane.pace = &planar->pace;
    planar->plane.is_bad = is_bad;
    planar->site_count = count;
    return status;
}

enum gd_status gd__planar_triangulate(struct gd__planar *planar)
{
    enum gd_status status = GD_OK;
    gd__plane_begin(&planar->plane, (uint32_t[]){0, 1, 2});
    for (uint32_t s = 3; s < planar->site_count && !status; s++) {
        uint32_t same;
        status = gd__plane_insert(&planar->plane, s, &same);
        if (!status && same != s) status = GD_RUNAWAY;
    }
    return status;
}
