/* DESIGN. The polygon is projected to its Newell plane, where it runs counter-clockwise, and kept
 * as a ring of corners. Every corner has a score, the higher the better its triangle (previous,
 * corner, next) as the next one to cut off:
 *
 *   -INFINITY        the diagonal exists already or has length zero: never
 *   shape - 2        the corner is reflex in the plane
 *   shape - 1        convex, but another corner lies within
 *   shape, in [0,1]  an ear
 *
 * shape: 4 sqrt(3) area / (sum of squared sides), 1 for an equilateral triangle, in space. Of four
 * corners left, cutting one off decides both triangles: the worse one counts. Cutting changes the
 * triangles of the two neighbours only, and in the plane no corner becomes an ear but those: what
 * lies within a triangle stays there.
 *
 * Greed can end with corners that may not be cut off although another order would have gone
 * through: then the ears are cut again, but the last corners are left to an exhaustive search
 * (interval.c). */
#include "construction/ear.h"

#include <stdlib.h>

#include "construction/interval.h"
#include "construction/ring.h"

#define NEVER (-INFINITY)

struct gd__ear_clipper {
    struct gd__ring_corner *corner;
    uint32_t *reflex; /* the corners that can lie within an ear */
    uint32_t reflex_count;
    uint32_t left; /* corners in the ring */
    const struct gd__edge_set *edges;
    struct gd__interval_table table;
};

struct gd__ear_clipper *gd__ear_clipper_create(uint32_t most)
{
    struct gd__ear_clipper *clipper = calloc(1, sizeof *clipper);
    if (!clipper) return NULL;
    clipper->corner = malloc(most * sizeof *clipper->corner);
    clipper->reflex = malloc(most * sizeof *clipper->reflex);
    if (clipper->corner && clipper->reflex) return clipper;
    gd__ear_clipper_free(clipper);
    return NULL;
}

void gd__ear_clipper_free(struct gd__ear_clipper *clipper)
{
    if (!clipper) return;
    free(clipper->corner);
    free(clipper->reflex);
    free(clipper);
}

/* Is another reflex corner in the closed triangle of corner i, which is convex? */
static bool is_blocked(const struct gd__ear_clipper *clipper, uint32_t i)
{
    const struct gd__ring_corner *corner = clipper->corner, *b = &corner[i],
                                 *a = &corner[b->previous], *c = &corner[b->next];
    for (uint32_t r = 0; r < clipper->reflex_count; r++) {
        const struct gd__ring_corner *p = &corner[clipper->reflex[r]];
        if (p == a || p == b || p == c) continue;
        if (gd__ring_turn(a, b, p) >= 0 && gd__ring_turn(b, c, p) >= 0 &&
            gd__ring_turn(c, a, p) >= 0)
            return true;
    }
    return false;
}

static double score_of(const struct gd__ear_clipper *clipper, uint32_t i)
{
    const struct gd__ring_corner *corner = clipper->corner, *b = &corner[i],
                                 *a = &corner[b->previous], *c = &corner[b->next];
    if (!gd__ring_may_join(clipper->edges, a, c)) return NEVER;
    double quality = gd__ring_shape(a, b, c);
    const struct gd__ring_corner *opposite = &corner[c->next];
    bool convex = gd__ring_turn(a, b, c) > 0;
    if (clipper->left == 4) {
        quality = fmin(quality, gd__ring_shape(a, c, opposite));
        convex = convex && gd__ring_turn(a, c, opposite) > 0;
    }
    if (!convex) return quality - 2;
    return is_blocked(clipper, i) ? quality - 1 : quality;
}

static void update_reflex(struct gd__ear_clipper *clipper, uint32_t i, bool reflex)
{
    struct gd__ring_corner *c = &clipper->corner[i];
    if (reflex == (c->reflex_slot != GD_NONE)) return;
    if (reflex) {
        c->reflex_slot = clipper->reflex_count;
        clipper->reflex[clipper->reflex_count++] = i;
        return;
    }
    uint32_t moved = clipper->reflex[--clipper->reflex_count];
    clipper->reflex[c->reflex_slot] = moved;
    clipper->corner[moved].reflex_slot = c->reflex_slot;
    c->reflex_slot = GD_NONE;
}

