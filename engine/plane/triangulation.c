#include "plane/triangulation.h"

/* A segment that crosses n sides may cause at most FLIPS_A_SIDE * (n + 1)^2 flips, which is far
 * more than needed. */
#define FLIPS_A_SIDE 16
/* upper bound on the triangles of a triangulation with `count` sites */
#define TRIANGLES(count) (2 * (size_t)(count))

void gd__plane_free(struct gd__plane *plane)
{
    gd__arena_free(&plane->arena);
    *plane = (struct gd__plane){0};
}

size_t gd__plane_bytes(uint32_t capacity)
{
    return capacity * (sizeof(struct gd__site) + sizeof(uint32_t)) +
           TRIANGLES(capacity) * (sizeof(struct gd__plane_triangle) + 3 * sizeof(uint32_t[2]));
}

enum gd_status gd__plane_create(struct gd__plane *plane, uint32_t capacity)
{
    plane->capacity = capacity;
    struct gd__arena *arena = &plane->arena;
    plane->sites = gd__arena_take(arena, capacity, sizeof *plane->sites);
    plane->triangle_at = gd__arena_take(arena, capacity, sizeof *plane->triangle_at);
    plane->triangles = gd__arena_take(arena, TRIANGLES(capacity), sizeof *plane->triangles);
    plane->queue = gd__arena_take(arena, 3 * TRIANGLES(capacity), sizeof *plane->queue);
    return arena->status;
}

/* --- triangles -------------------------------------------------------------------------------- */

static int plane_turn(const struct gd__plane *plane, uint32_t a, uint32_t b, uint32_t c)
{
    return gd__site_turn(plane->sites[a], plane->sites[b], plane->sites[c]);
}

/* Returns the side of triangle `t` that is common with the triangle `neighbour`. */
static uint32_t side_towards(const struct gd__plane *plane, uint32_t t, uint32_t neighbour)
{
    const uint32_t *across = plane->triangles[t].across;
    return across[0] == neighbour ? 0 : across[1] == neighbour ? 1 : 2;
}

/* Returns the corner of triangle `t` that is site `s`. */
static uint32_t corner_at(const struct gd__plane *plane, uint32_t t, uint32_t s)
{
    const uint32_t *corner = plane->triangles[t].corner;
    return corner[0] == s ? 0 : corner[1] == s ? 1 : 2;
}

/* The triangle across a side. `is_fixed` is true if the side is a segment. */
struct border {
    uint32_t across;
    bool is_fixed;
};

static struct border border_of(const struct gd__plane *plane, uint32_t t, uint32_t k)
{
    return (struct border){plane->triangles[t].across[k], plane->triangles[t].is_fixed[k]};
}

static struct border inner(uint32_t across)
{
    return (struct border){across, false};
}

static void set(struct gd__plane *plane, uint32_t t, const uint32_t corner[3],
                const struct border border[3])
{
    struct gd__plane_triangle *triangle = &plane->triangles[t];
    for (uint32_t k = 0; k < 3; k++) {
        triangle->corner[k] = corner[k];
        triangle->across[k] = border[k].across;
        triangle->is_fixed[k] = border[k].is_fixed;
        plane->triangle_at[corner[k]] = t;
    }
}

/* Replaces the triangle `old` by `t` among the neighbours of the triangle `neighbour`. */
static void redirect(struct gd__plane *plane, uint32_t neighbour, uint32_t old, uint32_t t)
{
    if (neighbour != GD_NONE)
        plane->triangles[neighbour].across[side_towards(plane, neighbour, old)] = t;
}

void gd__plane_begin(struct gd__plane *plane, const uint32_t corner[3])
{
    plane->triangle_count = 1;
    plane->last = 0;
    set(plane, 0, corner, (struct border[]){inner(GD_NONE), inner(GD_NONE), inner(GD_NONE)});
}

/* --- flips ------------------------------------------------------------------------------------ */

/* Two triangles at a common side a-b: t has the corners a, b, c, and `other` has the corners b, a,
 * d. m is the side's number in `other`. */
struct quad {
    uint32_t t, other, a, b, c, d, k, m;
};

static struct quad quad_of(const struct gd__plane *plane, struct gd__plane_side side)
{
    const struct gd__plane_triangle *t = &plane->triangles[side.triangle];
    uint32_t other = t->across[side.k], m = side_towards(plane, other, side.triangle);
    return (struct quad){.t = side.triangle,
                         .other = other,
                         .a = t->corner[side.k],
                         .b = t->corner[gd__corner_after(side.k)],
                         .c = t->corner[gd__corner_before(side.k)],
                         .d = plane->triangles[other].corner[gd__corner_before(m)],
                         .k = side.k,
                         .m = m};
}

