#include <float.h>

#include "field/array.h"
#include "field/voronoi_parts.h"

/* Strands of a face: of each two sources of different members, the parts of their branch that no
 * third source takes. */

/* The face at hand. */
struct work {
    struct gd__diagram *diagram;
    struct gd__voronoi_scratch *scratch;
    struct gd__local middle;
    double slack; /* within which sources of one member tie */
    double tie;   /* no nudges differ by more */
};

static uint32_t member_of(const struct work *work, uint32_t i)
{
    return gd__member_of(&work->diagram->members, work->scratch->sources.source[i].pseudo);
}

static struct gd__focus focus_of(const struct work *work, uint32_t i)
{
    return gd__focus_of(&work->scratch->sources.source[i]);
}

static struct gd__focus nudged(const struct work *work, uint32_t i)
{
    struct gd__focus focus = focus_of(work, i);
    focus.sigma += work->diagram->members.nudge[member_of(work, i)];
    return focus;
}

/* --- the sources ------------------------------------------------------------------------------ */

/* No point of the face is farther. */
static double most_in_face(const struct gd__diagram *diagram, uint32_t face)
{
    const struct gd_mesh *mesh = diagram->mesh;
    const struct gd_side *s = &mesh->side[mesh->face_side[face][0]];
    double most = GD__FAR, longest = fmax(s->length, fmax(s->left_length, s->right_length));
    for (int k = 0; k < 3; k++)
        most =
            fmin(most, diagram->field->distance[mesh->origin[mesh->face_side[face][k]]] + longest);
    return most * (1 + GD_TOL_CHECK);
}

/* A line that a source sees one side of: that of the unit normal. */
struct bound {
    struct gd__local normal, through;
};

enum { BOUNDS_MOST = 3 };

/* All that bound what a source sees: the two of its sector, and of a linear one the line behind
 * which nothing is as near as `nearest`, so that a segment in the face sees one side of itself. */
static int bounds_of(const struct work *work, const struct gd__source *source,
                     struct bound bound[BOUNDS_MOST])
{
    if (!source->has_sector) return 0;
    bound[0] = (struct bound){source->left, source->left_at};
    bound[1] = (struct bound){source->right, source->right_at};
    if (!source->linear) return 2;
    double offset = gd__field_sigma(work->diagram->field, source->pseudo),
           size = work->scratch->sources.frame.size;
    for (int k = 0; k < 2; k++) {
        double more =
            gd__line_lengthened(size, gd__source_distance(source, bound[k].through) - offset);
        bound[k].through.x -= more * bound[k].normal.x;
        bound[k].through.y -= more * bound[k].normal.y;
    }
    double ahead = source->nearest - source->sigma;
    bound[2] =
        (struct bound){source->gradient, {ahead * source->gradient.x, ahead * source->gradient.y}};
    return 3;
}

static double height_above(const struct bound *bound, struct gd__local at)
{
    return bound->normal.x * (at.x - bound->through.x) +
           bound->normal.y * (at.y - bound->through.y);
}

