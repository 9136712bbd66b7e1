#include "cut/planar.h"

#include <stdlib.h>
#include <string.h>

#include "base/tolerance.h"

#define FIRST_CAPACITY 64
#define MOST_SITES     (UINT32_C(1) << 14)
/* A segment that crosses n sides may cause at most FLIPS_A_SIDE (n + 1)^2 flips, which is far more
 * than needed. */
#define FLIPS_A_SIDE 16
/* upper bound on the triangles of a triangulation with `count` sites */
#define TRIANGLES(count) (2 * (size_t)(count))

struct gd__planar_side { /* a side from corner a to corner b */
    uint32_t a, b;
};

struct side {
    uint32_t triangle, k;
};

void gd__planar_free(struct gd__planar *planar)
{
    free(planar->sites);
    free(planar->places);
    free(planar->triangle_at);
    free(planar->triangles);
    free(planar->queue);
    *planar = (struct gd__planar){0};
}

static size_t planar_bytes_of(uint32_t capacity)
{
    return capacity * (sizeof(struct gd__site) + sizeof(struct gd__local) + sizeof(uint32_t)) +
           TRIANGLES(capacity) *
               (sizeof(struct gd__planar_triangle) + 3 * sizeof(struct gd__planar_side));
}

static enum gd_status planar_reserve(struct gd__planar *planar, uint32_t capacity)
{
    struct gd__budget *budget = planar->budget;
    enum gd_status status = gd__budget_take(budget, planar_bytes_of(capacity));
    if (status) return status;
    gd__planar_free(planar);
    planar->budget = budget;
    planar->site_capacity = capacity;
    planar->sites = malloc(capacity * sizeof *planar->sites);
    planar->places = malloc(capacity * sizeof *planar->places);
    planar->triangle_at = malloc(capacity * sizeof *planar->triangle_at);
    planar->triangles = malloc(TRIANGLES(capacity) * sizeof *planar->triangles);
    planar->queue = malloc(3 * TRIANGLES(capacity) * sizeof *planar->queue);
    bool ok = planar->sites && planar->places && planar->triangle_at && planar->triangles &&
              planar->queue;
    return ok ? GD_OK : GD_NO_MEMORY;
}

enum gd_status gd__planar_begin(struct gd__planar *planar, uint32_t count)
{
    uint32_t capacity = FIRST_CAPACITY;
    if (count > MOST_SITES) return GD_TOO_LARGE;
    while (capacity < count) capacity *= 2;
    enum gd_status status =
        capacity > planar->site_capacity ? planar_reserve(planar, capacity) : GD_OK;
    planar->site_count = count;
    planar->triangle_count = 0;
    return status;
}

/* --- triangles -------------------------------------------------------------------------------- */

static int planar_turn(const struct gd__planar *planar, uint32_t a, uint32_t b, uint32_t c)
{
    return gd__site_turn(planar->sites[a], planar->sites[b], planar->sites[c]);
}

static uint32_t corner_before(uint32_t k)
{
    return k == 0 ? 2 : k - 1;
}

/* Returns the side of triangle `t` that is common with the triangle `neighbour`. */
static uint32_t side_towards(const struct gd__planar *planar, uint32_t t, uint32_t neighbour)
{
    const uint32_t *across = planar->triangles[t].across;
    return across[0] == neighbour ? 0 : across[1] == neighbour ? 1 : 2;
}

/* The triangle across a side. `is_fixed` is true if the side is a segment. */
struct border {
    uint32_t across;
    bool is_fixed;
};

static struct border border_of(const struct gd__planar *planar, uint32_t t, uint32_t k)
{
    return (struct border){planar->triangles[t].across[k], planar->triangles[t].is_fixed[k]};
}

static struct border inner(uint32_t across)
{
    return (struct border){across, false};
}

static void set(struct gd__planar *planar, uint32_t t, const uint32_t corner[3],
                const struct border border[3])
{
    struct gd__planar_triangle *triangle = &planar->triangles[t];
    for (uint32_t k = 0; k < 3; k++) {
        triangle->corner[k] = corner[k];
        triangle->across[k] = border[k].across;
        triangle->is_fixed[k] = border[k].is_fixed;
        planar->triangle_at[corner[k]] = t;
    }
}

/* Replaces the triangle `old` by `t` among the neighbours of the triangle `neighbour`. */
static void redirect(struct gd__planar *planar, uint32_t neighbour, uint32_t old, uint32_t t)
{
    if (neighbour != GD_NONE)
        planar->triangles[neighbour].across[side_towards(planar, neighbour, old)] = t;
}

/* --- inserting sites -------------------------------------------------------------------------- */

