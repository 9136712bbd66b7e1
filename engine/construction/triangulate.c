/* Converts polygons to triangles. The triangles of a polygon are consecutive. Each triangle of a
 * divided polygon has at least one new diagonal, so two polygons cannot give the same triangle. */
#include <stdlib.h>
#include <string.h>

#include "base/arena.h"
#include "base/large.h"
#include "construction/interval.h"
#include "construction/steps.h"

/* --- ears ------------------------------------------------------------------------------------- */

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

/* Each step searches the best ear among all corners. The time is quadratic, at most about 60 ms for
 * a polygon of this size. */
#define EAR_MAX_CORNERS 4096

#define NEVER (-INFINITY)

/* Working memory, which is reused from polygon to polygon. */
struct ear_clipper {
    struct gd__ring_corner *corner;
    uint32_t *reflex; /* the reflex corners: only these can lie in the triangle of an ear */
    uint32_t reflex_count;
    uint32_t left; /* number of corners in the ring */
    double least;  /* lowest score at which a corner may be cut off */
    const struct gd__edge_set *edges;
    struct gd__interval_table table;
};

/* p is a second occurrence of the vertex of b. Returns true if the ring enters or leaves p within
 * the angle at b between a and c. */
static bool is_within_angle(const struct ear_clipper *clipper, const struct gd__ring_corner *a,
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
static bool is_blocked(const struct ear_clipper *clipper, uint32_t i)
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

static double score_of(const struct ear_clipper *clipper, uint32_t i)
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

static void update_reflex(struct ear_clipper *clipper, uint32_t i, bool reflex)
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

static bool is_reflex(const struct ear_clipper *clipper, uint32_t i)
{
    const struct gd__ring_corner *c = &clipper->corner[i];
    return gd__ring_turn(&clipper->corner[c->previous], c, &clipper->corner[c->next]) <= 0;
}

/* Returns the corner with the highest score in the ring that contains `any`. In a tie, returns the
 * first one. */
static uint32_t best_corner(const struct ear_clipper *clipper, uint32_t any)
{
    uint32_t best = any;
    for (uint32_t i = clipper->corner[any].next; i != any; i = clipper->corner[i].next) {
        if (clipper->corner[i].score > clipper->corner[best].score) best = i;
    }
    return best;
}

/* Removes corner i from the ring and updates the scores of its neighbours. */
static void cut_off(struct ear_clipper *clipper, uint32_t i)
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

static void ear_emit(const struct ear_clipper *clipper, uint32_t i, uint32_t triangle[3])
{
    const struct gd__ring_corner *c = &clipper->corner[i];
    triangle[0] = clipper->corner[c->previous].vertex;
    triangle[1] = c->vertex;
    triangle[2] = clipper->corner[c->next].vertex;
}

/* Cuts off ears until `stop` corners are left, `stop` >= 3. Returns one of the corners that are
 * left, or GD_NONE if the process stops earlier because no corner may be cut off. */
static uint32_t cut_ears(struct ear_clipper *clipper, uint32_t stop, uint32_t (*triangle)[3])
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

static void start(struct ear_clipper *clipper, const double (*positions)[3], const uint32_t *vertex,
                  uint32_t count)
{
    gd__ring_make(positions, vertex, count, clipper->corner);
    clipper->left = count;
    clipper->reflex_count = 0;
    for (uint32_t i = 0; i < count; i++) update_reflex(clipper, i, is_reflex(clipper, i));
    for (uint32_t i = 0; i < count; i++) clipper->corner[i].score = score_of(clipper, i);
}

/* Returns a vertex that occurs twice in the ring, or GD_NONE. Quadratic time. */
static uint32_t repeated_corner(const uint32_t *vertex, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t k = 0; k < i; k++)
            if (vertex[k] == vertex[i]) return vertex[i];
    }
    return GD_NONE;
}

/* Triangulates the polygon of `count` >= 4 corners into count - 2 triangles that have the polygon's
 * orientation. Two vertices may occur twice: the ends of a bridge to a hole. No diagonal is an edge
 * in `edges` or has length zero. Ears inside the polygon (projected to its mean plane) are cut off
 * first, those with a good shape before others. Returns false if it finds no triangulation;
 * `triangle` is then undefined. */
