#include "base/prefetch.h"
#include "field/close_seed.h"
#include "field/wedge_view.h"
#include "kernel/kernel.h"
#include "mesh/segment.h"

/* Lines of a chunk that are prefetched together with its header, before its size is known. Waiting
 * for the header first would cost one more cache miss. Most chunks are shorter. */
enum { CACHE_LINE = 64, LINES_AT_ONCE = 7 };

/* The distance at a point of a face is a minimum over the face's corners, the seeds in the face,
 * and some wedges of its edges: those whose source lies on the other side of the edge. Paths from a
 * source on the face's own side reach the point through another edge or a corner. The search finds
 * the best candidate and only completes the leg of that candidate. */

/* --- views ----------------------------------------------------------------------------------- */

/* A face, seen from one of its points. */
struct view {
    const uint32_t *side;
    struct gd__local at[3]; /* the point in the frame of each side */
    uint32_t newest[3];     /* chunk of each side's edge */
};

enum { WEDGE_VIEWS = 8 }; /* views evaluated together; most points have one or two */

/* The position of the iteration over views: a side of the face, and a chunk of its edge. */
struct cursor {
    int k; /* 3 at the end */
    uint32_t chunk;
};

/* Prefetches the first lines of a chunk. They may lie beyond the chunk; a prefetch cannot fault. */
GD__PREFETCH prefetch_chunk(const struct gd_field *field, uint32_t chunk)
{
    const char *first = (const char *)gd__field_chunk(field, chunk);
    for (int i = 0; i < LINES_AT_ONCE; i++) __builtin_prefetch(first + i * CACHE_LINE);
}

static inline void view_face(const struct gd_field *field, uint32_t face, const double weight[3],
                             struct view *view)
{
    const struct gd_mesh *mesh = field->mesh;
    view->side = mesh->face_side[face];
    for (int k = 0; k < 3; k++) {
        view->newest[k] = field->newest[view->side[k] >> 1];
        if (view->newest[k] != GD_NONE) prefetch_chunk(field, view->newest[k]);
        view->at[k] =
            gd__side_local(&mesh->side[view->side[k]], weight[(k + 1) % 3], weight[(k + 2) % 3]);
    }
}

/* Prefetches the rest of the newest chunks. Their headers, which hold the sizes, must be in the
 * cache. */
GD__PREFETCH prefetch_rest(const struct gd_field *field, const struct view *view)
{
    for (int k = 0; k < 3; k++) {
        if (view->newest[k] == GD_NONE) continue;
        const struct gd__chunk *chunk = gd__field_chunk(field, view->newest[k]);
        const char *first = (const char *)chunk;
        size_t size = gd__chunk_bytes(chunk);
        for (size_t line = LINES_AT_ONCE * CACHE_LINE; line < size; line += CACHE_LINE)
            __builtin_prefetch(first + line);
    }
}

/* Fills the next views of a face, at most WEDGE_VIEWS, and returns their number. Writes a view for
 * each chunk. If a chunk's source is on the face's own side, the next view overwrites it. */
static inline uint32_t take_views(const struct gd_field *field, const struct view *view,
                                  struct cursor *cursor, struct gd__wedge_view *wedge_views)
{
    uint32_t count = 0;
    while (cursor->k < 3 && count < WEDGE_VIEWS) {
        int k = cursor->k;
        if (cursor->chunk == GD_NONE) {
            cursor->chunk = ++cursor->k < 3 ? view->newest[cursor->k] : GD_NONE;
            continue;
        }
        const struct gd__chunk *chunk = gd__field_chunk(field, cursor->chunk);
        struct gd__wedge_view *wedge_view = &wedge_views[count];
        wedge_view->chunk = chunk;
        wedge_view->length = field->mesh->side[view->side[k]].length;
        wedge_view->x = view->at[k].x;
        wedge_view->y = view->at[k].y;
        wedge_view->side = view->side[k];
        count += chunk->is_far == (view->side[k] & 1);
        cursor->chunk = gd__chunk_previous(chunk);
    }
    return count;
}

/* Returns the view kernel for the instructions in use, for a field with or without segments. */
static gd__wedge_view_kernel *wedge_view_kernel(bool linear)
{
    const struct gd__kernel *in_use = gd__kernel_in_use();
#if defined(__x86_64__)
    if (in_use == &gd__kernel_avx512)
        return linear ? gd__wedge_view_avx512_linear : gd__wedge_view_avx512;
    if (in_use == &gd__kernel_avx2)
        return linear ? gd__wedge_view_avx2_linear : gd__wedge_view_avx2;
#endif
    (void)in_use;
    return linear ? gd__wedge_view_plain_linear : gd__wedge_view_plain;
}