/* Divides triangle `t` into three at site `s`, which is strictly inside. */
static void split_triangle(struct gd__planar *planar, uint32_t t, uint32_t s)
{
    const struct gd__planar_triangle old = planar->triangles[t];
    const struct border border[3] = {border_of(planar, t, 0), border_of(planar, t, 1),
                                     border_of(planar, t, 2)};
    uint32_t part[3] = {t, planar->triangle_count, planar->triangle_count + 1};
    planar->triangle_count += 2;
    for (uint32_t k = 0; k < 3; k++) redirect(planar, border[k].across, t, part[k]);
    for (uint32_t k = 0; k < 3; k++)
        set(planar, part[k], (uint32_t[]){old.corner[k], old.corner[gd__corner_after(k)], s},
            (struct border[]){border[k], inner(part[gd__corner_after(k)]),
                              inner(part[corner_before(k)])});
}

/* Divides the triangles on both sides of side k of `t` at site `s`, which is strictly inside this
 * side. At the face's border, divides only `t`. */
static void split_side(struct gd__planar *planar, uint32_t t, uint32_t k, uint32_t s)
{
    uint32_t a = planar->triangles[t].corner[k],
             b = planar->triangles[t].corner[gd__corner_after(k)],
             c = planar->triangles[t].corner[corner_before(k)],
             other = planar->triangles[t].across[k];
    struct border bc = border_of(planar, t, gd__corner_after(k)),
                  ca = border_of(planar, t, corner_before(k));
    uint32_t new = planar->triangle_count++,
             other_new = other == GD_NONE ? GD_NONE : planar->triangle_count++;
    bool is_fixed = planar->triangles[t].is_fixed[k];
    if (other != GD_NONE) {
        uint32_t m = side_towards(planar, other, t),
                 d = planar->triangles[other].corner[corner_before(m)];
        struct border ad = border_of(planar, other, gd__corner_after(m)),
                      db = border_of(planar, other, corner_before(m));
        redirect(planar, db.across, other, other_new);
        set(planar, other, (uint32_t[]){s, a, d},
            (struct border[]){{t, is_fixed}, ad, inner(other_new)});
        set(planar, other_new, (uint32_t[]){b, s, d},
            (struct border[]){{new, is_fixed}, inner(other), db});
    }
    redirect(planar, bc.across, t, new);
    set(planar, t, (uint32_t[]){a, s, c}, (struct border[]){{other, is_fixed}, inner(new), ca});
    set(planar, new, (uint32_t[]){s, b, c}, (struct border[]){{other_new, is_fixed}, bc, inner(t)});
}

/* Inserts a site into the triangle that contains it. */
static enum gd_status planar_insert(struct gd__planar *planar, uint32_t s)
{
    for (uint32_t t = 0; t < planar->triangle_count; t++) {
        const uint32_t *corner = planar->triangles[t].corner;
        const int turns[3] = {planar_turn(planar, corner[0], corner[1], s),
                              planar_turn(planar, corner[1], corner[2], s),
                              planar_turn(planar, corner[2], corner[0], s)};
        if (turns[0] < 0 || turns[1] < 0 || turns[2] < 0) continue;
        uint32_t zeros = !turns[0] + !turns[1] + !turns[2];
        if (zeros > 1) return GD_RUNAWAY;
        if (zeros)
            split_side(planar, t, !turns[0] ? 0 : !turns[1] ? 1 : 2, s);
        else
            split_triangle(planar, t, s);
        return GD_OK;
    }
    return GD_RUNAWAY;
}

enum gd_status gd__planar_triangulate(struct gd__planar *planar)
{
    enum gd_status status = GD_OK;
    planar->triangle_count = 1;
    set(planar, 0, (uint32_t[]){0, 1, 2},
        (struct border[]){inner(GD_NONE), inner(GD_NONE), inner(GD_NONE)});
    for (uint32_t s = 3; s < planar->site_count && !status; s++) {
        status = planar_insert(planar, s);
        if (!status) status = gd_control_check(planar->budget->control, 0);
    }
    return status;
}

/* --- flips ------------------------------------------------------------------------------------ */

/* Returns true if the two triangles at a side form a strictly convex quadrilateral. */
static bool is_convex(const struct gd__planar *planar, struct side side)
{
    const struct gd__planar_triangle *t = &planar->triangles[side.triangle];
    uint32_t other = t->across[side.k], m = side_towards(planar, other, side.triangle);
    uint32_t a = t->corner[side.k], b = t->corner[gd__corner_after(side.k)],
             c = t->corner[corner_before(side.k)],
             d = planar->triangles[other].corner[corner_before(m)];
    return planar_turn(planar, c, a, d) > 0 && planar_turn(planar, d, b, c) > 0;
}

