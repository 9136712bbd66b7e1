/* Guide: what is known of the way from anywhere to one target before windows are propagated: lower
 * bounds, which prune, and upper bounds, which shrink the bound of the search.
 *
 * Lower: the straight line in space, one from ring to ring (kernel/ring.h), and by landmarks |d(l,
 * v) - d(l, t)|. Upper: shortest paths to the target in the graph of edges and of straight ways
 * across one edge, found by A*. All are rounded to the safe side. Of one thread. */
#ifndef GD_GUIDE_GUIDE_H
#define GD_GUIDE_GUIDE_H

#include "window/predecessor.h"
#include "kernel/ring.h"

#define GD__LANDMARKS_MOST 16

struct gd__guide_node {
    double upper;    /* length of a path from this vertex to the target; GD__FAR: none is known */
    double lower;    /* the lower bound; < 0: not asked yet */
    uint32_t parent; /* the next vertex of that path; GD_NONE: the target is straight ahead */
    /* the entry of the parent's fan through whose face the path comes from beyond; GD_NONE: it goes
       along an edge */
    uint32_t across;
    bool closed, touched;
};

/* Bounds of a point's distance from each landmark. */
struct gd__guide_sight {
    float low[GD__LANDMARKS_MOST], high[GD__LANDMARKS_MOST];
};

struct gd__guide_entry {
    double key;
    uint32_t vertex;
};

struct gd__guide {
    const struct gd_mesh *mesh;
    const struct gd_control *control; /* of the search; may be NULL */
    uint32_t steps;                   /* since the search began: when to look at it */
    struct gd__anchor target;
    double margin;               /* of distances in space, for rounding */
    struct gd__guide_node *node; /* per vertex; clean (GD__FAR) between searches */
    uint32_t capacity;
    uint32_t *touched; /* nodes that are not clean */
    uint32_t touched_count, touched_capacity;
    struct gd__guide_entry *heap;
    uint32_t heap_count, heap_capacity;
    /* GD__LANDMARKS_MOST for each vertex, 0 where there is none; NULL: none */
    const float *landmark;
    struct gd__guide_sight from_target, from_start;
    struct gd__rings rings;
};

/* Aims at `to`, all zero or used before, and finds paths to it from what lies between it and
 * `from`. *upper: the length of a path between them, rounded up. Both lie on one component.
 * `control` is borrowed until the guide is cleaned. GD_NO_MEMORY, GD_BUDGET, GD_DEADLINE,
 * GD_CANCELLED. Cost: what A* visits, some percent of the way's surroundings. */
GD_MUST_USE enum gd_status gd__guide_aim(struct gd__guide *guide, const struct gd_mesh *mesh,
                                         const struct gd_point *from, const struct gd_point *to,
                                         const struct gd_control *control, double *upper);

/* Bytes that it holds for the mesh that it aims on. */
size_t gd__guide_held(const struct gd__guide *guide);

/* The first vertex of the path from `from` that gd__guide_aim found; the others follow by
 * node[].parent. */
uint32_t gd__guide_first(const struct gd__guide *guide, const struct gd_point *from);

/* Whether a search from the target for `from` would, as far as the path tells, have less to do than
 * one from there. O(vertices of the path). */
bool gd__guide_prefers_turn(const struct gd__guide *guide, const struct gd_point *from);

/* Aims at `from`, from which it was aimed; of upper bounds only those of its own corners are left,
 * and no path. Errors: those of gd__guide_aim. */
GD_MUST_USE enum gd_status gd__guide_turn(struct gd__guide *guide, const struct gd_point *from);

/* Lower bound of the distance from a vertex to the target. */
double gd__guide_measure(struct gd__guide *guide, uint32_t vertex); /* the first time */
static inline double gd__guide_lower(struct gd__guide *guide, uint32_t vertex)
{
    const struct gd__guide_node *node = &guide->node[vertex];
    return node->lower >= 0 ? node->lower : gd__guide_measure(guide, vertex);
}

/* Lower bound of the way from a vertex to one of the two ends, as the straight line tells it. */
double gd__guide_line(const struct gd__guide *guide, uint32_t vertex, const struct gd__anchor *end);

/* Of the sources of this room: lower bounds that were told before are measured again. O(vertices
 * touched). */
void gd__guide_ask_again(struct gd__guide *guide);

/* Makes room in one of its arrays for one entry behind `count`. GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__guide_make_room(const struct gd__guide *guide, void **array,
                                               uint32_t count, uint32_t *capacity, size_t size);

/* An entry of a fan or a vertex of a ring has been worked on: now and then looks at the control.
 * GD_DEADLINE, GD_CANCELLED. */
GD_MUST_USE enum gd_status gd__guide_step(struct gd__guide *guide);

/* Forgets the target, the landmarks and the control. */
void gd__guide_clean(struct gd__guide *guide);
void gd__guide_destroy(struct gd__guide *guide);

/* --- rings.c: the rings of a guide ------------------------------------------------------------ */

/* Draws rings round the guide's target out to `from`, for a search for ways that are no longer than
 * `bound`, where the bounds that there are leave too much to do; lower bounds that the guide told
 * already may rise. GD_NO_MEMORY, GD_BUDGET, GD_DEADLINE, GD_CANCELLED. Cost: some 100 ns for each
 * vertex from which the straight lines to both ends are within the bound. */
GD_MUST_USE enum gd_status gd__rings_draw(struct gd__guide *guide, const struct gd_point *from,
                                          double bound);

/* Lower bound of the way from a vertex to the guide's target, < 0 too, as far as rings tell;
 * GD__FAR: none within the bound passes it by. O(points of a ring). */
double gd__rings_lower(const struct gd__guide *guide, uint32_t vertex);

/* Forgets them. */
void gd__rings_clean(struct gd__rings *rings);

/* Bytes that they hold. */
size_t gd__rings_held(const struct gd__rings *rings);

void gd__rings_destroy(struct gd__rings *rings);

#endif