/* --- the best path ---------------------------------------------------------------------------- */

/* Keeps the shorter path. Branchless, because the branch is unpredictable. */
static inline void offer_way(struct gd__leg_key *best, double distance, enum gd__leg_kind kind,
                             uint32_t from)
{
    bool better = distance < best->distance;
    best->kind = better ? kind : best->kind;
    best->from = better ? from : best->from;
    best->distance = better ? distance : best->distance;
}

static inline void try_corner(const struct gd_field *field, uint32_t side, struct gd__local at,
                              struct gd__leg_key *best)
{
    uint32_t vertex = field->mesh->origin[side];
    offer_way(best, field->distance[vertex] + sqrt(at.x * at.x + at.y * at.y), GD__LEG_VERTEX,
              vertex);
}

/* Returns true if a seed ties with a vertex. The seed then wins, because the path to the seed
 * passes through the vertex. */
static inline bool seed_takes_tie(const struct gd__leg_key *best, double distance)
{
    return distance == best->distance && best->kind == GD__LEG_VERTEX;
}

/* Returns the distance of a point, given by its weights, from a seed in the same face. GD__FAR
 * means that the seed is a segment, and the perpendicular through the point misses it. */
static double distance_of_seed(const struct gd_mesh *mesh, const struct gd__seed *seed,
                               uint32_t face, const double to[3])
{
    if (seed->is_segment) {
        struct gd__local at = gd__face_local(mesh, mesh->face_side[face][0], to);
        struct gd__chord chord = gd__chord(mesh, face, 0, &seed->point, &seed->end);
        double foot = gd__chord_foot(&chord, at);
        return foot >= 0 && foot <= chord.length ? fabs(gd__chord_height(&chord, at)) : GD__FAR;
    }
    double from[3];
    gd__point_weights(mesh, &seed->point, face, from);
    return gd__local_length(gd__leg_key_in_face(mesh, face, gd__main_corner(from), from, to));
}

static void try_seeds(const struct gd_field *field, uint32_t face, const double weight[3],
                      struct gd__leg_key *best)
{
    struct gd__close_seed close;
    for (struct gd__face_seeds f = gd__field_seeds_in(field, face); f.at < f.end; f.at++) {
        const struct gd__seed *seed = &field->seeds[f.at->seed];
        double distance = seed->offset + distance_of_seed(field->mesh, seed, face, weight);
        if (distance < best->distance || seed_takes_tie(best, distance)) {
            best->distance = distance;
            best->kind = GD__LEG_SEED;
            best->from = f.at->seed;
        }
    }
    if (gd__close_seed_may_be(weight) &&
        gd__close_seed_find(field, face, weight, best->distance, &close)) {
        best->distance = close.distance;
        best->kind = GD__LEG_CLOSE;
        best->from = close.seed;
    }
}

/* Returns true if the path through a vertex is precise: the nearest source of the vertex is a point
 * seed, and each of the seed and the point of the face is at or near the vertex. */
static bool is_precise_through(const struct gd_field *field, uint32_t vertex, uint32_t face,
                               const double weight[3])
{
    uint32_t source = field->predecessor[vertex].source;
    struct gd__polar polar;
    const struct gd_point point = {GD_POINT_FACE, face, {weight[0], weight[1], weight[2]}};
    if (source < field->mesh->vertex_count || source == GD_NONE || gd__source_is_linear(source))
        return false;
    const struct gd__seed *seed = &field->seeds[gd__field_seed_of(field, source)];
    if (!gd__polar_around(field->mesh, &point, 0, &polar) || polar.vertex != vertex) return false;
    return seed->point.kind == GD_POINT_VERTEX ||
           (gd__polar_around(field->mesh, &seed->point, polar.radius, &polar) &&
            polar.vertex == vertex);
}

/* Returns the amount by which a path through a wedge must be shorter than the known path. A known
 * path is more precise than a path through a wedge if it satisfies two conditions: it is short
 * compared with the face, and it comes from a point seed, directly or through a vertex near both
 * the point and the seed. For such a path, the amount is the rounding error of positions in the
 * face, which is relative to the longest side. In all other cases the amount is 0. In particular,
 * it is 0 for a known path through another corner, because the length of such a path may be
 * slightly too large. */
