#include <stdlib.h>

#include "base/array.h"
#include "field/voronoi_parts.h"

/* Assigns nodes to a face's loose ends: the ends at a triple point share one node, other ends are
 * matched in pairs. */

static double distance_apart(const struct gd__loose_end *a, const struct gd__loose_end *b)
{
    return gd__local_length(gd__local_minus(a->at, b->at));
}

/* Returns true for an owner change, or a triple point that lacks a part. */
static bool has_node(const struct gd__loose_end *loose)
{
    return loose->bisector_part == GD_NONE;
}

/* The current face. */
struct work {
    struct gd__diagram *diagram;
    struct gd__voronoi_scratch *scratch;
    double reach; /* ends this close are at the same position, up to rounding */
};

/* --- positions -------------------------------------------------------------------------------- */

/* Returns the position near `at` that is equally far from three sources; `at` itself if that
 * position is outside the face. For a segment and its end, or for a vertex and a source behind it,
 * all points of a perpendicular line are solutions, and this line may leave the face. */
static struct gd__local refine_takeover(const struct work *work, const struct gd__focus focus[3],
                                        struct gd__local at)
{
    const struct gd__face_frame *frame = &work->scratch->sources.frame;
    struct gd__local place = gd__between_three(focus, at, work->reach);
    return gd__face_frame_has(frame, place, GD_TOL_PLACE * frame->size) ? place : at;
}

/* Recomputes the position of a loose end without the nudge, except for owner changes, whose
 * positions are exact. */
static void refine_end(const struct work *work, struct gd__loose_end *loose)
{
    if (has_node(loose)) return;
    const struct gd__diagram *diagram = work->diagram;
    const struct gd__focus *focus =
        diagram->arc[diagram->bisector_part[loose->bisector_part].arc].focus;
    if (loose->third != GD_NONE) {
        struct gd__focus three[3] = {focus[0], focus[1],
                                     gd__focus_of(&work->scratch->sources.source[loose->third])};
        loose->at = refine_takeover(work, three, loose->at);
    }
    if (!loose->is_triple) loose->at = gd__between_two(focus, loose->at, work->reach);
}

static enum gd_status make_node(const struct work *work, struct gd__local at, uint32_t *out)
{
    const struct gd__sources *sources = &work->scratch->sources;
    struct gd_point point =
        gd__face_frame_point(work->diagram->mesh, sources->face, &sources->frame, at);
    return gd__diagram_add_node(work->diagram, &point, out);
}

static void attach_end(const struct work *work, struct gd__loose_end *loose, uint32_t node)
{
    loose->node = node;
    work->diagram->bisector_part[loose->bisector_part].node[loose->end] = node;
    gd__diagram_count_end(work->diagram, loose->bisector_part, loose->end);
}

/* --- triple points ---------------------------------------------------------------------------- */

struct triple {
    uint32_t member[3]; /* ascending */
};

static struct triple triple_of(const struct work *work, const struct gd__loose_end *loose)
{
    uint32_t third =
        gd__member_of(&work->diagram->members, work->scratch->sources.source[loose->third].pseudo);
    uint32_t a = loose->member[0], b = loose->member[1];
    if (third < a) return (struct triple){{third, a, b}};
    if (third < b) return (struct triple){{a, third, b}};
    return (struct triple){{a, b, third}};
}

static bool are_same(struct triple a, struct triple b)
{
    return a.member[0] == b.member[0] && a.member[1] == b.member[1] && a.member[2] == b.member[2];
}

static bool waits_at_triple(const struct gd__loose_end *loose)
{
    return loose->is_triple && loose->node == GD_NONE;
}

static bool are_of_same_two(const struct gd__loose_end *a, const struct gd__loose_end *b)
{
    return a->member[0] == b->member[0] && a->member[1] == b->member[1];
}

/* Returns the nearest end at a triple point of the same three members. The end must separate a pair
 * of members that neither `first` nor `second` separates; `second` may be NULL. Returns NULL if no
 * such end is near enough. */
static struct gd__loose_end *find_partner(const struct work *work,
                                          const struct gd__loose_end *first,
                                          const struct gd__loose_end *second)
{
    struct triple wanted = triple_of(work, first);
    struct gd__loose_end *best = NULL;
    double least = work->reach;
    for (uint32_t i = 0; i < work->scratch->loose_count; i++) {
        struct gd__loose_end *other = &work->scratch->loose[i];
        if (!waits_at_triple(other) || !are_same(triple_of(work, other), wanted)) continue;
        if (are_of_same_two(other, first) || (second && are_of_same_two(other, second))) continue;
        if (distance_apart(first, other) > least) continue;
        least = distance_apart(first, other);
        best = other;
    }
    return best;
}

