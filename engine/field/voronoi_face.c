#include "base/array.h"
#include "field/voronoi_parts.h"

/* Bisectors in a face: for any two sources of different members, finds the parts of their branch
 * where no third source is nearer. */

/* The current face. */
struct work {
    struct gd__diagram *diagram;
    struct gd__voronoi_scratch *scratch;
    struct gd__local middle;
    double slack; /* tolerance for ties between sources of one member */
    double tie;   /* largest difference of two nudges */
};

static uint32_t member_of(const struct work *work, uint32_t i)
{
    return gd__member_of(&work->diagram->members, work->scratch->sources.source[i].pseudo);
}

static struct gd__focus focus_of(const struct work *work, uint32_t i)
{
    return gd__focus_of(&work->scratch->sources.source[i]);
}

static struct gd__focus nudged_focus(const struct work *work, uint32_t i)
{
    struct gd__focus focus = focus_of(work, i);
    focus.sigma += work->diagram->members.nudge[member_of(work, i)];
    return focus;
}

/* --- the sources ------------------------------------------------------------------------------ */

/* Computes the part of the face that each source sees. */
static enum gd_status find_views(const struct work *work)
{
    struct gd__voronoi_scratch *scratch = work->scratch;
    const struct gd__sources *sources = &scratch->sources;
    enum gd_status status = gd__array_extend(&scratch->view, &scratch->view_capacity,
                                             sources->count, sizeof *scratch->view, NULL);
    if (status) return status;
    for (uint32_t i = 0; i < sources->count; i++)
        scratch->view[i] =
            gd__source_view(work->diagram->field, &sources->frame, &sources->source[i],
                            work->diagram->members.nudge[member_of(work, i)]);
    return GD_OK;
}

static bool are_of_one_member(const struct work *work)
{
    for (uint32_t i = 1; i < work->scratch->sources.count; i++)
        if (member_of(work, i) != member_of(work, 0)) return false;
    return true;
}

/* --- a part of a bisector --------------------------------------------------------------------- */

enum gd_status gd__loose_end_append(struct gd__voronoi_scratch *scratch, struct gd__loose_end loose)
{
    return gd__array_append(&scratch->loose, &scratch->loose_count, &scratch->loose_capacity,
                            &loose, sizeof loose);
}

/* Returns true if no third source is nearer than `focus` by more than the nudge. Rounding may leave
 * a false part where wedges do not quite join. */
static bool is_nearest(const struct work *work, const struct gd__focus *focus, struct gd__local at)
{
    const struct gd__sources *sources = &work->scratch->sources;
    struct gd_point point =
        gd__face_frame_point(work->diagram->mesh, sources->face, &sources->frame, at);
    struct gd__leg_key way;
    gd__field_leg_key(work->diagram->field, &point, &way);
    return way.distance >=
           gd__focus_distance(focus, at) * (1 - GD_TOL_CHECK) - work->slack - work->tie;
}

static struct gd__loose_end end_of(const struct work *work,
                                   const struct gd__bisector_part *bisector_part, uint32_t by)
{
    struct gd__loose_end loose = {.member = {bisector_part->member[0], bisector_part->member[1]},
                                  .third = GD_NONE,
                                  .node = GD_NONE};
    if (by >= work->scratch->sources.count) return loose;
    uint32_t member = member_of(work, by);
    loose.third = by;
    loose.is_triple = member != bisector_part->member[0] && member != bisector_part->member[1];
    return loose;
}

static enum gd_status append_bisector_part(const struct work *work, const struct gd__branch *branch,
                                           const uint32_t pair[2], const struct gd__span *span)
{
    struct gd__arc arc = {{focus_of(work, pair[0]), focus_of(work, pair[1])},
                          branch->zero + span->from,
                          branch->zero + span->to};
    if (!is_nearest(work, &arc.focus[0], gd__branch_place(branch, 0.5 * (span->from + span->to))))
        return GD_OK;
    uint32_t a = member_of(work, pair[0]), b = member_of(work, pair[1]), number;
    struct gd__bisector_part bisector_part = {.face = work->scratch->sources.face,
                                              .member = {a < b ? a : b, a < b ? b : a},
                                              .node = {GD_NONE, GD_NONE}};
    enum gd_status status = gd__diagram_add_arc(work->diagram, &arc, &bisector_part.arc);
    if (!status) status = gd__diagram_add_bisector_part(work->diagram, &bisector_part, &number);
    for (uint32_t end = 0; end < 2 && !status; end++) {
        struct gd__loose_end loose =
            end_of(work, &bisector_part, end ? span->to_by : span->from_by);
        loose.at = gd__branch_place(branch, end ? span->to : span->from);
        loose.bisector_part = number;
        loose.end = end;
        status = gd__loose_end_append(work->scratch, loose);
    }
    return status;
}

/* --- two sources ------------------------------------------------------------------------------ */

static bool is_out_of_reach(const struct work *work, uint32_t i, uint32_t j)
{
    return gd__view_is_beyond(&work->scratch->view[i], &work->scratch->sources.source[j]);
}

/* Returns true if source i takes precedence over source j, when both belong to one member and are
 * equally near. If one source is seen through two wedges, the first wedge takes precedence. A
 * segment takes precedence over its end. */
