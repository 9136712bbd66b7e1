#include "field/close.h"
#include "field/wedge_view.h"
#include "mesh/segment.h"

enum { CACHE_LINE = 64 };

/* The distance at a point of a face: the least over the face's corners, the seeds in the face, and
 * the wedges of its edges whose source lies across the edge (a source on the face's own side
 * reaches the point through another edge or through a corner). The search finds which of them it
 * is; the leg is made of that one alone. */

/* --- views ----------------------------------------------------------------------------------- */

/* A face from a point of it. */
struct view {
    const uint32_t *side;
    struct gd__local at[3]; /* the point in the frame of each side */
    uint32_t newest[3];     /* chunk of each side's edge */
};

enum { WEDGE_VIEWS = 8 }; /* that are looked at together: mostly there are one or two */

/* Where taking views has got to: a side of the view, and a chunk of its edge. */
struct cursor {
    int k; /* 3: there are no more */
    uint32_t chunk;
};

static inline void look_around(const struct gd_field *field, uint32_t face, const double weight[3],
                               struct view *view)
{
    const struct gd_mesh *mesh = field->mesh;
    view->side = mesh->face_side[face];
    for (int k = 0; k < 3; k++) {
        view->newest[k] = field->newest[view->side[k] >> 1];
        if (view->newest[k] != GD_NONE) __builtin_prefetch(gd__field_chunk(field, view->newest[k]));
        view->at[k] =
            gd__side_local(&mesh->side[view->side[k]], weight[(k + 1) % 3], weight[(k + 2) % 3]);
    }
}

/* Asks for all wedges of the newest chunks, now that their sizes are known. GCC takes a function
 * that does nothing but prefetch for one without effects and leaves its calls out, unless it is
 * inlined first. */
static inline __attribute__((always_inline)) void prefetch_wedges(const struct gd_field *field,
                                                                  const struct view *view)
{
    for (int k = 0; k < 3; k++) {
        if (view->newest[k] == GD_NONE) continue;
        const struct gd__chunk *chunk = gd__field_chunk(field, view->newest[k]);
        const char *first = (const char *)chunk;
        size_t size = sizeof *chunk + (size_t)chunk->count * GD__WEDGE_BYTES;
        for (size_t line = CACHE_LINE; line < size; line += CACHE_LINE)
            __builtin_prefetch(first + line);
    }
}

/* All wedges of a chunk have their source on one side of the edge; the first may be a gap. */
static inline bool comes_from_across(const struct gd__chunk *chunk, uint32_t side)
{
    if (!chunk->count) return false;
    struct gd__wedges wedges = gd__chunk_wedges(chunk);
    uint32_t first = gd__wedge_source(wedges.start[0]) == GD_NONE;
    return first < chunk->count && (signbit(wedges.y[first]) != 0) != (side & 1);
}

/* The next views of a view, at most WEDGE_VIEWS. Each chunk is written as one; one that is none is then
 * written over. */
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
        count += comes_from_across(chunk, view->side[k]);
        cursor->chunk = chunk->previous;
    }
    return count;
}

/* --- the best way ----------------------------------------------------------------------------- */

/* Keeps the shorter way; without a branch, as none could be foreseen. */
static inline void offer(struct gd__way *best, double distance, enum gd__leg_kind kind,
                         uint32_t from)
{
    bool better = distance < best->distance;
    best->kind = better ? kind : best->kind;
    best->from = better ? from : best->from;
    best->distance = better ? distance : best->distance;
}

static inline void try_corner(const struct gd_field *field, uint32_t side, struct gd__local at,
                              struct gd__way *best)
{
    uint32_t vertex = field->mesh->origin[side];
    offer(best, field->distance[vertex] + sqrt(at.x * at.x + at.y * at.y), GD__LEG_VERTEX, vertex);
}

/* Of a vertex and a seed that are as near, the seed: its leg is the path's last. */
static inline bool seed_takes_tie(const struct gd__way *best, double distance)
{
    return distance == best->distance && best->kind == GD__LEG_VERTEX;
}

/* How far a point of a face, by its weights, is from a seed in the face; infinite where a segment
 * does not lie at right angles to it. */
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
    return gd__local_length(gd__way_in_face(mesh, face, gd__main_corner(from), from, to));
}

static void try_seeds(const struct gd_field *field, uint32_t face, const double weight[3],
                      struct gd__way *best)
{
    const struct gd__face_seed *end = field->face_seeds + field->face_seed_count;
    struct gd__close close;
    for (const struct gd__face_seed *f = gd__field_seeds_in(field, face);
         f < end && f->face == face; f++) {
        const struct gd__seed *seed = &field->seeds[f->seed];
        double distance = seed->offset + distance_of_seed(field->mesh, seed, face, weight);
        if (distance < best->distance || seed_takes_tie(best, distance)) {
            best->distance = distance;
            best->kind = GD__LEG_SEED;
            best->from = f->seed;
        }
    }
    if (gd__close_may_be(weight) && gd__close_find(field, face, weight, best->distance, &close)) {
        best->distance = close.distance;
        best->kind = GD__LEG_CLOSE;
        best->from = close.seed;
    }
}

/* A point of a face is beside a vertex, and the point seed that the vertex has its distance from is
 * beside it or at it. */