/* Adds a loose end at the node of a triple point, for two of its members whose part was not found.
 * Later, matching connects this end by a bridge, or joins it to a part that ends elsewhere because
 * of rounding. */
static enum gd_status await_two(const struct work *work, const struct gd__loose_end *first,
                                uint32_t a, uint32_t b, uint32_t node)
{
    return gd__loose_end_append(work->scratch, (struct gd__loose_end){.at = first->at,
                                                                      .member = {a, b},
                                                                      .third = GD_NONE,
                                                                      .bisector_part = GD_NONE,
                                                                      .node = node});
}

static enum gd_status await_third(const struct work *work, struct gd__loose_end first,
                                  const struct gd__loose_end *second, uint32_t node)
{
    struct triple triple = triple_of(work, &first);
    struct gd__loose_end found = second ? *second : first;
    enum gd_status status = GD_OK;
    for (int k = 0; k < 3 && !status; k++) {
        struct gd__loose_end two = {
            .member = {triple.member[k == 0], triple.member[k == 2 ? 1 : 2]}};
        if (are_of_same_two(&two, &first) || are_of_same_two(&two, &found)) continue;
        status = await_two(work, &first, two.member[0], two.member[1], node);
    }
    return status;
}

static enum gd_status match_triple(const struct work *work, struct gd__loose_end *first)
{
    uint32_t node;
    enum gd_status status = make_node(work, first->at, &node);
    if (status) return status;
    work->diagram->node[node].is_end = true;
    attach_end(work, first, node);
    struct gd__loose_end *second = find_partner(work, first, NULL);
    if (second) attach_end(work, second, node);
    struct gd__loose_end *third = second ? find_partner(work, first, second) : NULL;
    if (third) attach_end(work, third, node);
    return third ? GD_OK : await_third(work, *first, second, node);
}

/* --- pairs ------------------------------------------------------------------------------------ */

static int by_distance(const void *a, const void *b)
{
    const struct gd__close_pair *x = a, *y = b;
    if (x->apart != y->apart) return x->apart < y->apart ? -1 : 1;
    if (x->a != y->a) return x->a < y->a ? -1 : 1;
    return (x->b > y->b) - (x->b < y->b);
}

/* Collects all pairs that may match, sorted by distance. */
static enum gd_status find_ties(struct gd__voronoi_scratch *scratch)
{
    enum gd_status status = GD_OK;
    scratch->tie_count = 0;
    for (uint32_t i = 0; i < scratch->loose_count; i++) {
        for (uint32_t k = i + 1; k < scratch->loose_count && !status; k++) {
            const struct gd__loose_end *a = &scratch->loose[i], *b = &scratch->loose[k];
            if (a->is_triple || b->is_triple || !are_of_same_two(a, b)) continue;
            struct gd__close_pair tie = {distance_apart(a, b), i, k};
            status = gd__array_append(&scratch->tie, &scratch->tie_count, &scratch->tie_capacity,
                                      &tie, sizeof tie);
        }
    }
    if (scratch->tie_count)
        qsort(scratch->tie, scratch->tie_count, sizeof *scratch->tie, by_distance);
    return status;
}

/* Appends a straight part between two nodes. */
static enum gd_status bridge_nodes(const struct work *work, const uint32_t member[2], uint32_t from,
                                   uint32_t to)
{
    struct gd__bisector_part bisector_part = {.face = work->scratch->sources.face,
                                              .member = {member[0], member[1]},
                                              .node = {from, to},
                                              .arc = GD_NONE};
    uint32_t number;
    enum gd_status status = gd__diagram_add_bisector_part(work->diagram, &bisector_part, &number);
    for (uint32_t end = 0; end < 2 && !status; end++)
        gd__diagram_count_end(work->diagram, number, end);
    return status;
}

static enum gd_status give_node(const struct work *work, struct gd__loose_end *loose)
{
    uint32_t node;
    if (has_node(loose)) return GD_OK;
    enum gd_status status = make_node(work, loose->at, &node);
    if (!status) attach_end(work, loose, node);
    return status;
}

/* Matches two ends. Two ends at the same position share one node. Ends at different positions are
 * joined by a straight part (a bridge). */
static enum gd_status match_two(const struct work *work, struct gd__loose_end *a,
                                struct gd__loose_end *b)
{
    bool is_one = distance_apart(a, b) <= work->reach && !(has_node(a) && has_node(b));
    if (is_one && has_node(a)) attach_end(work, b, a->node);
    if (is_one && has_node(b)) attach_end(work, a, b->node);
    if (is_one && (has_node(a) || has_node(b))) return GD_OK;
    /* the position of an end with a third source is more accurate */
    bool second = is_one && a->third == GD_NONE;
    enum gd_status status = give_node(work, second ? b : a);
    if (is_one && !status) attach_end(work, second ? a : b, second ? b->node : a->node);
    if (is_one || status) return status;
    status = give_node(work, b);
    return status ? status : bridge_nodes(work, a->member, a->node, b->node);
}