static bool ear_clip(struct ear_clipper *clipper, const double (*positions)[3],
                     const uint32_t *vertex, uint32_t count, const struct gd__edge_set *edges,
                     uint32_t (*triangle)[3])
{
    /* where a ring touches itself, a corner that is not an ear may lie outside the polygon */
    bool is_simple = repeated_corner(vertex, count) == GD_NONE;
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

static uint32_t largest_polygon(const struct gd_polygons *polygons, struct gd__pace *pace,
                                uint32_t *which)
{
    uint32_t most = 0;
    GD__PACED (pace, i, polygons->polygon_count) {
        if (gd_polygons_size(polygons, i) <= most) continue;
        most = gd_polygons_size(polygons, i);
        *which = i;
    }
    return most;
}

static void insert_ring(struct gd__edge_set *edges, const uint32_t *corner, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        gd__edge_set_insert(edges, corner[i], corner[i + 1 < count ? i + 1 : 0]);
}

static enum gd_status refuse_split(struct gd__construction *work, uint32_t polygon,
                                   const uint32_t *corner, uint32_t count)
{
    uint32_t repeated = repeated_corner(corner, count);
    enum gd_status status = repeated == GD_NONE ? GD_NOT_TRIANGULABLE : GD_DEGENERATE_FACE;
    if (repeated == GD_NONE)
        gd_fail(work->detail, status,
                "face %u with %u corners can't be split into triangles: its diagonals are edges of "
                "other faces",
                polygon, count);
    else
        gd_fail(work->detail, status,
                "face %u has vertex %u as two of its corners, and is not a ring with a bridge to a "
                "hole: it can't be split into triangles",
                polygon, repeated);
    gd_detail_add(work->detail, GD_ELEMENT_FACE, polygon, 0);
    return status;
}

/* Triangulates one polygon into triangle[0 .. n-3] and adds its diagonals to the edge set. */
static enum gd_status triangulate_split(struct gd__construction *work, uint32_t polygon,
                                        struct ear_clipper *clipper, struct gd__edge_set *edges,
                                        uint32_t (*triangle)[3])
{
    const struct gd_polygons *polygons = work->polygons;
    uint32_t count = gd_polygons_size(polygons, polygon);
    const uint32_t *corner = polygons->corners + gd_polygons_first(polygons, polygon);
    if (count == 3) {
        memcpy(triangle, corner, sizeof *triangle);
        return GD_OK;
    }
    if (!ear_clip(clipper, (const double(*)[3])polygons->positions, corner, count, edges, triangle))
        return refuse_split(work, polygon, corner, count);
    for (uint32_t i = 0; i < count - 2; i++) insert_ring(edges, triangle[i], 3);
    return GD_OK;
}

/* Assigns face indices to the triangles of a polygon. A face index counts the triangles of the
 * input's polygons, before vertices are merged. If a polygon lost corners, its last indices are not
 * used. Returns the first index of the next polygon. */
static uint32_t name_triangles(struct gd__construction *work, uint32_t polygon, uint32_t made,
                               uint32_t index)
{
    uint32_t count = gd_polygons_size(work->polygons, polygon),
             end = index + gd_polygons_size(work->input, polygon) - 2;
    for (uint32_t k = 0; work->face_index && k + 2 < count; k++)
        work->face_index[made + k] = index + k;
    for (uint32_t i = index; work->mesh->source_polygon && i < end; i++)
        work->mesh->source_polygon[i] = polygon;
    return end;
}

static enum gd_status split_all(struct gd__construction *work, struct ear_clipper *clipper,
                                struct gd__edge_set *edges)
{
    const struct gd_polygons *polygons = work->polygons;
    GD__PACED (&work->pace, i, polygons->polygon_count)
        insert_ring(edges, polygons->corners + gd_polygons_first(polygons, i),
                    gd_polygons_size(polygons, i));
    uint32_t made = 0, index = 0;
    for (uint32_t i = 0; i < polygons->polygon_count; i++) {
        uint32_t size = gd_polygons_size(polygons, i);
        double done = (double)i / polygons->polygon_count;
        work->pace.fraction = work->progress + (work->progress_end - work->progress) * done;
        if (!gd__pace(&work->pace, size > 4 ? GD__PACE_STEPS : 16)) return work->pace.status;
        enum gd_status status =
            size ? triangulate_split(work, i, clipper, edges, work->triangle + made) : GD_OK;
        if (status) return status;
        index = name_triangles(work, i, made, index);
        if (size) made += size - 2;
    }
    return GD_OK;
}

static enum gd_status triangulate_polygons(struct gd__construction *work, uint32_t most_corners)
{
    struct gd_mesh *mesh = work->mesh;
    struct gd__edge_set edges = {0};
    struct gd__arena arena = {0};
    struct ear_clipper clipper = {
        .corner = gd__arena_take(&arena, most_corners, sizeof *clipper.corner),
        .reflex = gd__arena_take(&arena, most_corners, sizeof *clipper.reflex)};
    enum gd_status status = arena.status;
    /* the set must have room for all edges and all diagonals of the polygons */
    if (!status)
        status = gd__edge_set_create(gd_polygons_corner_count(work->polygons) +
                                         (uint64_t)mesh->face_count,
                                     &work->pace, &edges);
    if (!status) status = split_all(work, &clipper, &edges);
    gd__edge_set_free(&edges);
    gd__arena_free(&arena);
    return status;
}

/* Copies the corners, if all polygons are triangles. */
static void take_triangles(struct gd__construction *work)
{
    const uint32_t *corners = work->polygons->corners;
    GD__PACED (&work->pace, i, work->mesh->face_count)
        memcpy(work->triangle[i], corners + 3 * (size_t)i, sizeof *work->triangle);
    uint32_t made = 0, index = 0;
    if (!work->face_index) return;
    GD__PACED (&work->pace, i, work->polygons->polygon_count) {
        index = name_triangles(work, i, made, index);
        made += gd_polygons_size(work->polygons, i) > 0;
    }
}

static enum gd_status refuse_size(struct gd__construction *work, uint32_t polygon, uint32_t corners)
{
    gd_fail(work->detail, GD_UNSUPPORTED,
            "face %u has %u corners; at most %u are supported, split it", polygon, corners,
            EAR_MAX_CORNERS);
    gd_detail_add(work->detail, GD_ELEMENT_FACE, polygon, 0);
    return GD_UNSUPPORTED;
}

static uint32_t count_triangles(const struct gd_polygons *polygons, struct gd__pace *pace)
{
    uint32_t count = 0;
    GD__PACED (pace, i, polygons->polygon_count)
        count += gd_polygons_size(polygons, i) ? gd_polygons_size(polygons, i) - 2 : 0;
    return count;
}

enum gd_status gd__triangulate(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    bool edited = work->polygons != work->input;
    uint32_t which = 0, most_corners = largest_polygon(work->polygons, &work->pace, &which);
    if (most_corners > EAR_MAX_CORNERS) return refuse_size(work, which, most_corners);
    mesh->face_count = count_triangles(work->polygons, &work->pace);
    mesh->summary.face_index_count = count_triangles(work->input, &work->pace);
    if (!work->polygons->first && !work->options.repair_split) {
        work->triangle = (uint32_t(*)[3])work->polygons->corners;
        return GD_OK;
    }
    work->triangle = gd__large_array(mesh->face_count, sizeof *work->triangle);
    if (edited) work->face_index = gd__large_array(mesh->face_count, sizeof *work->face_index);
    if (!work->triangle || (edited && !work->face_index)) return GD_NO_MEMORY;
    if (largest_polygon(work->input, &work->pace, &which) > 3) {
        mesh->source_polygon =
            gd__mesh_array(work, mesh->summary.face_index_count, sizeof *mesh->source_polygon);
        if (!mesh->source_polygon) return GD_NO_MEMORY;
    }
    if (most_corners > 3) return triangulate_polygons(work, most_corners);
    take_triangles(work);
    return GD_OK;
}
