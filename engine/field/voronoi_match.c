#include <stdlib.h>

#include "field/array.h"
#include "field/voronoi_parts.h"

/* Loose ends of a face get their nodes: those of a triple point one in common, the others two by
 * two. */

static double apart(const struct gd__loose *a, const struct gd__loose *b)
{
    double dx = a->at.x - b->at.x, dy = a->at.y - b->at.y;
    return sqrt(dx * dx + dy * dy);
}

/* A switch, or a triple point that lacks a strand. */
static bool has_node(const struct gd__loose *loose)
{
    return loose->strand == GD_NONE;
}

/* The face at hand. */
struct work {
    struct gd__diagram *diagram;
    struct gd__voronoi_scratch *scratch;
    double reach; /* ends no farther apart are one place, but for rounding */
};

/* --- places ----------------------------------------------------------------------------------- */

static bool is_in_face(const struct gd__frame *frame, struct gd__local at)
{
    bool is_inside = true;
    for (int k = 0; k < 3; k++) {
        double dx = at.x - frame->corner[k].x, dy = at.y - frame->corner[k].y;
        is_inside &= frame->along[k].x * dy - frame->along[k].y * dx >= -GD_TOL_PLACE * frame->size;
    }
    return is_inside;
}

/* Where three sources are as near. A line and its end are so along all of the line's perpendicular,
 * and so are a vertex and a source behind it: that may lead out of the face, back into which the
 * nearest place is not as far from all. */
static struct gd__local refine_takeover(const struct work *work, const struct gd__focus focus[3],
                                        struct gd__local at)
{
    struct gd__local place = gd__between_three(focus, at, work->reach);
    return is_in_face(&work->scratch->sources.frame, place) ? place : at;
}

/* Without the nudge; a switch has its place already. */
static void refine(const struct work *work, struct gd__loose *loose)
{
    if (has_node(loose)) return;
    const struct gd__focus *focus = work->diagram->strand[loose->strand].focus;
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
        gd__frame_point(work->diagram->mesh, sources->face, &sources->frame, at);
    return gd__diagram_add_node(work->diagram, &point, out);
}

static void meet(struct gd__diagram *diagram, uint32_t strand, uint32_t end, uint32_t number)
{
    struct gd__node *node = &diagram->node[number];
    diagram->strand[strand].node[end] = number;
    if (node->strand[0] == GD_NONE)
        node->strand[0] = strand;
    else if (node->strand[1] == GD_NONE)
        node->strand[1] = strand;
    else
        node->is_end = true;
}

static void attach(const struct work *work, struct gd__loose *loose, uint32_t node)
{
    loose->node = node;
    meet(work->diagram, loose->strand, loose->end, node);
}

/* --- triple points ---------------------------------------------------------------------------- */

struct triple {
    uint32_t member[3]; /* ascending */
};

static struct triple triple_of(const struct work *work, const struct gd__loose *loose)
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

static bool waits_at_triple(const struct gd__loose *loose)
{
    return loose->is_triple && loose->node == GD_NONE;
}

static bool are_of_same_two(const struct gd__loose *a, const struct gd__loose *b)
{
    return a->member[0] == b->member[0] && a->member[1] == b->member[1];
}

/* The nearest end with the same three members, but other two of them than `first` and `second`
 * (NULL: than the first); NULL: there is none within reach. */
static struct gd__loose *find_partner(const struct work *work, const struct gd__loose *first,
                                      const struct gd__loose *second)
{
    struct triple wanted = triple_of(work, first);
    struct gd__loose *best = NULL;
    double least = work->reach;
    for (uint32_t i = 0; i < work->scratch->loose_count; i++) {
        struct gd__loose *other = &work->scratch->loose[i];
        if (!waits_at_triple(other) || !are_same(triple_of(work, other), wanted)) continue;
        if (are_of_same_two(other, first) || (second && are_of_same_two(other, second))) continue;
        if (apart(first, other) > least) continue;
        least = apart(first, other);
        best = other;
    }
    return best;
}

/* Two of a triple point's members whose strand was not found: it is to be bridged, or ends
 * elsewhere by rounding. */