/* Cuts off a convex polygon what lies beyond a line; there is room. */
static void clip(struct gd__view *view, const struct bound *bound)
{
    struct gd__view cut = {0};
    for (int k = 0; k < view->count; k++) {
        struct gd__local a = view->corner[k], b = view->corner[(k + 1) % view->count];
        double height = height_above(bound, a), next = height_above(bound, b);
        if (height >= 0) cut.corner[cut.count++] = a;
        if ((height < 0) == (next < 0)) continue;
        double t = height / (height - next);
        cut.corner[cut.count++] = (struct gd__local){a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
    }
    *view = cut;
}

/* What each source sees of the face. */
static enum gd_status find_views(const struct work *work)
{
    struct gd__voronoi_scratch *scratch = work->scratch;
    const struct gd__sources *sources = &scratch->sources;
    struct gd__view *grown = gd__array_reserve(scratch->view, &scratch->view_capacity,
                                               sources->count, sizeof *scratch->view);
    if (!grown) return GD_NO_MEMORY;
    scratch->view = grown;
    for (uint32_t i = 0; i < sources->count; i++) {
        const struct gd__source *source = &sources->source[i];
        struct gd__view view = {
            3, {sources->frame.corner[0], sources->frame.corner[1], sources->frame.corner[2]}, 0};
        struct bound bound[BOUNDS_MOST];
        int bounds = bounds_of(work, source, bound);
        for (int k = 0; k < bounds; k++) clip(&view, &bound[k]);
        struct gd__focus focus = nudged(work, i);
        for (int k = 0; k < view.count; k++)
            view.most = fmax(view.most, gd__focus_distance(&focus, view.corner[k]));
        scratch->view[i] = view;
    }
    return GD_OK;
}

/* The straight way from a corner at which no path bends is that of a source behind it. */
static bool is_needless(const struct gd__diagram *diagram, const struct gd__source *source)
{
    uint32_t vertices = diagram->mesh->vertex_count;
    if (source->has_sector || source->pseudo >= vertices) return false;
    if (diagram->mesh->vertex_kind[source->pseudo] != GD_VERTEX_CONVEX) return false;
    const struct gd__predecessor *predecessor = &diagram->field->predecessor[source->pseudo];
    return predecessor->side != GD_NONE ||
           predecessor->source < vertices; /* else it may be a seed */
}

static void drop_needless(const struct gd__diagram *diagram, struct gd__sources *sources)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < sources->count; i++)
        if (!is_needless(diagram, &sources->source[i]))
            sources->source[kept++] = sources->source[i];
    sources->count = kept;
}

static bool are_of_one_member(const struct work *work)
{
    for (uint32_t i = 1; i < work->scratch->sources.count; i++)
        if (member_of(work, i) != member_of(work, 0)) return false;
    return true;
}

/* --- one strand ------------------------------------------------------------------------------- */

enum gd_status gd__loose_append(struct gd__voronoi_scratch *scratch, struct gd__loose loose)
{
    struct gd__loose *grown = gd__array_reserve(scratch->loose, &scratch->loose_capacity,
                                                scratch->loose_count + 1, sizeof loose);
    if (!grown) return GD_NO_MEMORY;
    scratch->loose = grown;
    scratch->loose[scratch->loose_count++] = loose;
    return GD_OK;
}

/* Rounding may leave a strand where wedges do not quite join: there a third source is nearer, by
 * more than the nudge. */
static bool is_nearest(const struct work *work, const struct gd__focus *focus, struct gd__local at)
{
    const struct gd__sources *sources = &work->scratch->sources;
    struct gd_point point =
        gd__frame_point(work->diagram->mesh, sources->face, &sources->frame, at);
    struct gd__way way;
    gd__field_way(work->diagram->field, &point, &way);
    return way.distance >=
           gd__focus_distance(focus, at) * (1 - GD_TOL_CHECK) - work->slack - work->tie;
}

static struct gd__loose end_of(const struct work *work, const struct gd__strand *strand,
                               uint32_t by)
{
    struct gd__loose loose = {
        .member = {strand->member[0], strand->member[1]}, .third = GD_NONE, .node = GD_NONE};
    if (by >= work->scratch->sources.count) return loose;
    uint32_t member = member_of(work, by);
    loose.third = by;
    loose.is_triple = member != strand->member[0] && member != strand->member[1];
    return loose;
}

static enum gd_status append_strand(const struct work *work, const struct gd__branch *branch,
                                    const struct gd__strand *pattern, const struct gd__span *span)
{
    struct gd__strand strand = *pattern;
    if (!is_nearest(work, &strand.focus[0],
                    gd__branch_place(branch, 0.5 * (span->from + span->to))))
        return GD_OK;
    strand.from = branch->zero + span->from;
    strand.to = branch->zero + span->to;
    uint32_t number;
    enum gd_status status = gd__diagram_add_strand(work->diagram, &strand, &number);
    for (uint32_t end = 0; end < 2 && !status; end++) {
        struct gd__loose loose = end_of(work, &strand, end ? span->to_by : span->from_by);
        loose.at = gd__branch_place(branch, end ? span->to : span->from);
        loose.strand = number;
        loose.end = end;
        status = gd__loose_append(work->scratch, loose);
    }
    return status;
}

/* --- two sources ------------------------------------------------------------------------------ */

/* Narrows the part of the turn to where the branch is inside of a line; false: nothing is left. */
static bool narrow(const struct gd__branch *branch, const struct bound *bound,
                   struct gd__turn *turn)
{
    struct gd__turn inside = gd__branch_beyond(branch, bound->normal, bound->through);
    *turn = gd__turn_both(turn, &inside);
    return turn->count > 0;
}