/* Flips a side: replaces a-b, the common side of triangles abc and bad, by c-d. */
static void planar_flip(struct gd__planar *planar, struct side side)
{
    uint32_t t = side.triangle, other = planar->triangles[t].across[side.k],
             m = side_towards(planar, other, t);
    uint32_t a = planar->triangles[t].corner[side.k],
             b = planar->triangles[t].corner[gd__corner_after(side.k)],
             c = planar->triangles[t].corner[corner_before(side.k)],
             d = planar->triangles[other].corner[corner_before(m)];
    struct border bc = border_of(planar, t, gd__corner_after(side.k)),
                  ca = border_of(planar, t, corner_before(side.k)),
                  ad = border_of(planar, other, gd__corner_after(m)),
                  db = border_of(planar, other, corner_before(m));
    redirect(planar, bc.across, t, other);
    redirect(planar, ad.across, other, t);
    set(planar, t, (uint32_t[]){c, a, d}, (struct border[]){ca, ad, inner(other)});
    set(planar, other, (uint32_t[]){d, b, c}, (struct border[]){db, bc, inner(t)});
}

/* --- segments --------------------------------------------------------------------------------- */

/* Finds the triangle around site `a` whose corner at `a` satisfies `is_wanted`. Returns false if
 * there is none. */
static bool find_around(const struct gd__planar *planar, uint32_t a, uint32_t b,
                        bool (*is_wanted)(const struct gd__planar *planar, struct side at,
                                          uint32_t b),
                        struct side *out)
{
    uint32_t start = planar->triangle_at[a];
    for (int clockwise = 0; clockwise < 2; clockwise++) {
        uint32_t t = start;
        do {
            const uint32_t *corner = planar->triangles[t].corner;
            uint32_t k = corner[0] == a ? 0 : corner[1] == a ? 1 : 2;
            *out = (struct side){t, k};
            if (is_wanted(planar, *out, b)) return true;
            t = planar->triangles[t].across[clockwise ? k : corner_before(k)];
        } while (t != GD_NONE && t != start);
        if (t == start) return false;
    }
    return false;
}

/* Returns true if the side that begins at the corner ends at b. */
static bool leads_to(const struct gd__planar *planar, struct side at, uint32_t b)
{
    return planar->triangles[at.triangle].corner[gd__corner_after(at.k)] == b;
}

/* Returns true if the side that ends at the corner begins at b. Needed for sides on the border of
 * the face, which have only one triangle. */
static bool comes_from(const struct gd__planar *planar, struct side at, uint32_t b)
{
    return planar->triangles[at.triangle].corner[corner_before(at.k)] == b;
}

/* Returns true if the line to b leaves the triangle across the side opposite to the corner. */
static bool opens_to(const struct gd__planar *planar, struct side at, uint32_t b)
{
    const uint32_t *corner = planar->triangles[at.triangle].corner;
    uint32_t a = corner[at.k], right = corner[gd__corner_after(at.k)],
             left = corner[corner_before(at.k)];
    return planar_turn(planar, a, b, right) < 0 && planar_turn(planar, a, b, left) > 0;
}

static bool find_side(const struct gd__planar *planar, uint32_t a, uint32_t b, struct side *out)
{
    if (find_around(planar, a, b, leads_to, out)) return true;
    if (!find_around(planar, a, b, comes_from, out)) return false;
    out->k = corner_before(out->k);
    return true;
}

static void fix_side(struct gd__planar *planar, struct side side)
{
    struct gd__planar_triangle *t = &planar->triangles[side.triangle];
    uint32_t other = t->across[side.k];
    t->is_fixed[side.k] = true;
    if (other != GD_NONE)
        planar->triangles[other].is_fixed[side_towards(planar, other, side.triangle)] = true;
}

/* Queues the sides that a-b crosses, in order from a. Returns false if a-b passes a site or crosses
 * a segment. */
static bool queue_crossed(struct gd__planar *planar, uint32_t a, uint32_t b, uint32_t *count)
{
    struct side at;
    if (!find_around(planar, a, b, opens_to, &at)) return false;
    uint32_t t = at.triangle, k = gd__corner_after(at.k);
    for (*count = 0;;) {
        const struct gd__planar_triangle *triangle = &planar->triangles[t];
        uint32_t other = triangle->across[k];
        if (triangle->is_fixed[k] || other == GD_NONE) return false;
        planar->queue[(*count)++] =
            (struct gd__planar_side){triangle->corner[k], triangle->corner[gd__corner_after(k)]};
        uint32_t m = side_towards(planar, other, t),
                 apex = planar->triangles[other].corner[corner_before(m)];
        if (apex == b) return true;
        int side = planar_turn(planar, a, b, apex);
        if (side == 0) return false;
        t = other;
        /* if the apex is on the left, continues across the right side */
        k = side > 0 ? gd__corner_after(m) : corner_before(m);
    }
}