static enum gd_status await_two(const struct work *work, const struct gd__loose *first, uint32_t a,
                                uint32_t b, uint32_t node)
{
    return gd__loose_append(
        work->scratch,
        (struct gd__loose){
            .at = first->at, .member = {a, b}, .third = GD_NONE, .strand = GD_NONE, .node = node});
}

static enum gd_status await(const struct work *work, struct gd__loose first,
                            const struct gd__loose *second, uint32_t node)
{
    struct triple triple = triple_of(work, &first);
    struct gd__loose found = second ? *second : first;
    enum gd_status status = GD_OK;
    for (int k = 0; k < 3 && !status; k++) {
        struct gd__loose two = {.member = {triple.member[k == 0], triple.member[k == 2 ? 1 : 2]}};
        if (are_of_same_two(&two, &first) || are_of_same_two(&two, &found)) continue;
        status = await_two(work, &first, two.member[0], two.member[1], node);
    }
    return status;
}

static enum gd_status match_triple(const struct work *work, struct gd__loose *first)
{
    uint32_t node;
    enum gd_status status = make_node(work, first->at, &node);
    if (status) return status;
    work->diagram->node[node].is_end = true;
    attach(work, first, node);
    struct gd__loose *second = find_partner(work, first, NULL);
    if (second) attach(work, second, node);
    struct gd__loose *third = second ? find_partner(work, first, second) : NULL;
    if (third) attach(work, third, node);
    return third ? GD_OK : await(work, *first, second, node);
}

/* --- two by two ------------------------------------------------------------------------------- */

static int by_distance(const void *a, const void *b)
{
    const struct gd__tie *x = a, *y = b;
    if (x->apart != y->apart) return x->apart < y->apart ? -1 : 1;
    if (x->a != y->a) return x->a < y->a ? -1 : 1;
    return (x->b > y->b) - (x->b < y->b);
}

static enum gd_status append_tie(struct gd__voronoi_scratch *scratch, uint32_t a, uint32_t b)
{
    struct gd__tie *grown = gd__array_reserve(scratch->tie, &scratch->tie_capacity,
                                              scratch->tie_count + 1, sizeof *grown);
    if (!grown) return GD_NO_MEMORY;
    scratch->tie = grown;
    scratch->tie[scratch->tie_count++] =
        (struct gd__tie){apart(&scratch->loose[a], &scratch->loose[b]), a, b};
    return GD_OK;
}

/* All that may be one, the nearest first. */
static enum gd_status find_ties(struct gd__voronoi_scratch *scratch)
{
    enum gd_status status = GD_OK;
    scratch->tie_count = 0;
    for (uint32_t i = 0; i < scratch->loose_count; i++) {
        for (uint32_t k = i + 1; k < scratch->loose_count && !status; k++) {
            const struct gd__loose *a = &scratch->loose[i], *b = &scratch->loose[k];
            if (a->is_triple || b->is_triple) continue;
            if (are_of_same_two(a, b)) status = append_tie(scratch, i, k);
        }
    }
    if (scratch->tie_count)
        qsort(scratch->tie, scratch->tie_count, sizeof *scratch->tie, by_distance);
    return status;
}

/* A straight strand between two nodes. */
static enum gd_status bridge(const struct work *work, const uint32_t member[2], uint32_t from,
                             uint32_t to)
{
    struct gd__strand strand = {.face = work->scratch->sources.face,
                                .member = {member[0], member[1]},
                                .node = {from, to},
                                .is_straight = true};
    uint32_t number;
    enum gd_status status = gd__diagram_add_strand(work->diagram, &strand, &number);
    if (status) return status;
    meet(work->diagram, number, 0, from);
    meet(work->diagram, number, 1, to);
    return GD_OK;
}

static enum gd_status give_node(const struct work *work, struct gd__loose *loose)
{
    uint32_t node;
    if (has_node(loose)) return GD_OK;
    enum gd_status status = make_node(work, loose->at, &node);
    if (!status) attach(work, loose, node);
    return status;
}