static bool is_reflex(const struct gd__ear_clipper *clipper, uint32_t i)
{
    const struct gd__ring_corner *c = &clipper->corner[i];
    return gd__ring_turn(&clipper->corner[c->previous], c, &clipper->corner[c->next]) <= 0;
}

/* The corner of the highest score around the ring of `any`; of equal ones the first. */
static uint32_t best_corner(const struct gd__ear_clipper *clipper, uint32_t any)
{
    uint32_t best = any;
    for (uint32_t i = clipper->corner[any].next; i != any; i = clipper->corner[i].next) {
        if (clipper->corner[i].score > clipper->corner[best].score) best = i;
    }
    return best;
}

/* Takes corner i out of the ring; the scores of what it leaves are made new. */
static void cut_off(struct gd__ear_clipper *clipper, uint32_t i)
{
    uint32_t a = clipper->corner[i].previous, c = clipper->corner[i].next;
    update_reflex(clipper, i, false);
    clipper->corner[a].next = c;
    clipper->corner[c].previous = a;
    clipper->left--;
    update_reflex(clipper, a, is_reflex(clipper, a));
    update_reflex(clipper, c, is_reflex(clipper, c));
    clipper->corner[a].score = score_of(clipper, a);
    clipper->corner[c].score = score_of(clipper, c);
    if (clipper->left != 4) return;
    for (uint32_t k = clipper->corner[c].next; k != a; k = clipper->corner[k].next)
        clipper->corner[k].score = score_of(clipper, k);
}

static void emit(const struct gd__ear_clipper *clipper, uint32_t i, uint32_t triangle[3])
{
    const struct gd__ring_corner *c = &clipper->corner[i];
    triangle[0] = clipper->corner[c->previous].vertex;
    triangle[1] = c->vertex;
    triangle[2] = clipper->corner[c->next].vertex;
}

/* Cuts off ears until `stop` >= 3 corners are left. Returns a corner of what is left, GD_NONE when
 * no corner may be cut off. */
static uint32_t cut_ears(struct gd__ear_clipper *clipper, uint32_t stop, uint32_t (*triangle)[3])
{
    uint32_t at = 0;
    while (clipper->left > stop) {
        at = best_corner(clipper, at);
        if (clipper->corner[at].score == NEVER) return GD_NONE;
        emit(clipper, at, *triangle++);
        cut_off(clipper, at);
        at = clipper->corner[at].next;
    }
    return at;
}

static void start(struct gd__ear_clipper *clipper, const double (*positions)[3],
                  const uint32_t *vertex, uint32_t count)
{
    gd__ring_make(positions, vertex, count, clipper->corner);
    clipper->left = count;
    clipper->reflex_count = 0;
    for (uint32_t i = 0; i < count; i++) update_reflex(clipper, i, is_reflex(clipper, i));
    for (uint32_t i = 0; i < count; i++) clipper->corner[i].score = score_of(clipper, i);
}

bool gd__ear_clip(struct gd__ear_clipper *clipper, const double (*positions)[3],
                  const uint32_t *vertex, uint32_t count, const struct gd__edge_set *edges,
                  uint32_t (*triangle)[3])
{
    clipper->edges = edges;
    start(clipper, positions, vertex, count);
    uint32_t at = cut_ears(clipper, 3, triangle);
    if (at != GD_NONE) {
        emit(clipper, at, triangle[count - 3]);
        return true;
    }
    start(clipper, positions, vertex, count);
    at = cut_ears(clipper, GD_INTERVAL_MAX_CORNERS, triangle);
    return at != GD_NONE && gd__interval_cut(&clipper->table, clipper->corner, at, clipper->left,
                                             edges, triangle + (count - clipper->left));
}