static inline double margin_of(const struct gd_field *field, uint32_t face, const double weight[3],
                               const struct gd__leg_key *best)
{
    const struct gd_side *s = &field->mesh->side[field->mesh->face_side[face][0]];
    double length = fmax(s->length, fmax(s->left_length, s->right_length));
    if (best->distance >= GD_TOL_BESIDE_VERTEX * length) return 0;
    bool is_line = best->kind == GD__LEG_SEED && field->seeds[best->from].is_segment;
    bool is_other =
        best->kind == GD__LEG_VERTEX && !is_precise_through(field, best->from, face, weight);
    return is_line || is_other ? 0 : GD_TOL_BETTER * length;
}

static void best_in_face(const struct gd_field *field, uint32_t face, const double weight[3],
                         struct gd__leg_key *out)
{
    struct view view;
    struct gd__leg_key best = {.distance = GD__FAR, .kind = GD__LEG_NONE};
    view_face(field, face, weight, &view);
    for (int k = 0; k < 3; k++) try_corner(field, view.side[k], view.at[k], &best);
    prefetch_rest(field, &view);
    if (field->face_seed_count) try_seeds(field, face, weight, &best);
    double margin = margin_of(field, face, weight, &best);
    gd__wedge_view_kernel *kernel = wedge_view_kernel(field->has_segments);
    struct gd__wedge_view wedge_views[WEDGE_VIEWS];
    struct cursor cursor = {0, view.newest[0]};
    for (uint32_t passed = 0; cursor.k < 3;) {
        uint32_t count = take_views(field, &view, &cursor, wedge_views);
        struct gd__wedge_view_best seen = kernel(field, wedge_views, count, best.distance - margin);
        if (margin > 0 && seen.place == GD_NONE) seen.distance = best.distance;
        offer_way(&best, seen.distance, GD__LEG_WEDGE, passed + seen.place);
        margin = best.kind == GD__LEG_WEDGE ? 0 : margin;
        for (uint32_t s = 0; s < count && cursor.k < 3; s++) passed += wedge_views[s].chunk->count;
    }
    out->distance = best.distance;
    out->margin = margin;
    out->kind = best.kind;
    out->from = best.from;
    out->face = face;
}

/* Returns true if `way` is better than `best`, which ends in the other face of an edge. As inside a
 * face (margin_of), an imprecise path must be shorter than a precise one by the margin. */
static bool is_better(const struct gd__leg_key *way, const struct gd__leg_key *best)
{
    if ((way->margin > 0) != (best->margin > 0))
        return way->distance - way->margin < best->distance - best->margin;
    return way->distance < best->distance ||
           (way->kind == GD__LEG_SEED && seed_takes_tie(best, way->distance));
}

/* Finds the best path to a point of an edge, over the faces on both sides. */
static void best_at_edge(const struct gd_field *field, const struct gd_point *point,
                         struct gd__leg_key *best)
{
    const struct gd_mesh *mesh = field->mesh;
    best->distance = GD__FAR;
    best->margin = 0;
    best->kind = GD__LEG_NONE;
    for (uint32_t side = 2 * point->element; side < 2 * point->element + 2; side++) {
        uint32_t face = mesh->side_face[side];
        double weight[3];
        struct gd__leg_key way;
        if (face == GD_NONE) continue;
        gd__point_weights(mesh, point, face, weight);
        best_in_face(field, face, weight, &way);
        if (is_better(&way, best)) *best = way;
    }
}

void gd__field_leg_key(const struct gd_field *field, const struct gd_point *point,
                       struct gd__leg_key *out)
{
    switch (point->kind) {
    case GD_POINT_VERTEX:
        out->distance = field->distance[point->element];
        out->margin = 0;
        out->kind = out->distance < GD__FAR ? GD__LEG_VERTEX : GD__LEG_NONE;
        out->from = point->element;
        out->face = 0;
        break;
    case GD_POINT_EDGE:
        best_at_edge(field, point, out);
        break;
    case GD_POINT_FACE:
        best_in_face(field, point->element, point->weight, out);
        break;
    }
}

/* --- its last leg ----------------------------------------------------------------------------- */

/* Returns the parameter at which the straight line crosses the edge. The crossing is computed from
 * the end of the leg that is nearer to the edge, so that the rounding error is relative to the
 * distance of that end from the edge. */