static bool crosses(const struct gd__planar *planar, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    const struct gd__site *s = planar->sites;
    return gd__sites_cross(s[a], s[b], s[c], s[d]);
}

/* Flips a side that the segment a-b crosses, if possible, and sets *crossed to the new side.
 * Returns true if the side was flipped and a-b does not cross the new side. */
static bool flip_away(struct gd__planar *planar, uint32_t a, uint32_t b, struct side side,
                      struct gd__planar_side *crossed)
{
    if (!is_convex(planar, side)) return false;
    planar_flip(planar, side);
    crossed->a = planar->triangles[side.triangle].corner[2];
    crossed->b = planar->triangles[side.triangle].corner[0];
    return !crosses(planar, a, b, crossed->a, crossed->b);
}

/* Processes the queue of sides, a ring buffer of `count` entries. Sides that a-b still crosses are
 * queued again. */
static enum gd_status flip_crossed(struct gd__planar *planar, uint32_t a, uint32_t b,
                                   uint32_t count)
{
    uint64_t most = FLIPS_A_SIDE * (uint64_t)(count + 1) * (count + 1);
    uint32_t head = 0, left = count;
    for (uint64_t turns = 0; left; turns++) {
        struct gd__planar_side crossed = planar->queue[head];
        struct side side;
        if (turns > most || !find_side(planar, crossed.a, crossed.b, &side)) return GD_RUNAWAY;
        head = (head + 1) % count;
        left--;
        if (!flip_away(planar, a, b, side, &crossed))
            planar->queue[(head + left++) % count] = crossed;
    }
    return GD_OK;
}

enum gd_status gd__planar_fix(struct gd__planar *planar, uint32_t a, uint32_t b)
{
    struct side side;
    if (!find_side(planar, a, b, &side)) {
        uint32_t crossed = 0;
        if (!queue_crossed(planar, a, b, &crossed)) return GD_RUNAWAY;
        enum gd_status status = flip_crossed(planar, a, b, crossed);
        if (status) return status;
        if (!find_side(planar, a, b, &side)) return GD_RUNAWAY;
    }
    fix_side(planar, side);
    return GD_OK;
}

/* --- Delaunay --------------------------------------------------------------------------------- */

/* Sine and cosine of the angle at `apex` from `p` to `q`, times the lengths of both legs; `legs` is
 * their product. */
struct angle {
    double sine, cosine, legs;
};

static struct angle planar_angle_at(struct gd__local apex, struct gd__local p, struct gd__local q)
{
    double px = p.x - apex.x, py = p.y - apex.y, qx = q.x - apex.x, qy = q.y - apex.y;
    return (struct angle){px * qy - py * qx, px * qx + py * qy, hypot(px, py) * hypot(qx, qy)};
}

/* Returns true if a side is not Delaunay: the angles opposite to it sum to more than pi. */
static bool is_bad(const struct gd__planar *planar, struct side side)
{
    const struct gd__planar_triangle *t = &planar->triangles[side.triangle];
    uint32_t other = t->across[side.k];
    if (other == GD_NONE || t->is_fixed[side.k]) return false;
    uint32_t m = side_towards(planar, other, side.triangle),
             d = planar->triangles[other].corner[corner_before(m)];
    const struct gd__local *place = planar->places;
    struct gd__local a = place[t->corner[side.k]], b = place[t->corner[gd__corner_after(side.k)]];
    struct angle at_c = planar_angle_at(place[t->corner[corner_before(side.k)]], a, b),
                 at_d = planar_angle_at(place[d], b, a);
    return at_c.sine * at_d.cosine + at_c.cosine * at_d.sine <
               -GD_TOL_DELAUNAY * at_c.legs * at_d.legs &&
           is_convex(planar, side);
}

/* Makes one pass over the sides. Returns the number of flips. */
static uint32_t improve_once(struct gd__planar *planar)
{
    uint32_t flips = 0;
    for (uint32_t t = 0; t < planar->triangle_count; t++) {
        for (uint32_t k = 0; k < 3; k++) {
            if (!is_bad(planar, (struct side){t, k})) continue;
            planar_flip(planar, (struct side){t, k});
            flips++;
        }
    }
    return flips;
}

void gd__planar_improve(struct gd__planar *planar)
{
    for (uint32_t pass = 0; pass <= planar->site_count && improve_once(planar); pass++) {
    }
}