uint32_t gd__plane_opposite(const struct gd__plane *plane, struct gd__plane_side side)
{
    return quad_of(plane, side).d;
}

bool gd__plane_is_convex(const struct gd__plane *plane, struct gd__plane_side side)
{
    struct quad q = quad_of(plane, side);
    return plane_turn(plane, q.c, q.a, q.d) > 0 && plane_turn(plane, q.d, q.b, q.c) > 0;
}

/* Replaces a-b by c-d. */
static void plane_flip(struct gd__plane *plane, struct gd__plane_side side)
{
    struct quad q = quad_of(plane, side);
    struct border bc = border_of(plane, q.t, gd__corner_after(q.k)),
                  ca = border_of(plane, q.t, gd__corner_before(q.k)),
                  ad = border_of(plane, q.other, gd__corner_after(q.m)),
                  db = border_of(plane, q.other, gd__corner_before(q.m));
    redirect(plane, bc.across, q.t, q.other);
    redirect(plane, ad.across, q.other, q.t);
    set(plane, q.t, (uint32_t[]){q.c, q.a, q.d}, (struct border[]){ca, ad, inner(q.other)});
    set(plane, q.other, (uint32_t[]){q.d, q.b, q.c}, (struct border[]){db, bc, inner(q.t)});
}

static bool is_bad(const struct gd__plane *plane, struct gd__plane_side side)
{
    const struct gd__plane_triangle *t = &plane->triangles[side.triangle];
    return t->across[side.k] != GD_NONE && !t->is_fixed[side.k] && plane->is_bad(plane, side);
}

/* Makes one pass over the sides. Returns the number of flips. */
static uint32_t improve_once(struct gd__plane *plane)
{
    uint32_t flips = 0;
    for (uint32_t t = 0; t < plane->triangle_count; t++) {
        for (uint32_t k = 0; k < 3; k++) {
            if (!is_bad(plane, (struct gd__plane_side){t, k})) continue;
            plane_flip(plane, (struct gd__plane_side){t, k});
            flips++;
        }
    }
    return flips;
}

void gd__plane_improve(struct gd__plane *plane)
{
    for (uint32_t pass = 0; pass <= plane->capacity && improve_once(plane); pass++) {
    }
}

/* --- inserting sites -------------------------------------------------------------------------- */

/* Divides triangle `t` into three at site `s`, which is strictly inside. Like split_side, queues
 * the new triangles, and returns their number. */
static uint32_t split_triangle(struct gd__plane *plane, uint32_t t, uint32_t s)
{
    const struct gd__plane_triangle old = plane->triangles[t];
    const struct border border[3] = {border_of(plane, t, 0), border_of(plane, t, 1),
                                     border_of(plane, t, 2)};
    uint32_t part[3] = {t, plane->triangle_count, plane->triangle_count + 1};
    plane->triangle_count += 2;
    for (uint32_t k = 0; k < 3; k++) redirect(plane, border[k].across, t, part[k]);
    for (uint32_t k = 0; k < 3; k++) {
        set(plane, part[k], (uint32_t[]){old.corner[k], old.corner[gd__corner_after(k)], s},
            (struct border[]){border[k], inner(part[gd__corner_after(k)]),
                              inner(part[gd__corner_before(k)])});
        plane->queue[k][0] = part[k];
    }
    return 3;
}

/* Divides the triangles on both sides of a side at site `s`, which is strictly inside this side. At
 * the border, there is only one triangle. */