static bool are_beside(const struct gd_field *field, uint32_t vertex, uint32_t face,
                       const double weight[3])
{
    uint32_t source = field->predecessor[vertex].source;
    struct gd__polar polar;
    const struct gd_point point = {GD_POINT_FACE, face, {weight[0], weight[1], weight[2]}};
    if (source < field->mesh->vertex_count || source == GD_NONE || gd__source_is_linear(source))
        return false;
    const struct gd__seed *seed = &field->seeds[gd__field_seed_of(field, source)];
    if (!gd__polar_beside(field->mesh, &point, &polar) || polar.vertex != vertex) return false;
    return seed->point.kind == GD_POINT_VERTEX ||
           (gd__polar_beside(field->mesh, &seed->point, &polar) && polar.vertex == vertex);
}

/* What a way through a wedge must be shorter by than a best way that is short for the face: the
 * rounding of places in the face. The way to a point seed close by has more digits, be it through a
 * vertex that both are beside. Through another corner it may be too long by less than that. */
static inline double margin_of(const struct gd_field *field, uint32_t face, const double weight[3],
                               const struct gd__way *best)
{
    double length = field->mesh->side[field->mesh->face_side[face][0]].length;
    if (best->distance >= GD_TOL_BESIDE_VERTEX * length) return 0;
    bool is_line = best->kind == GD__LEG_SEED && field->seeds[best->from].is_segment;
    bool is_other = best->kind == GD__LEG_VERTEX && !are_beside(field, best->from, face, weight);
    return is_line || is_other ? 0 : GD_TOL_BETTER * length;
}

static void best_in_face(const struct gd_field *field, uint32_t face, const double weight[3],
                         struct gd__way *out)
{
    struct view view;
    struct gd__way best = {.distance = GD__FAR, .kind = GD__LEG_NONE};
    look_around(field, face, weight, &view);
    for (int k = 0; k < 3; k++) try_corner(field, view.side[k], view.at[k], &best);
    prefetch_wedges(field, &view);
    double margin = 0;
    if (field->face_seed_count) {
        try_seeds(field, face, weight, &best);
        margin = margin_of(field, face, weight, &best);
    }
    gd__wedge_view_kernel *kernel = gd__wedge_view_kernel_in_use(field->has_segments);
    struct gd__wedge_view wedge_views[WEDGE_VIEWS];
    struct cursor cursor = {0, view.newest[0]};
    for (uint32_t passed = 0; cursor.k < 3;) {
        uint32_t count = take_views(field, &view, &cursor, wedge_views);
        struct gd__seen seen = kernel(field, wedge_views, count, best.distance - margin);
        if (margin > 0 && seen.place == GD_NONE) seen.distance = best.distance;
        offer(&best, seen.distance, GD__LEG_WEDGE, passed + seen.place);
        margin = best.kind == GD__LEG_WEDGE ? 0 : margin;
        for (uint32_t s = 0; s < count && cursor.k < 3; s++) passed += wedge_views[s].chunk->count;
    }
    out->distance = best.distance;
    out->kind = best.kind;
    out->from = best.from;
    out->face = face;
}

/* An edge's point lies in the faces of both sides. */
static void best_at_edge(const struct gd_field *field, const struct gd_point *point,
                         struct gd__way *best)
{
    const struct gd_mesh *mesh = field->mesh;
    best->distance = GD__FAR;
    best->kind = GD__LEG_NONE;
    for (uint32_t side = 2 * point->element; side < 2 * point->element + 2; side++) {
        uint32_t face = mesh->side_face[side];
        double weight[3];
        struct gd__way way;
        if (face == GD_NONE) continue;
        gd__point_weights(mesh, point, face, weight);
        best_in_face(field, face, weight, &way);
        if (way.distance < best->distance ||
            (way.kind == GD__LEG_SEED && seed_takes_tie(best, way.distance)))
            *best = way;
    }
}

void gd__field_way(const struct gd_field *field, const struct gd_point *point, struct gd__way *out)
{
    switch (point->kind) {
    case GD_POINT_VERTEX:
        out->distance = field->distance[point->element];
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

/* --- its leg ---------------------------------------------------------------------------------- */

/* Where the way through a wedge crosses its side, and the source in the side's frame. */
static void complete_wedge(const struct gd__wedge_view *wedge_view, uint32_t wedge,
                           struct gd__leg *leg)
{
    struct gd__wedges wedges = gd__chunk_wedges(wedge_view->chunk);
    struct gd__window w =
        gd__wedge_window(wedges, wedge_view->chunk->count, wedge, wedge_view->length);
    if (wedge_view->side & 1) w = gd__window_mirrored(&w, wedge_view->length);
    leg->side = wedge_view->side;
    leg->source = w.source;
    leg->x = w.x;
    leg->y = w.y;
    leg->parameter = gd__wedge_view_crossing(wedge_view, &w);
}

/* Finds the wedge at its place again. */
static void find_wedge(const struct gd_field *field, const struct gd_point *point, uint32_t place,
                       struct gd__leg *leg)
{
    double weight[3];
    gd__point_weights(field->mesh, point, leg->face, weight);
    struct view view;
    look_around(field, leg->face, weight, &view);
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
    struct gd__way way;
    gd__field_way(field, point, &way);
    struct gd__leg leg = {
        .distance = way.distance, .kind = way.kind, .face = way.face, .source = GD_NONE};
    if (way.kind == GD__LEG_WEDGE)
        find_wedge(field, point, way.from, &leg);
    else
        leg.from = way.from;
    return leg;
}

/* The path to `to` comes from `vertex`, along an edge, or is that vertex. */
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