static bool narrow_to_view(const struct work *work, const struct gd__branch *branch, uint32_t i,
                           struct gd__turn *turn)
{
    struct bound bound[BOUNDS_MOST];
    int bounds = bounds_of(work, &work->scratch->sources.source[i], bound);
    bool is_left = turn->count > 0;
    for (int k = 0; k < bounds && is_left; k++) is_left = narrow(branch, &bound[k], turn);
    return is_left;
}

/* Where the branch of two sources is in the face and seen by both: mostly nowhere. */
static struct gd__turn domain_of(const struct work *work, const struct gd__branch *branch,
                                 uint32_t i, uint32_t j)
{
    const struct gd__frame *frame = &work->scratch->sources.frame;
    struct gd__turn turn = gd__branch_turn(branch);
    bool is_left = narrow_to_view(work, branch, i, &turn) && narrow_to_view(work, branch, j, &turn);
    for (int k = 0; k < 3 && is_left; k++) {
        struct bound side = {{-frame->along[k].y, frame->along[k].x}, frame->corner[k]};
        is_left = narrow(branch, &side, &turn);
    }
    return turn;
}

/* Covers what is not of the domain. */
static enum gd_status cover_outside(const struct work *work, const struct gd__turn *domain)
{
    struct gd__spans *spans = &work->scratch->spans;
    spans->count = work->scratch->covered.count = 0;
    enum gd_status status = gd__spans_put(spans, domain, GD__SPAN_OPEN);
    return status ? status : gd__spans_invert(spans, 0, &work->scratch->covered);
}

/* Is what one source sees of the face out of another's sight, or nearer to it than the other ever
 * is? */
static bool is_out_of_reach(const struct work *work, uint32_t i, uint32_t j)
{
    const struct gd__view *view = &work->scratch->view[i];
    const struct gd__source *source = &work->scratch->sources.source[j];
    if (view->most < source->nearest) return true;
    if (!source->has_sector) return view->count == 0;
    bool is_left = true, is_right = true;
    for (int k = 0; k < view->count; k++) {
        is_left &=
            height_above(&(struct bound){source->left, source->left_at}, view->corner[k]) < 0;
        is_right &=
            height_above(&(struct bound){source->right, source->right_at}, view->corner[k]) < 0;
    }
    return is_left || is_right;
}

/* Does one source count before another of its member that is as near? Of one seen through two
 * wedges the first does; and a line before its end, from which it differs by next to nothing on
 * either side of where it ends. */
static bool takes_tie(const struct work *work, uint32_t i, uint32_t j)
{
    const struct gd__source *source = work->scratch->sources.source;
    return source[i].linear == source[j].linear ? i < j : source[i].linear;
}

/* By how much more than its slack a third source has to be nearer. */
static double slack_against(const struct work *work, uint32_t third, uint32_t i, uint32_t j)
{
    uint32_t member = member_of(work, third), of_same = member == member_of(work, i)   ? i
                                                        : member == member_of(work, j) ? j
                                                                                       : GD_NONE;
    if (of_same == GD_NONE) return 0;
    return takes_tie(work, third, of_same) ? -work->slack : work->slack;
}

static enum gd_status cover_by_others(const struct work *work, const struct gd__branch *branch,
                                      uint32_t i, uint32_t j)
{
    const struct gd__sources *sources = &work->scratch->sources;
    enum gd_status status = GD_OK;
    for (uint32_t k = 0; k < sources->count && !status; k++) {
        if (k == i || k == j || is_out_of_reach(work, i, k) || is_out_of_reach(work, j, k))
            continue;
        struct gd__focus focus = nudged(work, k);
        struct gd__turn lost = gd__branch_lost_to(branch, &focus, slack_against(work, k, i, j));
        narrow_to_view(work, branch, k, &lost);
        status = gd__spans_put(&work->scratch->covered, &lost, k);
    }
    return status;
}

/* Strands of the branch of two sources as seen from the first, which is a point if one of them
 * is. */