static uint32_t split_side(struct gd__plane *plane, struct gd__plane_side side, uint32_t s)
{
    uint32_t t = side.triangle, k = side.k, count = 0, a = plane->triangles[t].corner[k],
             b = plane->triangles[t].corner[gd__corner_after(k)],
             c = plane->triangles[t].corner[gd__corner_before(k)],
             other = plane->triangles[t].across[k];
    struct border bc = border_of(plane, t, gd__corner_after(k)),
                  ca = border_of(plane, t, gd__corner_before(k));
    uint32_t new = plane->triangle_count++,
             other_new = other == GD_NONE ? GD_NONE : plane->triangle_count++;
    bool is_fixed = plane->triangles[t].is_fixed[k];
    if (other != GD_NONE) {
        uint32_t m = side_towards(plane, other, t),
                 d = plane->triangles[other].corner[gd__corner_before(m)];
        struct border ad = border_of(plane, other, gd__corner_after(m)),
                      db = border_of(plane, other, gd__corner_before(m));
        redirect(plane, db.across, other, other_new);
        set(plane, other, (uint32_t[]){s, a, d},
            (struct border[]){{t, is_fixed}, ad, inner(other_new)});
        set(plane, other_new, (uint32_t[]){b, s, d},
            (struct border[]){{new, is_fixed}, inner(other), db});
        plane->queue[count++][0] = other;
        plane->queue[count++][0] = other_new;
    }
    redirect(plane, bc.across, t, new);
    set(plane, t, (uint32_t[]){a, s, c}, (struct border[]){{other, is_fixed}, inner(new), ca});
    set(plane, new, (uint32_t[]){s, b, c}, (struct border[]){{other_new, is_fixed}, bc, inner(t)});
    plane->queue[count++][0] = t;
    plane->queue[count++][0] = new;
    return count;
}

/* Walks to the triangle that contains a site. Sets out->k to the side on which the site lies, or to
 * 3 if the site is inside. In a Delaunay triangulation, the walk visits no triangle twice. */
static enum gd_status locate(const struct gd__plane *plane, uint32_t s, struct gd__plane_side *out)
{
    uint32_t t = plane->last;
    for (uint32_t i = 0; i < plane->triangle_count && t != GD_NONE; i++) {
        const uint32_t *corner = plane->triangles[t].corner;
        uint32_t next = t;
        *out = (struct gd__plane_side){t, 3};
        if (!gd__pace(plane->pace, 1)) return plane->pace->status;
        for (uint32_t k = 0; k < 3; k++) {
            int turn = plane_turn(plane, corner[k], corner[gd__corner_after(k)], s);
            if (turn < 0) next = plane->triangles[t].across[k];
            if (turn == 0) out->k = k;
        }
        if (next == t) return GD_OK;
        t = next;
    }
    return GD_RUNAWAY;
}

/* Flips bad sides opposite to a new site, in the queued triangles around it. Each flip adds a side
 * at the site, so the queue is long enough. */
static enum gd_status legalise(struct gd__plane *plane, uint32_t s, uint32_t queued)
{
    while (queued && gd__pace(plane->pace, 8)) {
        uint32_t t = plane->queue[--queued][0];
        const struct gd__plane_side side = {t, gd__corner_after(corner_at(plane, t, s))};
        if (!is_bad(plane, side)) continue;
        plane->queue[queued++][0] = t;
        plane->queue[queued++][0] = plane->triangles[t].across[side.k];
        plane_flip(plane, side);
    }
    return plane->pace->status;
}

enum gd_status gd__plane_insert(struct gd__plane *plane, uint32_t s, uint32_t *same)
{
    struct gd__plane_side at;
    enum gd_status status = locate(plane, s, &at);
    if (status) return status;
    for (uint32_t k = 0; k < 3; k++) {
        *same = plane->triangles[at.triangle].corner[k];
        if (plane->sites[*same].u == plane->sites[s].u &&
            plane->sites[*same].v == plane->sites[s].v)
            return GD_OK;
    }
    *same = s;
    status = legalise(plane, s,
                      at.k == 3 ? split_triangle(plane, at.triangle, s) : split_side(plane, at, s));
    plane->last = plane->triangle_at[s];
    return status;
}

/* --- segments --------------------------------------------------------------------------------- */

/* Finds the triangle around site `a` whose corner at `a` satisfies `is_wanted`. Returns false if
 * there is none. */
static bool find_around(const struct gd__plane *plane, uint32_t a, uint32_t b,
                        bool (*is_wanted)(const struct gd__plane *plane, struct gd__plane_side at,
                                          uint32_t b),
                        struct gd__plane_side *out)
{
    uint32_t start = plane->triangle_at[a];
    for (int clockwise = 0; clockwise < 2; clockwise++) {
        uint32_t t = start;
        do {
            uint32_t k = corner_at(plane, t, a);
            *out = (struct gd__plane_side){t, k};
            if (is_wanted(plane, *out, b)) return true;
            t = plane->triangles[t].across[clockwise ? k : gd__corner_before(k)];
        } while (t != GD_NONE && t != start);
        if (t == start) return false;
    }
    return false;
}

/* Returns true if the side that begins at the corner ends at b. */
static bool leads_to(const struct gd__plane *plane, struct gd__plane_side at, uint32_t b)
{
    return plane->triangles[at.triangle].corner[gd__corner_after(at.k)] == b;
}