static double straight_crossing(const struct gd__wedge_view *wedge_view, const struct gd__window *w)
{
    if (gd__window_is_linear(w)) return wedge_view->x + w->x * (wedge_view->y / w->y);
    double dx = wedge_view->x - w->x, dy = wedge_view->y + w->y;
    if (!(dy > 0)) return wedge_view->x;
    return w->y < wedge_view->y ? w->x + dx * (w->y / dy)
                                : wedge_view->x - dx * (wedge_view->y / dy);
}

/* Returns the parameter at which the path through a wedge crosses the edge: on the straight line,
 * or at the wedge's nearer end. The wedge is given as a window of the view's side. Stored ends are
 * rounded to one unit. Therefore a crossing within two units of an end counts as inside, because
 * the neighbouring wedge gives an equally short path there. This does not apply to linear
 * wedges. */
static double wedge_crossing(const struct gd__wedge_view *wedge_view,
                             const struct gd__window *wedge)
{
    double length = wedge_view->length,
           more = gd__window_is_linear(wedge) ? 0 : 2 * length * GD__WEDGE_UNIT;
    double from = fmax(wedge->b0 - more, 0), to = fmin(wedge->b1 + more, length),
           t = straight_crossing(wedge_view, wedge);
    return t < from ? from : t > to ? to : t;
}

/* Computes where the path through a wedge crosses its side, and the source in the side's frame. */
static void complete_wedge(const struct gd__wedge_view *wedge_view, uint32_t wedge,
                           struct gd__leg *leg)
{
    struct gd__wedges wedges = gd__chunk_wedges(wedge_view->chunk);
    struct gd__window w = gd__wedge_window(&wedges, wedge, wedge_view->length);
    if (wedge_view->side & 1) w = gd__window_mirrored(&w, wedge_view->length);
    leg->side = wedge_view->side;
    leg->source = w.source;
    leg->x = w.x;
    leg->y = w.y;
    leg->parameter = wedge_crossing(wedge_view, &w);
}

/* Finds the wedge that the search counted as number `place`, and completes the leg. */
static void find_wedge(const struct gd_field *field, const struct gd_point *point, uint32_t place,
                       struct gd__leg *leg)
{
    double weight[3];
    gd__point_weights(field->mesh, point, leg->face, weight);
    struct view view;
    view_face(field, leg->face, weight, &view);
    struct gd__wedge_view wedge_views[WEDGE_VIEWS];
    struct cursor cursor = {0, view.newest[0]};
    while (cursor.k < 3) {
        uint32_t count = take_views(field, &view, &cursor, wedge_views);
        for (uint32_t s = 0; s < count; s++) {
            if (place < wedge_views[s].chunk->count) {
                complete_wedge(&wedge_views[s], place, leg);
                return;
            }
            place -= wedge_views[s].chunk->count;
        }
    }
}

struct gd__leg gd__field_leg(const struct gd_field *field, const struct gd_point *point)
{
    struct gd__leg_key way;
    gd__field_leg_key(field, point, &way);
    struct gd__leg leg = {
        .distance = way.distance, .kind = way.kind, .face = way.face, .source = GD_NONE};
    if (way.kind == GD__LEG_WEDGE)
        find_wedge(field, point, way.from, &leg);
    else
        leg.from = way.from;
    return leg;
}

/* Returns true if the path to `to` runs along an edge from `vertex`, or if `to` is `vertex`. */
static bool leads_back(const struct gd_field *field, uint32_t to, uint32_t vertex)
{
    return to == vertex ||
           (field->predecessor[to].side == GD_NONE && field->predecessor[to].source == vertex);
}

struct gd__leg gd__field_leg_onward(const struct gd_field *field, const struct gd_point *bend,
                                    uint32_t vertex)
{
    struct gd__leg leg = gd__field_leg(field, bend);
    bool is_lost =
        leg.kind == GD__LEG_VERTEX && vertex != GD_NONE && leads_back(field, leg.from, vertex);
    if (!is_lost || bend->kind != GD_POINT_EDGE) return leg;
    const struct gd_mesh *mesh = field->mesh;
    double least = GD__FAR, length = mesh->side[2 * bend->element].length;
    for (int k = 0; k < 2; k++) {
        uint32_t end = mesh->origin[2 * bend->element + k];
        double distance =
            field->distance[end] + (k ? gd__edge_rest(bend) : bend->weight[0]) * length;
        if (distance >= least || leads_back(field, end, vertex)) continue;
        least = distance;
        leg.from = end;
    }
    return leg;
}