/* Two ends in one place get one node, that of the one which has it; others are bridged. */
static enum gd_status match_two(const struct work *work, struct gd__loose *a, struct gd__loose *b)
{
    bool is_one = apart(a, b) <= work->reach && !(has_node(a) && has_node(b));
    if (is_one && has_node(a)) attach(work, b, a->node);
    if (is_one && has_node(b)) attach(work, a, b->node);
    if (is_one && (has_node(a) || has_node(b))) return GD_OK;
    /* where a source takes over, the place is the more exact one */
    bool second = is_one && a->third == GD_NONE;
    enum gd_status status = give_node(work, second ? b : a);
    if (is_one && !status) attach(work, second ? a : b, second ? b->node : a->node);
    if (is_one || status) return status;
    status = give_node(work, b);
    return status ? status : bridge(work, a->member, a->node, b->node);
}

static enum gd_status match_pairs(const struct work *work)
{
    struct gd__voronoi_scratch *scratch = work->scratch;
    enum gd_status status = find_ties(scratch);
    for (uint32_t i = 0; i < scratch->tie_count && !status; i++) {
        const struct gd__tie *tie = &scratch->tie[i];
        struct gd__loose *a = &scratch->loose[tie->a], *b = &scratch->loose[tie->b];
        if (a->is_matched || b->is_matched) continue;
        a->is_matched = b->is_matched = true;
        status = match_two(work, a, b);
    }
    return status;
}

/* --- what is left ----------------------------------------------------------------------------- */

static bool waits(const struct gd__loose *loose)
{
    return !loose->is_triple && !loose->is_matched;
}

/* The two members of three that `a` and `b`, which have one in common, are not both between; false:
 * they have none, or both. */
static bool find_other_two(const struct gd__loose *a, const struct gd__loose *b,
                           struct gd__loose *out)
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

/* The end that waits for the other two members of two ends in one place; NULL: there is none. */
static struct gd__loose *find_third(const struct work *work, const struct gd__loose *a,
                                    const struct gd__loose *b)
{
    struct gd__loose wanted;
    if (!waits(a) || !waits(b) || apart(a, b) > work->reach || !find_other_two(a, b, &wanted))
        return NULL;
    for (uint32_t i = 0; i < work->scratch->loose_count; i++) {
        struct gd__loose *loose = &work->scratch->loose[i];
        if (waits(loose) && are_of_same_two(loose, &wanted)) return loose;
    }
    return NULL;
}

/* A triple point of which one line is the edge of a shadow, which has no strand: it is bridged. */
static enum gd_status match_corner(const struct work *work, struct gd__loose *a,
                                   struct gd__loose *b, struct gd__loose *third)
{
    a->is_matched = b->is_matched = third->is_matched = true;
    enum gd_status status = give_node(work, a);
    if (!status) status = give_node(work, third);
    if (!status) status = bridge(work, third->member, third->node, a->node);
    if (status) return status;
    work->diagram->node[a->node].is_end = true;
    if (has_node(b)) return bridge(work, b->member, b->node, a->node);
    attach(work, b, a->node);
    return GD_OK;
}

static enum gd_status match_corners(const struct work *work)
{
    struct gd__voronoi_scratch *scratch = work->scratch;
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < scratch->loose_count; i++) {
        for (uint32_t k = i + 1; k < scratch->loose_count && !status; k++) {
            struct gd__loose *a = &scratch->loose[i], *b = &scratch->loose[k],
                             *third = find_third(work, a, b);
            if (third) status = match_corner(work, a, b, third);
        }
    }
    return status;
}

/* --- all -------------------------------------------------------------------------------------- */

enum gd_status gd__face_match(struct gd__diagram *diagram, struct gd__voronoi_scratch *scratch)
{
    struct work work = {diagram, scratch, GD_TOL_NODE * scratch->sources.frame.size};
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < scratch->loose_count; i++) refine(&work, &scratch->loose[i]);
    for (uint32_t i = 0; i < scratch->loose_count && !status; i++)
        if (waits_at_triple(&scratch->loose[i])) status = match_triple(&work, &scratch->loose[i]);
    if (!status) status = match_pairs(&work);
    if (!status) status = match_corners(&work);
    for (uint32_t i = 0; i < scratch->loose_count && !status; i++)
        if (scratch->loose[i].node == GD_NONE) status = give_node(&work, &scratch->loose[i]);
    return status;
}
