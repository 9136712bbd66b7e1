/* DESIGN. The polygon is projected to its Newell plane, where it runs counter-clockwise, and stored
 * as a ring of corners. Each corner has a score, which rates the triangle (previous, corner, next).
 * The triangle with the best score is cut off next:
 *
 *   -INFINITY        the diagonal exists already or has length zero: never cut
 *   shape - 2        the corner is reflex in the plane
 *   shape - 1        the corner is convex, but its triangle contains another corner
 *   shape, in [0,1]  an ear
 *
 * shape is 4 sqrt(3) area / (sum of squared sides) in space: 1 for an equilateral triangle. If four
 * corners are left, cutting one off determines both triangles, and the worse of the two counts. A
 * cut changes only the triangles of the two neighbouring corners. All other triangles still contain
 * the same corners, so only the two neighbours can become ears.
 *
 * This greedy order can end with corners that may not be cut off, although another order would
 * succeed. Then the ears are cut again, and an exhaustive search (interval.c) handles the last
 * corners. */
#include "construction/ear.h"

#include <stdlib.h>

#include "construction/interval.h"
#include "construction/ring.h"

#define NEVER (-INFINITY)

struct gd__ear_clipper {
    struct gd__ring_corner *corner;
    uint32_t *reflex; /* the reflex corners: only these can lie in the triangle of an ear */
    uint32_t reflex_count;
    uint32_t left; /* number of corners in the ring */
    double least;  /* lowest score at which a corner may be cut off */
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

/* p is a second occurrence of the vertex of b. Returns true if the ring enters or leaves p within
 * the angle at b between a and c. */
static bool is_within_angle(const struct gd__ear_clipper *clipper, const struct gd__ring_corner *a,
                            const struct gd__ring_corner *b, const struct gd__ring_corner *c,
                            const struct gd__ring_corner *p)
{
    const uint32_t ends[] = {p->previous, p->next};
    for (int i = 0; i < 2; i++) {
        const struct gd__ring_corner *q = &clipper->corner[ends[i]];
        if (q->vertex != a->vertex && q->vertex != c->vertex && gd__ring_turn(a, b, q) > 0 &&
            gd__ring_turn(b, c, q) > 0)
            return true;
    }
    return false;
}

/* Returns true if the triangle of the convex corner i, or its border, contains a reflex corner. */
static bool is_blocked(const struct gd__ear_clipper *clipper, uint32_t i)
{
    const struct gd__ring_corner *corner = clipper->corner, *b = &corner[i],
                                 *a = &corner[b->previous], *c = &corner[b->next];
    for (uint32_t r = 0; r < clipper->reflex_count; r++) {
        const struct gd__ring_corner *p = &corner[clipper->reflex[r]];
        if (p == b || p->vertex == a->vertex || p->vertex == c->vertex) continue;
        if (p->vertex == b->vertex) {
            if (is_within_angle(clipper, a, b, c, p)) return true;
            continue;
        }
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

/* Returns the corner with the highest score in the ring that contains `any`. In a tie, returns the
 * first one. */
static uint32_t best_corner(const struct gd__ear_clipper *clipper, uint32_t any)
{
    uint32_t best = any;
    for (uint32_t i = clipper->corner[any].next; i != any; i = clipper->corner[i].next) {
        if (clipper->corner[i].score > clipper->corner[best].score) best = i;
    }
    return best;
}

/* Removes corner i from the ring and updates the scores of its neighbours. */
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

static void ear_emit(const struct gd__ear_clipper *clipper, uint32_t i, uint32_t triangle[3])
{
    const struct gd__ring_corner *c = &clipper->corner[i];
    triangle[0] = clipper->corner[c->previous].vertex;
    triangle[1] = c->vertex;
    triangle[2] = clipper->corner[c->next].vertex;
}

/* Cuts off ears until `stop` corners are left, `stop` >= 3. Returns one of the corners that are
 * left, or GD_NONE if the process stops earlier because no corner may be cut off. */
static uint32_t cut_ears(struct gd__ear_clipper *clipper, uint32_t stop, uint32_t (*triangle)[3])
{
    uint32_t at = 0;
    while (clipper->left > stop) {
        at = best_corner(clipper, at);
        if (clipper->corner[at].score < clipper->least) return GD_NONE;
        ear_emit(clipper, at, *triangle++);
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

uint32_t gd__repeated_corner(const uint32_t *vertex, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t k = 0; k < i; k++)
            if (vertex[k] == vertex[i]) return vertex[i];
    }
    return GD_NONE;
}

bool gd__ear_clip(struct gd__ear_clipper *clipper, const double (*positions)[3],
                  const uint32_t *vertex, uint32_t count, const struct gd__edge_set *edges,
                  uint32_t (*triangle)[3])
{
    /* where a ring touches itself, a corner that is not an ear may lie outside the polygon */
    bool is_simple = gd__repeated_corner(vertex, count) == GD_NONE;
    clipper->edges = edges;
    clipper->least = is_simple ? -2 : 0;
    start(clipper, positions, vertex, count);
    uint32_t at = cut_ears(clipper, 3, triangle);
    if (at != GD_NONE) {
        ear_emit(clipper, at, triangle[count - 3]);
        return true;
    }
    if (!is_simple) return false;
    start(clipper, positions, vertex, count);
    at = cut_ears(clipper, GD_INTERVAL_MAX_CORNERS, triangle);
    return at != GD_NONE && gd__interval_cut(&clipper->table, clipper->corner, at, clipper->left,
                                             edges, triangle + (count - clipper->left));
}
