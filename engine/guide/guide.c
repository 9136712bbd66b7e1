#include "guide/guide.h"

#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "base/large.h"
#include "base/tolerance.h"
#include "base/prefetch.h"
#include "mesh/closest_point.h"

/* Weights by which A* multiplies lower bounds of the remaining distance. GREED: weight of the
 * straight line in space, if there are no landmarks. LINE_GREED and LANDMARKS_GREED: weights of the
 * straight line and of the landmarks' bound, if there are landmarks. With a weight above 1, A*
 * finds a path at a fraction of the cost. The path may be slightly too long, but it is straightened
 * afterwards. */
#define GREED           1.2
#define LINE_GREED      1.1
#define LANDMARKS_GREED 1.05

/* Number of fan entries or ring vertices between two checks of the control. Processing them takes
 * well under a millisecond. */
#define CHECK_INTERVAL 1024

/* --- nodes ------------------------------------------------------------------------------------ */

size_t gd__guide_held(const struct gd__guide *guide)
{
    return (size_t)guide->mesh->vertex_count * sizeof *guide->node +
           guide->touched_capacity * sizeof *guide->touched +
           guide->heap_capacity * sizeof *guide->heap + gd__rings_held(&guide->rings);
}

enum gd_status gd__guide_make_room(const struct gd__guide *guide, void *array, uint32_t count,
                                   uint32_t *capacity, size_t size)
{
    if (count < *capacity) return GD_OK;
    uint32_t larger = count < 512 ? 1024 : 2 * count;
    enum gd_status status =
        gd_control_afford(guide->control, gd__guide_held(guide) + larger * size);
    return status ? status : gd__array_extend(array, capacity, larger, size, NULL);
}

static enum gd_status touch_vertex(struct gd__guide *guide, uint32_t vertex)
{
    if (guide->node[vertex].touched) return GD_OK;
    enum gd_status status = gd__guide_make_room(guide, &guide->touched, guide->touched_count,
                                                &guide->touched_capacity, sizeof *guide->touched);
    if (status) return status;
    guide->touched[guide->touched_count++] = vertex;
    guide->node[vertex].touched = true;
    return GD_OK;
}

/* --- lower bounds ----------------------------------------------------------------------------- */

/* Returns a lower bound of the distance from a vertex to a point. `bounds` has the bounds of the
 * point's distances from the landmarks. The vertex' own distance is at most one step larger than
 * stored. The loops have no branches and a fixed number of landmarks, so that compilers vectorise
 * them. */
static double landmark_bound(const struct gd__guide *guide,
                             const struct gd__landmark_bounds *bounds, uint32_t vertex)
{
    const uint16_t *distance = guide->landmark + (size_t)GD__LANDMARKS_MOST * vertex;
    uint16_t bound[GD__LANDMARKS_MOST];
    for (int i = 0; i < GD__LANDMARKS_MOST; i++) {
        uint16_t d = distance[i], low = bounds->low[i], high = bounds->high[i];
        uint16_t nearer = low > d ? low - d : 0, farther = d > high ? d - high : 0;
        bound[i] = nearer > farther ? nearer : farther;
    }
    for (int half = GD__LANDMARKS_MOST / 2; half > 0; half /= 2)
        for (int i = 0; i < half; i++)
            bound[i] = bound[i] > bound[i + half] ? bound[i] : bound[i + half];
    return (bound[0] - GD_TOL_LANDMARK) * guide->landmark_step;
}

double gd__guide_line(const struct gd__guide *guide, uint32_t vertex, const struct gd__anchor *end)
{
    return gd_vec3_distance(guide->mesh->position[vertex], end->position) * (1 - GD_TOL_BOUND) -
           guide->margin;
}

double gd__guide_whole(const struct gd__guide *guide, uint32_t vertex)
{
    if (!guide->landmark) return 0;
    return landmark_bound(guide, &guide->from_target, vertex) +
           landmark_bound(guide, &guide->from_start, vertex);
}

