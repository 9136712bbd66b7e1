/* Guide: bounds of the distance from each vertex to one target, computed before windows are
 * propagated. Lower bounds serve to drop windows, and upper bounds limit the search.
 *
 * Lower bounds of the distance from a vertex v to the target t: the straight line in space, the
 * straight lines from ring to ring (kernel/ring.h), and |d(l, v) - d(l, t)| for each landmark l.
 * Upper bounds: A* finds shortest paths to the target in the graph of edges and of straight
 * segments across one edge. All bounds are rounded to the safe side. One guide, one thread. */
#pragma once

#include "window/predecessor.h"
#include "kernel/ring.h"

#define GD__LANDMARKS_MOST 32

struct gd__guide_node {
    /* length of the shortest known path from this vertex to the target, or GD__FAR if there is
       none */
    double upper;
    double lower; /* lower bound of the distance to the target; < 0 if not computed yet */
    /* the next vertex on the path whose length is `upper`; GD_NONE means that the path leads
       straight to the target */
    uint32_t parent;
    /* The entry of the parent's fan whose face is crossed by the path to the parent. GD_NONE means
     * that the path runs along an edge. */
    uint32_t across;
    bool closed, touched;
};

/* Bounds of a point's distance from each landmark, in steps. `low` is one step below the bound. */
struct gd__landmark_bounds {
    uint16_t low[GD__LANDMARKS_MOST], high[GD__LANDMARKS_MOST];
};

struct gd__guide_entry {
    double key;
    uint32_t vertex;
};

struct gd__guide {
    const struct gd_mesh *mesh;
    const struct gd_control *control; /* control of the search; may be NULL */
    uint32_t steps; /* steps since the search began; the control is checked at intervals */
    struct gd__anchor target;
    double margin;               /* rounding error of distances in space */
    struct gd__guide_node *node; /* for each vertex, its node; clean (GD__FAR) between searches */
    uint32_t capacity;
    uint32_t *touched; /* nodes to reset when the search ends */
    uint32_t touched_count, touched_capacity;
    struct gd__guide_entry *heap;
    uint32_t heap_count, heap_capacity;
    /* GD__LANDMARKS_MOST distances for each vertex in steps, rounded down, 0 for a missing
       landmark; NULL if there are no landmarks */
    const uint16_t *landmark;
    double landmark_step; /* length of a step; normalised unit */
    struct gd__landmark_bounds from_target, from_start;
    struct gd__rings rings;
};

/* Sets the target `to`, and finds paths to it in the region between `to` and `from`. The guide must
 * be all zero or must have been used before. Sets *upper to the length of a path between the two
 * points, rounded up. Both points must lie on one component. `control` is borrowed until the guide
 * is cleaned. Errors: GD_NO_MEMORY, GD_BUDGET, GD_DEADLINE, GD_CANCELLED. Cost: proportional to the
 * number of vertices that A* visits, which is a few percent of the vertices around the path. */
GD_MUST_USE enum gd_status gd__guide_aim(struct gd__guide *guide, const struct gd_mesh *mesh,
                                         const struct gd_point *from, const struct gd_point *to,
                                         const struct gd_control *control, double *upper);

/* Returns the bytes of memory that the guide holds. */
size_t gd__guide_held(const struct gd__guide *guide);

/* Returns the first vertex of the path from `from` that gd__guide_aim found. node[].parent has the
 * next vertex for each vertex of the path. */
uint32_t gd__guide_first(const struct gd__guide *guide, const struct gd_point *from);

/* Estimates the costs of two searches by the path that was found. Returns true if a search from the
 * target to `from` is probably cheaper than a search from `from` to the target. O(vertices of the
 * path). */
bool gd__guide_prefers_turn(const struct gd__guide *guide, const struct gd_point *from);

/* Makes `from` the target. Discards the path and most upper bounds. Keeps only the upper bounds of
 * the corners of the faces that contain `from`. Errors: those of gd__guide_aim. */
GD_MUST_USE enum gd_status gd__guide_turn(struct gd__guide *guide, const struct gd_point *from);

/* gd__guide_lower returns a lower bound of the distance from a vertex to the target. If the vertex
 * has no bound yet, it calls gd__guide_measure, which computes the bound. */
double gd__guide_measure(struct gd__guide *guide, uint32_t vertex);
static inline double gd__guide_lower(struct gd__guide *guide, uint32_t vertex)
{
    const struct gd__guide_node *node = &guide->node[vertex];
    return node->lower >= 0 ? node->lower : gd__guide_measure(guide, vertex);
}

/* Returns the length of the straight line in space from a vertex to one of the two ends, as a lower
 * bound of the distance. */
double gd__guide_line(const struct gd__guide *guide, uint32_t vertex, const struct gd__anchor *end);

/* Returns a lower bound, computed from landmarks, of the length of paths between the two ends that
 * pass a vertex. Without landmarks, returns 0. */
double gd__guide_whole(const struct gd__guide *guide, uint32_t vertex);

/* Discards the lower bounds that were computed so far. Each bound is computed again when it is used
 * next. Only for the files of this folder. O(vertices touched). */
void gd__guide_reset_lower(struct gd__guide *guide);

/* Makes room for one more entry after the `count` entries of one of the guide's arrays. The pointer
 * to the array is stored at the address `array`. Errors: GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__guide_make_room(const struct gd__guide *guide, void *array,
                                               uint32_t count, uint32_t *capacity, size_t size);

/* Counts a step of work and checks the control at intervals. Errors: GD_DEADLINE, GD_CANCELLED. */
GD_MUST_USE enum gd_status gd__guide_step(struct gd__guide *guide);

/* Resets the target, the landmarks and the control. Keeps memory for the next search. */
void gd__guide_clean(struct gd__guide *guide);
void gd__guide_destroy(struct gd__guide *guide);

/* --- rings.c: the rings of a guide ------------------------------------------------------------ */

/* Computes rings around the guide's target, as far as `from`, for a search of paths not longer than
 * `bound`. Does nothing if the existing bounds are good enough. Afterwards, lower bounds may be
 * larger than those returned before. Errors: GD_NO_MEMORY, GD_BUDGET, GD_DEADLINE, GD_CANCELLED.
 * Cost: about 100 ns for each vertex whose straight lines to both ends are within the bound. */
GD_MUST_USE enum gd_status gd__rings_draw(struct gd__guide *guide, const struct gd_point *from,
                                          double bound);

/* Returns a lower bound, computed from rings, of the distance from a vertex to the guide's target.
 * It may be negative. GD__FAR means that no path within the search's bound passes the vertex.
 * O(points of a ring). */
double gd__rings_lower(const struct gd__guide *guide, uint32_t vertex);

/* Discards all rings. */
void gd__rings_clean(struct gd__rings *rings);

/* Returns the bytes of memory that the rings hold. */
size_t gd__rings_held(const struct gd__rings *rings);

void gd__rings_destroy(struct gd__rings *rings);