static enum gd_status match_pairs(const struct work *work)
{
    struct gd__voronoi_scratch *scratch = work->scratch;
    enum gd_status status = find_ties(scratch);
    for (uint32_t i = 0; i < scratch->tie_count && !status; i++) {
        const struct gd__close_pair *tie = &scratch->tie[i];
        struct gd__loose_end *a = &scratch->loose[tie->a], *b = &scratch->loose[tie->b];
        if (a->is_matched || b->is_matched) continue;
        a->is_matched = b->is_matched = true;
        status = match_two(work, a, b);
    }
    return status;
}

/* --- remaining ends --------------------------------------------------------------------------- */

static bool is_waiting(const struct gd__loose_end *loose)
{
    return !loose->is_triple && !loose->is_matched;
}

/* Finds the pair of members that is missing at a triple point with the ends `a` and `b`. Returns
 * false unless `a` and `b` share exactly one member. */
static bool find_other_two(const struct gd__loose_end *a, const struct gd__loose_end *b,
                           struct gd__loose_end *out)
{
    if (are_of_same_two(a, b)) return false;
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 2; k++) {
            if (a->member[i] != b->member[k]) continue;
            uint32_t m = a->member[!i], n = b->member[!k];
            out->member[0] = m < n ? m : n;
            out->member[1] = m < n ? n : m;
            return true;
        }
    }
    return false;
}

/* If two ends are at the same position, determines the pair of members that is missing there
 * (find_other_two), and returns an unmatched end of this pair. Returns NULL if there is none. */
static struct gd__loose_end *find_third(const struct work *work, const struct gd__loose_end *a,
                                        const struct gd__loose_end *b)
{
    struct gd__loose_end wanted;
    if (!is_waiting(a) || !is_waiting(b) || distance_apart(a, b) > work->reach ||
        !find_other_two(a, b, &wanted))
        return NULL;
    for (uint32_t i = 0; i < work->scratch->loose_count; i++) {
        struct gd__loose_end *loose = &work->scratch->loose[i];
        if (is_waiting(loose) && are_of_same_two(loose, &wanted)) return loose;
    }
    return NULL;
}

/* Creates a triple point where three ends meet. One of the three bisectors is the border of a
 * shadow and is not computed here. A bridge replaces this bisector. */
static enum gd_status match_corner(const struct work *work, struct gd__loose_end *a,
                                   struct gd__loose_end *b, struct gd__loose_end *third)
{
    a->is_matched = b->is_matched = third->is_matched = true;
    enum gd_status status = give_node(work, a);
    if (!status) status = give_node(work, third);
    if (!status) status = bridge_nodes(work, third->member, third->node, a->node);
    if (status) return status;
    work->diagram->node[a->node].is_end = true;
    if (has_node(b)) return bridge_nodes(work, b->member, b->node, a->node);
    attach_end(work, b, a->node);
    return GD_OK;
}

static enum gd_status match_corners(const struct work *work)
{
    struct gd__voronoi_scratch *scratch = work->scratch;
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < scratch->loose_count; i++) {
        for (uint32_t k = i + 1; k < scratch->loose_count && !status; k++) {
            struct gd__loose_end *a = &scratch->loose[i], *b = &scratch->loose[k],
                                 *third = find_third(work, a, b);
            status = gd__pace_step(&scratch->pace, 1 + scratch->loose_count / 8);
            if (status) break;
            if (third) status = match_corner(work, a, b, third);
        }
    }
    return status;
}

/* --- matching --------------------------------------------------------------------------------- */

enum gd_status gd__face_match(struct gd__diagram *diagram, struct gd__voronoi_scratch *scratch)
{
    struct work work = {diagram, scratch, GD_TOL_NODE * scratch->sources.frame.size};
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < scratch->loose_count; i++) refine_end(&work, &scratch->loose[i]);
    for (uint32_t i = 0; i < scratch->loose_count && !status; i++)
        if (waits_at_triple(&scratch->loose[i])) status = match_triple(&work, &scratch->loose[i]);
    if (!status) status = match_pairs(&work);
    if (!status) status = match_corners(&work);
    for (uint32_t i = 0; i < scratch->loose_count && !status; i++)
        if (scratch->loose[i].node == GD_NONE) status = give_node(&work, &scratch->loose[i]);
    return status;
}