/* Returns a lower bound of the distance from a vertex to one of the two ends. */
static double rest_to(const struct gd__guide *guide, uint32_t vertex, const struct gd__anchor *end,
                      const struct gd__landmark_bounds *bounds)
{
    double line = gd__guide_line(guide, vertex, end);
    return guide->landmark ? fmax(line, landmark_bound(guide, bounds, vertex)) : line;
}

double gd__guide_measure(struct gd__guide *guide, uint32_t vertex)
{
    double lower = rest_to(guide, vertex, &guide->target, &guide->from_target);
    if (guide->rings.count) lower = fmax(lower, gd__rings_lower(guide, vertex));
    if (lower < 0) lower = 0;
    /* if there is no memory, the bound is not stored, and is computed each time */
    if (touch_vertex(guide, vertex)) return lower;
    return guide->node[vertex].lower = lower;
}

void gd__guide_reset_lower(struct gd__guide *guide)
{
    for (uint32_t i = 0; i < guide->touched_count; i++) guide->node[guide->touched[i]].lower = -1;
}

/* Computes the bounds of a point's distances from the landmarks. Uses the distances of the corners
 * around the point. Landmarks in other components give no bound. */
static void read_landmarks(const struct gd__guide *guide, const struct gd__anchor *point,
                           struct gd__landmark_bounds *out)
{
    for (uint32_t i = 0; i < GD__LANDMARKS_MOST && guide->landmark; i++) {
        double low = 0, high = UINT16_MAX;
        for (int k = 0; k < 4 && point->corner[k] != GD_NONE; k++) {
            double d = guide->landmark[(size_t)GD__LANDMARKS_MOST * point->corner[k] + i],
                   leg = point->leg[k] / guide->landmark_step;
            low = fmax(low, floor(d - leg) - 1);
            high = fmin(high, ceil(d + 1 + leg));
        }
        out->low[i] = (uint16_t)low;
        out->high[i] = (uint16_t)high;
    }
}

/* --- search for paths ------------------------------------------------------------------------- */

static void sift_up(struct gd__guide *guide, uint32_t at)
{
    struct gd__guide_entry entry = guide->heap[at];
    for (; at > 0 && guide->heap[(at - 1) / 2].key > entry.key; at = (at - 1) / 2)
        guide->heap[at] = guide->heap[(at - 1) / 2];
    guide->heap[at] = entry;
}

static uint32_t heap_pop(struct gd__guide *guide)
{
    uint32_t vertex = guide->heap[0].vertex, count = --guide->heap_count, at = 0;
    struct gd__guide_entry entry = guide->heap[count];
    for (uint32_t child; (child = 2 * at + 1) < count; at = child) {
        /* Selects the smaller child without a branch. To do so, the code may read the removed entry
         * behind the last entry. */
        child += (child + 1 < count) & (guide->heap[child + 1].key < guide->heap[child].key);
        if (guide->heap[child].key >= entry.key) break;
        guide->heap[at] = guide->heap[child];
    }
    guide->heap[at] = entry;
    return vertex;
}

/* A path from a vertex to the target, which is offered to this vertex. */
struct offer {
    double upper;
    uint32_t parent, across; /* as in struct gd__guide_node */
};

/* Offers the path to the vertex. The key includes the lower bound of the distance to `from`. A
 * vertex that was expanded is not expanded again, because this would cost more than a slightly
 * longer path. */