/* Returns true if the line to b leaves the triangle across the side opposite to the corner. */
static bool opens_to(const struct gd__plane *plane, struct gd__plane_side at, uint32_t b)
{
    const uint32_t *corner = plane->triangles[at.triangle].corner;
    uint32_t a = corner[at.k], right = corner[gd__corner_after(at.k)],
             left = corner[gd__corner_before(at.k)];
    return plane_turn(plane, a, b, right) < 0 && plane_turn(plane, a, b, left) > 0;
}

/* Finds the side from a to b, or, on the border, the side from b to a. */
static bool find_side(const struct gd__plane *plane, uint32_t a, uint32_t b,
                      struct gd__plane_side *out)
{
    return find_around(plane, a, b, leads_to, out) || find_around(plane, b, a, leads_to, out);
}

static void fix_side(struct gd__plane *plane, struct gd__plane_side side)
{
    struct gd__plane_triangle *t = &plane->triangles[side.triangle];
    uint32_t other = t->across[side.k];
    t->is_fixed[side.k] = true;
    if (other != GD_NONE)
        plane->triangles[other].is_fixed[side_towards(plane, other, side.triangle)] = true;
}

/* Queues the sides that a-b crosses, in order from a. Returns false if a-b passes a site or crosses
 * a segment, or if the pace stops. */
static bool queue_crossed(struct gd__plane *plane, uint32_t a, uint32_t b, uint32_t *count)
{
    struct gd__plane_side at;
    if (!find_around(plane, a, b, opens_to, &at)) return false;
    uint32_t t = at.triangle, k = gd__corner_after(at.k);
    for (*count = 0; gd__pace(plane->pace, 1);) {
        const struct gd__plane_triangle *triangle = &plane->triangles[t];
        if (triangle->is_fixed[k] || triangle->across[k] == GD_NONE) return false;
        struct quad q = quad_of(plane, (struct gd__plane_side){t, k});
        plane->queue[*count][0] = q.a;
        plane->queue[(*count)++][1] = q.b;
        if (q.d == b) return true;
        int side = plane_turn(plane, a, b, q.d);
        if (side == 0) return false;
        t = q.other;
        /* if the apex is on the left, continues across the right side */
        k = side > 0 ? gd__corner_after(q.m) : gd__corner_before(q.m);
    }
    return false;
}

/* Flips a side that the segment a-b crosses, if possible, and sets `crossed` to the new side.
 * Returns true if the side was flipped and a-b does not cross the new side. */
static bool flip_away(struct gd__plane *plane, uint32_t a, uint32_t b, struct gd__plane_side side,
                      uint32_t crossed[2])
{
    const struct gd__site *s = plane->sites;
    if (!gd__plane_is_convex(plane, side)) return false;
    plane_flip(plane, side);
    crossed[0] = plane->triangles[side.triangle].corner[2];
    crossed[1] = plane->triangles[side.triangle].corner[0];
    return !gd__sites_cross(s[a], s[b], s[crossed[0]], s[crossed[1]]);
}

/* Processes the queue of sides, a ring buffer of `count` entries. Sides that a-b still crosses are
 * queued again. */
static enum gd_status flip_crossed(struct gd__plane *plane, uint32_t a, uint32_t b, uint32_t count)
{
    uint64_t most = FLIPS_A_SIDE * (uint64_t)(count + 1) * (count + 1);
    uint32_t head = 0, left = count;
    for (uint64_t turns = 0; left && gd__pace(plane->pace, 4); turns++) {
        uint32_t crossed[2] = {plane->queue[head][0], plane->queue[head][1]};
        struct gd__plane_side side;
        if (turns > most || !find_side(plane, crossed[0], crossed[1], &side)) return GD_RUNAWAY;
        head = (head + 1) % count;
        left--;
        if (!flip_away(plane, a, b, side, crossed))
            memcpy(plane->queue[(head + left++) % count], crossed, sizeof crossed);
    }
    return plane->pace->status;
}

enum gd_status gd__plane_fix(struct gd__plane *plane, uint32_t a, uint32_t b)
{
    struct gd__plane_side side;
    if (!find_side(plane, a, b, &side)) {
        uint32_t crossed = 0;
        if (!queue_crossed(plane, a, b, &crossed))
            return plane->pace->status ? plane->pace->status : GD_RUNAWAY;
        enum gd_status status = flip_crossed(plane, a, b, crossed);
        if (status) return status;
        if (!find_side(plane, a, b, &side)) return GD_RUNAWAY;
    }
    fix_side(plane, side);
    return GD_OK;
}