static enum gd_status append_between(const struct work *work, uint32_t i, uint32_t j)
{
    struct gd__voronoi_scratch *scratch = work->scratch;
    struct gd__focus source = nudged(work, i), other = nudged(work, j);
    struct gd__branch branch;
    if (is_out_of_reach(work, i, j) || is_out_of_reach(work, j, i)) return GD_OK;
    if (!gd__branch_between(&source, &other, work->middle, scratch->sources.frame.size, &branch))
        return GD_OK;
    /* the nudge's doing: the ray is bridged */
    if (gd__branch_width(&branch) <= work->tie) return GD_OK;
    struct gd__turn domain = domain_of(work, &branch, i, j);
    if (!domain.count) return GD_OK;
    enum gd_status status = cover_outside(work, &domain);
    if (!status) status = cover_by_others(work, &branch, i, j);
    if (!status) status = gd__spans_invert(&scratch->covered, DBL_EPSILON, &scratch->spans);
    if (!status) gd__spans_join(&scratch->spans);
    uint32_t a = member_of(work, i), b = member_of(work, j);
    struct gd__strand strand = {.face = scratch->sources.face,
                                .member = {a < b ? a : b, a < b ? b : a},
                                .node = {GD_NONE, GD_NONE},
                                .focus = {focus_of(work, i), focus_of(work, j)},
                                .is_straight = source.linear};
    for (uint32_t k = 0; k < scratch->spans.count && !status; k++)
        status = append_strand(work, &branch, &strand, &scratch->spans.span[k]);
    return status;
}

/* --- the face --------------------------------------------------------------------------------- */

static enum gd_status append_switches(const struct work *work)
{
    const struct gd__diagram *diagram = work->diagram;
    const struct gd_mesh *mesh = diagram->mesh;
    enum gd_status status = GD_OK;
    for (int k = 0; k < 3; k++) {
        uint32_t side = mesh->face_side[work->scratch->sources.face][k], edge = side >> 1;
        for (uint32_t i = diagram->first_switch[edge];
             i < diagram->first_switch[edge + 1] && !status; i++) {
            const struct gd__switch *s = &diagram->edge_switch[i];
            double t = side & 1 ? mesh->side[side].length - s->t : s->t;
            bool ascends = s->before < s->after;
            status = gd__loose_append(
                work->scratch,
                (struct gd__loose){
                    .at = gd__frame_place(&work->scratch->sources.frame, k, t, 0),
                    .member = {ascends ? s->before : s->after, ascends ? s->after : s->before},
                    .third = GD_NONE,
                    .strand = GD_NONE,
                    .node = s->node});
        }
    }
    return status;
}

/* Is a branch to be seen from the first rather than the second? From a point, if one of them is:
 * the one that the branch is nearer to and bends around, as what is seen from the other ill tells
 * apart the two sides of a narrow one. */
static bool is_before(const struct work *work, uint32_t i, uint32_t j)
{
    struct gd__focus a = nudged(work, i), b = nudged(work, j);
    return a.linear == b.linear ? a.sigma >= b.sigma : b.linear;
}

enum gd_status gd__face_strands(struct gd__diagram *diagram, uint32_t face,
                                struct gd__voronoi_scratch *scratch)
{
    struct gd__sources *sources = &scratch->sources;
    double most = most_in_face(diagram, face);
    scratch->loose_count = 0;
    if (most >= GD__FAR) return GD_OK;
    enum gd_status status = gd__sources_gather(diagram->field, face, most, sources);
    if (!status) drop_needless(diagram, sources);
    const struct gd__local *corner = sources->frame.corner;
    struct work work = {.diagram = diagram,
                        .scratch = scratch,
                        .middle = {(corner[0].x + corner[1].x + corner[2].x) / 3,
                                   (corner[0].y + corner[1].y + corner[2].y) / 3},
                        .slack = gd__envelope_slack(most, sources->frame.size),
                        .tie = GD_TOL_TIE * diagram->members.farthest};
    if (!status) status = append_switches(&work);
    if (status || are_of_one_member(&work)) return status;
    status = find_views(&work);
    for (uint32_t i = 0; i < sources->count && !status; i++) {
        for (uint32_t j = i + 1; j < sources->count && !status; j++) {
            if (member_of(&work, i) == member_of(&work, j)) continue;
            bool ordered = is_before(&work, i, j);
            status = append_between(&work, ordered ? i : j, ordered ? j : i);
        }
    }
    return status;
}