static enum gd_status relax_vertex(struct gd__guide *guide, uint32_t vertex, struct offer offer,
                                   const struct gd_vec3 *from)
{
    struct gd__guide_node *node = &guide->node[vertex];
    if (node->closed || offer.upper >= node->upper) return GD_OK;
    enum gd_status status = touch_vertex(guide, vertex);
    if (!status)
        status = gd__guide_make_room(guide, &guide->heap, guide->heap_count, &guide->heap_capacity,
                                     sizeof *guide->heap);
    if (status) return status;
    node->upper = offer.upper;
    node->parent = offer.parent;
    node->across = offer.across;
    double line = gd_vec3_distance(guide->mesh->position[vertex], *from), rest = GREED * line;
    if (guide->landmark)
        rest = fmax(LINE_GREED * line,
                    LANDMARKS_GREED * landmark_bound(guide, &guide->from_start, vertex));
    __builtin_prefetch(&guide->mesh->fan_first[vertex]);
    guide->heap[guide->heap_count] = (struct gd__guide_entry){offer.upper + rest, vertex};
    sift_up(guide, guide->heap_count++);
    return GD_OK;
}

/* Let a-b be the edge opposite to a vertex, and `beyond` the apex of the face on the other side of
 * a-b. Returns the length of the straight segment from the vertex across a-b to `beyond`, or
 * GD__FAR if the segment misses the edge. Computes it from positions, which A* loads anyway,
 * because loading the records of sides would cause cache misses. */
static double way_across(const struct gd_vec3 *vertex, const struct gd_vec3 *a,
                         const struct gd_vec3 *b, const struct gd_vec3 *beyond)
{
    struct gd_vec3 edge = gd_vec3_sub(*b, *a), near = gd_vec3_sub(*vertex, *a),
                   far = gd_vec3_sub(*beyond, *a);
    double length = gd_vec3_length(edge);
    struct gd_vec3 along = gd_vec3_scale(edge, 1 / length);
    double x = gd_vec3_dot(near, along), dx = gd_vec3_dot(far, along) - x,
           y = gd_vec3_length(gd_vec3_cross(near, along)),
           dy = y + gd_vec3_length(gd_vec3_cross(far, along)), t = x + dx * y / dy;
    return t > 0 && t < length ? sqrt(dx * dx + dy * dy) : GD__FAR;
}

/* Offers the segment across the face of a fan entry to the corner beyond this face. Skips it if
 * even the straight line in space would not give this corner a shorter path. */
static enum gd_status relax_across(struct gd__guide *guide, uint32_t vertex, uint32_t entry,
                                   const struct gd_vec3 *from)
{
    const struct gd_mesh *mesh = guide->mesh;
    const struct gd_vec3 *p = mesh->position;
    uint32_t beyond = mesh->beyond[entry], next = entry + 1;
    double upper = guide->node[vertex].upper;
    if (beyond == GD_NONE || guide->node[beyond].closed) return GD_OK;
    if (upper + gd_vec3_distance(p[vertex], p[beyond]) >= guide->node[beyond].upper) return GD_OK;
    if (next == gd__neighbours_end(mesh, vertex)) next = mesh->fan_first[vertex];
    double way = way_across(&p[vertex], &p[mesh->fan[entry].tip],
                            &p[gd__neighbour(mesh, vertex, next)], &p[beyond]);
    return relax_vertex(guide, beyond, (struct offer){upper + way, vertex, entry}, from);
}

enum gd_status gd__guide_step(struct gd__guide *guide)
{
    return ++guide->steps % CHECK_INTERVAL ? GD_OK : gd_control_check(guide->control, 0);
}

/* Prefetches the nodes of the neighbours of a vertex and of the corners beyond its faces. Most of
 * the waiting time of A* comes from cache misses of these nodes. */
GD__PREFETCH guide_prefetch(const struct gd__guide *guide, uint32_t vertex)
{
    const struct gd_mesh *mesh = guide->mesh;
    for (uint32_t i = mesh->fan_first[vertex]; i < mesh->fan_first[vertex + 1]; i++) {
        uint32_t tip = mesh->fan[i].tip, beyond = mesh->beyond[i];
        __builtin_prefetch(&guide->node[tip]);
        __builtin_prefetch(&mesh->position[tip]);
        if (beyond == GD_NONE) continue;
        __builtin_prefetch(&guide->node[beyond]);
        __builtin_prefetch(&mesh->position[beyond]);
    }
}