static bool takes_tie(const struct work *work, uint32_t i, uint32_t j)
{
    const struct gd__source *source = work->scratch->sources.source;
    return source[i].linear == source[j].linear ? i < j : source[i].linear;
}

/* Returns the amount by which a third source must be nearer to win. */
static double slack_against(const struct work *work, uint32_t third, uint32_t i, uint32_t j)
{
    uint32_t member = member_of(work, third), of_same = member == member_of(work, i)   ? i
                                                        : member == member_of(work, j) ? j
                                                                                       : GD_NONE;
    if (of_same == GD_NONE) return 0;
    return takes_tie(work, third, of_same) ? -work->slack : work->slack;
}

static void cover_by_others(const struct work *work, const struct gd__branch *branch, uint32_t i,
                            uint32_t j)
{
    struct gd__sources *sources = &work->scratch->sources;
    uint32_t limit = GD__SPANS_FEW;
    for (uint32_t k = 0; k < sources->count; k++) {
        if (k == i || k == j || is_out_of_reach(work, i, k) || is_out_of_reach(work, j, k))
            continue;
        struct gd__focus focus = nudged_focus(work, k);
        struct gd__turn lost = gd__branch_lost_to(branch, &focus, slack_against(work, k, i, j));
        gd__branch_narrow_to_view(work->diagram->field, &sources->frame, branch,
                                  &sources->source[k], &lost);
        gd__spans_put(&sources->covered, &lost, k);
        if (gd__spans_settle(&sources->covered, GD_TOL_SPAN, &limit)) break;
    }
}

/* Appends the parts of the branch of two sources. The first source is a point unless both are
 * linear. */
static enum gd_status append_between(const struct work *work, uint32_t i, uint32_t j)
{
    struct gd__voronoi_scratch *scratch = work->scratch;
    struct gd__focus source = nudged_focus(work, i), other = nudged_focus(work, j);
    struct gd__branch branch;
    if (is_out_of_reach(work, i, j) || is_out_of_reach(work, j, i)) return GD_OK;
    if (!gd__branch_between(&source, &other, work->middle, scratch->sources.frame.size, &branch))
        return GD_OK;
    /* Due to the nudge, the branch folds back along a ray. Matching replaces the branch by a
     * straight bridge. */
    if (gd__branch_width(&branch) <= work->tie) return GD_OK;
    struct gd__turn domain =
        gd__branch_domain(work->diagram->field, &scratch->sources, &branch, (uint32_t[2]){i, j}, 0);
    if (!domain.count) return GD_OK;
    struct gd__spans *spans = &scratch->sources.spans, *covered = &scratch->sources.covered;
    gd__spans_cover_outside(&domain, covered, spans);
    cover_by_others(work, &branch, i, j);
    gd__spans_invert(covered, GD_TOL_SPAN, spans);
    gd__spans_join(spans);
    enum gd_status status = spans->status;
    for (uint32_t k = 0; k < spans->count && !status; k++)
        status = append_bisector_part(work, &branch, (uint32_t[2]){i, j}, &spans->span[k]);
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
            const struct gd__owner_change *s = &diagram->edge_switch[i];
            double t = side & 1 ? mesh->side[side].length - s->t : s->t;
            bool ascends = s->before < s->after;
            status = gd__loose_end_append(
                work->scratch,
                (struct gd__loose_end){
                    .at = gd__face_frame_place(&work->scratch->sources.frame, k, t, 0),
                    .member = {ascends ? s->before : s->after, ascends ? s->after : s->before},
                    .third = GD_NONE,
                    .bisector_part = GD_NONE,
                    .node = s->node});
        }
    }
    return status;
}

/* Returns true if the branch's centre should be source i rather than j. The centre is a point
 * rather than a linear source. Of two points, the centre is the point around which the branch
 * bends. Seen from the other point, the two sides of a narrow branch nearly coincide. */
static bool is_before(const struct work *work, uint32_t i, uint32_t j)
{
    struct gd__focus a = nudged_focus(work, i), b = nudged_focus(work, j);
    return a.linear == b.linear ? a.sigma >= b.sigma : b.linear;
}

enum gd_status gd__face_bisector_parts(struct gd__diagram *diagram, uint32_t face,
                                       struct gd__voronoi_scratch *scratch)
{
    struct gd__sources *sources = &scratch->sources;
    double most = gd__face_farthest(diagram->field, face);
    scratch->loose_count = 0;
    if (most >= GD__FAR) return GD_OK;
    enum gd_status status = gd__sources_gather(diagram->field, face, most, sources);
    if (!status) gd__sources_drop_needless(diagram->field, sources);
    struct work work = {.diagram = diagram,
                        .scratch = scratch,
                        .middle = gd__face_frame_middle(&sources->frame),
                        .slack = gd__envelope_slack(most, sources->frame.size),
                        .tie = GD_TOL_TIE * diagram->members.farthest};
    if (!status) status = append_switches(&work);
    if (status || are_of_one_member(&work)) return status;
    status = find_views(&work);
    for (uint32_t i = 0; i < sources->count && !status; i++) {
        for (uint32_t j = i + 1; j < sources->count && !status; j++) {
            if (member_of(&work, i) == member_of(&work, j)) continue;
            bool ordered = is_before(&work, i, j);
            status = gd__pace_step(&scratch->pace, sources->count);
            if (!status) status = append_between(&work, ordered ? i : j, ordered ? j : i);
        }
    }
    return status;
}