/* Prefetches the fan of the vertex that will probably be expanded next. */
GD__PREFETCH prefetch_expansion(const struct gd__guide *guide, uint32_t vertex)
{
    const struct gd_mesh *mesh = guide->mesh;
    uint32_t first = mesh->fan_first[vertex];
    __builtin_prefetch(&mesh->fan[first]);
    __builtin_prefetch(&mesh->fan[first + 4]);
    __builtin_prefetch(&mesh->beyond[first]);
}

static enum gd_status expand_vertex(struct gd__guide *guide, uint32_t vertex,
                                    const struct gd_vec3 *from)
{
    const struct gd_mesh *mesh = guide->mesh;
    uint32_t first = mesh->fan_first[vertex];
    double upper = guide->node[vertex].upper;
    enum gd_status status = GD_OK;
    guide->node[vertex].closed = true;
    guide_prefetch(guide, vertex);
    if (guide->heap_count) prefetch_expansion(guide, guide->heap[0].vertex);
    for (uint32_t i = first; i < gd__neighbours_end(mesh, vertex) && !status; i++) {
        uint32_t tip = gd__neighbour(mesh, vertex, i);
        struct offer along = {upper + gd_vec3_distance(mesh->position[vertex], mesh->position[tip]),
                              vertex, GD_NONE};
        status = gd__guide_step(guide);
        if (!status) status = relax_vertex(guide, tip, along, from);
    }
    for (uint32_t i = first; i < mesh->fan_first[vertex + 1] && !status; i++)
        status = relax_across(guide, vertex, i, from);
    return status;
}

/* Returns the length of the shortest known path from a point to the target, and sets *first to the
 * first vertex of this path. */
static double best_way(const struct gd__guide *guide, const struct gd__anchor *from,
                       uint32_t *first)
{
    double best = GD__FAR;
    *first = GD_NONE;
    for (int k = 0; k < 4 && from->corner[k] != GD_NONE; k++) {
        double way = guide->node[from->corner[k]].upper + from->leg[k];
        if (way < best) *first = from->corner[k];
        best = fmin(best, way);
    }
    return best;
}

uint32_t gd__guide_first(const struct gd__guide *guide, const struct gd_point *from)
{
    struct gd__anchor start = gd__anchor(guide->mesh, from);
    uint32_t first;
    best_way(guide, &start, &first);
    return first;
}

static enum gd_status search_upper_bound(struct gd__guide *guide, const struct gd__anchor *from,
                                         double *upper)
{
    uint32_t first;
    enum gd_status status = GD_OK;
    for (int k = 0; k < 4 && guide->target.corner[k] != GD_NONE && !status; k++)
        status =
            relax_vertex(guide, guide->target.corner[k],
                         (struct offer){guide->target.leg[k], GD_NONE, GD_NONE}, &from->position);
    *upper = best_way(guide, from, &first);
    while (!status && guide->heap_count && guide->heap[0].key < *upper) {
        uint32_t vertex = heap_pop(guide);
        if (guide->node[vertex].closed) continue;
        status = expand_vertex(guide, vertex, &from->position);
        for (int k = 0; k < 4 && from->corner[k] != GD_NONE; k++)
            if (from->corner[k] == vertex)
                *upper = fmin(*upper, guide->node[vertex].upper + from->leg[k]);
    }
    guide->heap_count = 0;
    return status;
}

/* --- target ----------------------------------------------------------------------------------- */

static void clean_node(struct gd__guide_node *node)
{
    *node = (struct gd__guide_node){
        .upper = GD__FAR, .lower = -1, .parent = GD_NONE, .across = GD_NONE};
}

static void clean_touched(struct gd__guide *guide)
{
    for (uint32_t i = 0; i < guide->touched_count; i++) clean_node(&guide->node[guide->touched[i]]);
    guide->touched_count = 0;
}

static enum gd_status open_nodes(struct gd__guide *guide, const struct gd_mesh *mesh)
{
    enum gd_status status = gd_control_afford(guide->control, gd__guide_held(guide));
    if (status || mesh->vertex_count <= guide->capacity) return status;
    free(guide->node);
    guide->capacity = 0;
    guide->node = gd__large_array(mesh->vertex_count, sizeof *guide->node);
    if (!guide->node) return GD_NO_MEMORY;
    guide->capacity = mesh->vertex_count;
    for (uint32_t v = 0; v < guide->capacity; v++) clean_node(&guide->node[v]);
    return GD_OK;
}

enum gd_status gd__guide_aim(struct gd__guide *guide, const struct gd_mesh *mesh,
                             const struct gd_point *from, const struct gd_point *to,
                             const struct gd_control *control, double *upper)
{
    struct gd__anchor start = gd__anchor(mesh, from);
    guide->mesh = mesh;
    guide->control = control;
    guide->steps = 0;
    enum gd_status status = open_nodes(guide, mesh);
    if (status) return status;
    guide->target = gd__anchor(mesh, to);
    guide->margin = GD_TOL_BOUND * fmax(gd__largest_coordinate(guide->target.position),
                                        gd__largest_coordinate(start.position));
    read_landmarks(guide, &guide->target, &guide->from_target);
    read_landmarks(guide, &start, &guide->from_start);
    status = search_upper_bound(guide, &start, upper);
    if (!status) *upper *= 1 + GD_TOL_BOUND;
    return status;
}

/* --- choice of the end ------------------------------------------------------------------------ */

/* Returns the estimated work of a search per unit of the path's length, at one point of the path.
 * The width of the searched strip is about the square root of `rest` - `lower`, where `rest` is the
 * remaining length and `lower` its lower bound. The number of windows grows with `run`, the
 * distance from the search's source. */
static double work_at(double run, double rest, double lower)
{
    return sqrt(run * fmax(rest - lower, 0));
}

bool gd__guide_prefers_turn(const struct gd__guide *guide, const struct gd_point *from)
{
    const struct gd__anchor start = gd__anchor(guide->mesh, from);
    uint32_t v;
    double whole = best_way(guide, &start, &v), forth = 0, back = 0;
    for (; v != GD_NONE; v = guide->node[v].parent) {
        const struct gd__guide_node *node = &guide->node[v];
        double step = node->upper - (node->parent == GD_NONE ? 0 : guide->node[node->parent].upper),
               run = whole - node->upper;
        forth += step *
                 work_at(run, node->upper, rest_to(guide, v, &guide->target, &guide->from_target));
        back += step * work_at(node->upper, run, rest_to(guide, v, &start, &guide->from_start));
    }
    return back < forth;
}

enum gd_status gd__guide_turn(struct gd__guide *guide, const struct gd_point *from)
{
    const struct gd__landmark_bounds bounds = guide->from_target;
    enum gd_status status = GD_OK;
    clean_touched(guide);
    guide->target = gd__anchor(guide->mesh, from);
    guide->from_target = guide->from_start;
    guide->from_start = bounds;
    for (int k = 0; k < 4 && guide->target.corner[k] != GD_NONE && !status; k++) {
        status = touch_vertex(guide, guide->target.corner[k]);
        if (!status) guide->node[guide->target.corner[k]].upper = guide->target.leg[k];
    }
    return status;
}

void gd__guide_clean(struct gd__guide *guide)
{
    clean_touched(guide);
    gd__rings_clean(&guide->rings);
    guide->heap_count = 0;
    guide->landmark = NULL;
    guide->control = NULL;
}

void gd__guide_destroy(struct gd__guide *guide)
{
    free(guide->node);
    free(guide->touched);
    free(guide->heap);
    gd__rings_destroy(&guide->rings);
    *guide = (struct gd__guide){0};
}
