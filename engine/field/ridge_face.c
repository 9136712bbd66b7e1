#include "base/array.h"
#include "field/ridges.h"

/* Ridges in a face: for any two unrelated sources, the parts of their branch where no third source
 * is nearer. */

#define SLACKS        4   /* distances agree if they differ by at most this many rounding errors */
#define BESIDE_SLACKS 0.5 /* a ridge along an edge is off by at most this many rounding errors */
#define CORNER_SNAPS  16  /* an end at most this many rounding errors from a corner lies on it */
#define NARROW_SLACKS 16  /* a branch at most this many rounding errors wide is a ray */

/* The current face. */
struct work {
    struct gd__ridges *ridges;
    const struct gd_field *field;
    const struct gd__sources *sources;
    struct gd__local middle;
    double slack; /* rounding error of distances in the face */
    uint32_t row; /* number of words in a row of rivals */
};

static const struct gd__source *source_at(const struct work *work, uint32_t i)
{
    return &work->sources->source[i];
}

/* Two sources and their branch. */
struct pair {
    uint32_t number[2];
    struct gd__focus focus[2];
    struct gd__branch branch;
    double beside; /* rounding error across the branch, in the middle of the face */
};

/* --- related sources -------------------------------------------------------------------------- */

static bool is_on_path(const struct work *work, const struct gd__source *from,
                       const struct gd__source *point)
{
    double apart = gd__source_distance(from, point->at) - point->sigma;
    return !point->linear && fabs(apart) <= SLACKS * work->slack;
}

static bool is_same_line(const struct work *work, const struct gd__source *a,
                         const struct gd__source *b)
{
    double apart = gd__source_distance(a, work->middle) - gd__source_distance(b, work->middle);
    return gd__local_length(gd__local_minus(a->gradient, b->gradient)) <= GD_TOL_CHECK &&
           fabs(apart) <= SLACKS * work->slack;
}

static bool are_related(const struct work *work, uint32_t i, uint32_t j)
{
    const struct gd__source *a = source_at(work, i), *b = source_at(work, j);
    if (a->linear && b->linear) return is_same_line(work, a, b);
    return is_on_path(work, a, b) || is_on_path(work, b, a);
}

/* Returns true if source i takes precedence over its related source j where both are equally near.
 * A segment takes precedence over its end, a source over a corner on its path, and the first wedge
 * of a source over the other wedges. */
static bool takes_precedence(const struct work *work, uint32_t i, uint32_t j)
{
    const struct gd__source *a = source_at(work, i), *b = source_at(work, j);
    if (a->linear != b->linear) return a->linear;
    if (!a->linear && fabs(a->sigma - b->sigma) > SLACKS * work->slack) return a->sigma < b->sigma;
    return i < j;
}

/* --- directions ------------------------------------------------------------------------------- */

static struct gd__local direction_of(const struct gd__focus *focus, struct gd__local at)
{
    return focus->linear ? focus->gradient : gd__local_minus(at, focus->at);
}

/* Returns the angle at which the paths of two sources meet at a position. */
static double angle_at(const struct gd__focus focus[2], struct gd__local at)
{
    struct gd__local u = direction_of(&focus[0], at), v = direction_of(&focus[1], at);
    return atan2(fabs(gd__local_cross(u, v)), gd__local_dot(u, v));
}

/* Returns a bound of the rounding error of a branch at a position, measured across the branch. */
static double beside_at(const struct work *work, const struct gd__focus focus[2],
                        struct gd__local at)
{
    double angle = fmax(angle_at(focus, at), GD_TOL_RIDGE);
    return BESIDE_SLACKS * work->slack / (2 * sin(0.5 * angle));
}

/* --- ends of a part --------------------------------------------------------------------------- */

/* Sets the element on which an end lies, and the end's position there. Returns false if the end
 * lies inside the face. `snap` is the rounding error of positions at the border of the face. */
static bool put_on_border(const struct work *work, struct gd__local at, double snap,
                          struct gd__ridge_end *out)
{
    const struct gd_mesh *mesh = work->field->mesh;
    const struct gd__face_frame *frame = &work->sources->frame;
    for (int k = 0; k < 3; k++) {
        if (gd__local_length(gd__local_minus(at, frame->corner[k])) > CORNER_SNAPS * snap) continue;
        out->kind = GD_POINT_VERTEX;
        out->element = mesh->origin[mesh->face_side[work->sources->face][k]];
        out->point = gd__point_of_vertex(out->element);
        return true;
    }
    for (int k = 0; k < 3; k++) {
        struct gd__local from = gd__local_minus(at, frame->corner[k]);
        if (fabs(gd__local_cross(frame->along[k], from)) > snap) continue;
        uint32_t side = mesh->face_side[work->sources->face][k];
        double t = gd__local_dot(frame->along[k], from), length = frame->length[k];
        out->kind = GD_POINT_EDGE;
        out->element = side >> 1;
        out->at = (struct gd__local){side & 1 ? length - t : t, 0};
        out->point = gd__point_of_edge(mesh, out->element,
                                       fmin(fmax(out->at.x / mesh->side[side].length, 0), 1));
        return true;
    }
    return false;
}

/* Moves a position along the bisector of two sources to a side of the face. The side is at most
 * `reach` away. Uses Newton's method for two equations: the distances are equal, and the height
 * above the side is 0. */
static struct gd__local move_to_side(const struct gd__face_frame *frame,
                                     const struct gd__focus focus[2], struct gd__local at,
                                     double reach)
{
    for (int k = 0; k < 3; k++) {
        struct gd__local u = frame->along[k], from = gd__local_minus(at, frame->corner[k]);
        if (fabs(gd__local_cross(u, from)) > reach) continue;
        double foot = gd__local_dot(u, from);
        for (int i = 0; i < 4; i++) {
            struct gd__local place = {frame->corner[k].x + foot * u.x,
                                      frame->corner[k].y + foot * u.y};
            struct gd__local d[2];
            for (int e = 0; e < 2; e++) {
                d[e] = direction_of(&focus[e], place);
                double size = gd__local_length(d[e]);
                d[e] = (struct gd__local){d[e].x / size, d[e].y / size};
            }
            double slope = gd__local_dot(gd__local_minus(d[0], d[1]), u),
                   step = (gd__focus_distance(&focus[0], place) -
                           gd__focus_distance(&focus[1], place)) /
                          slope;
            if (!(fabs(step) <= reach / GD_TOL_TANGENT)) return at;
            foot -= step;
        }
        struct gd__local place = {frame->corner[k].x + foot * u.x, frame->corner[k].y + foot * u.y};
        return gd__local_length(gd__local_minus(place, at)) <= reach / GD_TOL_TANGENT ? place : at;
    }
    return at;
}

/* Computes the precise position of an end. `third` is the source that is nearer beyond the end, or
 * GD__SPAN_OPEN at a border of the face or of a view. If the third source is related, it is not
 * nearer beyond the end; such an end lies at the border of a view. */
static struct gd__local refine_end(const struct work *work, const struct pair *pair, uint32_t third,
                                   struct gd__local at, double beside)
{
    const struct gd__face_frame *frame = &work->sources->frame;
    double reach = GD_TOL_NODE * frame->size;
    if (third < work->sources->count && !are_related(work, third, pair->number[0]) &&
        !are_related(work, third, pair->number[1])) {
        struct gd__focus three[3] = {pair->focus[0], pair->focus[1],
                                     gd__focus_of(source_at(work, third))};
        struct gd__local place = gd__between_three(three, at, reach);
        return gd__face_frame_has(frame, place, beside) ? place : at;
    }
    return move_to_side(frame, pair->focus, gd__between_two(pair->focus, at, reach), 2 * beside);
}

/* Locates an end. */
static struct gd__ridge_end locate_end(const struct work *work, struct gd__local at, double beside)
{
    const struct gd__face_frame *frame = &work->sources->frame;
    double snap = 2 * beside + GD_TOL_RIDGE_END * frame->size;
    struct gd__ridge_end end = {
        .kind = GD_POINT_FACE, .element = work->sources->face, .at = at, .near = snap};
    if (!put_on_border(work, at, snap, &end))
        end.point = gd__face_frame_point(work->field->mesh, work->sources->face, frame, at);
    return end;
}

/* Returns the number of the side along which a part runs, or 3 if there is none. The ends and the
 * middle of the part must be on the side. */
static int side_along(const struct work *work, const struct gd__ridge_end end[2],
                      struct gd__local middle)
{
    const struct gd_mesh *mesh = work->field->mesh;
    const struct gd__face_frame *frame = &work->sources->frame;
    for (int k = 0; k < 3; k++) {
        uint32_t side = mesh->face_side[work->sources->face][k];
        double height = gd__local_cross(frame->along[k], gd__local_minus(middle, frame->corner[k]));
        bool is_along = fabs(height) <= end[0].near;
        for (int e = 0; e < 2; e++)
            is_along &= end[e].kind == GD_POINT_VERTEX
                            ? end[e].element == mesh->origin[side] ||
                                  end[e].element == mesh->origin[side ^ 1]
                            : end[e].kind == GD_POINT_EDGE && end[e].element == side >> 1;
        if (is_along) return k;
    }
    return 3;
}

/* --- a part ----------------------------------------------------------------------------------- */

/* Returns true if both paths to a position are longer than the rounding error, and no third source
 * is nearer. Rounding may leave a false part where wedges do not quite join. The two sides of one
 * segment have no ridge along the segment. */
static bool is_ridge(const struct work *work, const struct pair *pair, struct gd__local at)
{
    const struct gd__sources *sources = work->sources;
    struct gd_point point =
        gd__face_frame_point(work->field->mesh, sources->face, &sources->frame, at);
    struct gd__leg_key way;
    gd__field_leg_key(work->field, &point, &way);
    double distance = gd__focus_distance(&pair->focus[0], at), slack = SLACKS * work->slack;
    if (way.distance < distance * (1 - GD_TOL_CHECK) - slack) return false;
    uint32_t vertices = work->field->mesh->vertex_count;
    bool is_away = false;
    for (int k = 0; k < 2; k++) {
        uint32_t pseudo = source_at(work, pair->number[k])->pseudo;
        is_away |= pseudo < vertices || distance > gd__field_sigma(work->field, pseudo) + slack;
    }
    return is_away;
}

/* Returns true if the exported polyline needs no point between the ends of a part. This must also
 * hold if the ends are moved by `near`, or to a node close by. The test is that of voronoi_line.c,
 * with half the tolerance. */
static bool is_straight(const struct work *work, const struct gd__arc *arc,
                        const struct gd__local end[2], double near)
{
    const double tolerance = work->ridges->tolerance, small = 0.125;
    if (arc->focus[0].linear) return true;
    if (arc->to - arc->from >= M_PI_2 ||
        near + GD_TOL_NODE * work->sources->frame.size > small * tolerance)
        return false;
    struct gd__local middle = {0.5 * (end[0].x + end[1].x), 0.5 * (end[0].y + end[1].y)},
                     at = gd__between_two(arc->focus, middle,
                                          gd__local_length(gd__local_minus(end[1], end[0])));
    return gd__local_length(gd__local_minus(at, middle)) <= 0.5 * tolerance;
}

static enum gd_status add_part(const struct work *work, const struct pair *pair,
                               const struct gd__span *span)
{
    const struct gd__branch *branch = &pair->branch;
    struct gd__local middle = gd__branch_place(branch, 0.5 * (span->from + span->to)),
                     at[2] = {gd__branch_place(branch, span->from),
                              gd__branch_place(branch, span->to)};
    double angle = angle_at(pair->focus, middle);
    for (int k = 0; k < 2; k++) angle = fmax(angle, angle_at(pair->focus, at[k]));
    if (angle < GD_TOL_RIDGE || !is_ridge(work, pair, middle)) return GD_OK;
    const struct gd__arc arc = {
        {pair->focus[0], pair->focus[1]}, branch->zero + span->from, branch->zero + span->to};
    const struct gd__members *members = &work->ridges->diagram.members;
    uint32_t a = gd__member_of(members, source_at(work, pair->number[0])->pseudo),
             b = gd__member_of(members, source_at(work, pair->number[1])->pseudo);
    struct gd__ridge ridge = {.part = {.face = work->sources->face,
                                       .member = {a < b ? a : b, a < b ? b : a},
                                       .node = {GD_NONE, GD_NONE}},
                              .pair = {angle, {pair->number[0], pair->number[1]}}};
    for (int k = 0; k < 2; k++) {
        double beside = fmax(pair->beside, beside_at(work, pair->focus, at[k]));
        at[k] = refine_end(work, pair, k ? span->to_by : span->from_by, at[k], beside);
        ridge.end[k] = locate_end(work, at[k], beside);
    }
    int side = side_along(work, ridge.end, middle);
    if (side == 3)
        return gd__ridges_add(work->ridges, &ridge,
                              is_straight(work, &arc, at, ridge.end[0].near) ? NULL : &arc);
    return gd__ridges_add_along(work->ridges,
                                work->field->mesh->face_side[ridge.part.face][side] >> 1, &ridge);
}

/* --- sources that compete --------------------------------------------------------------------- */

enum { BITS = 64 /* of a word in a row of rivals */ };

/* Returns the row of a view: a bit for each source, set if the source competes in the view. */
static uint64_t *rivals_of(const struct work *work, uint32_t i)
{
    return work->ridges->rivals + (size_t)i * work->row;
}

static bool are_rivals(const struct work *work, uint32_t i, uint32_t j)
{
    return rivals_of(work, i)[j / BITS] >> j % BITS & 1 &&
           rivals_of(work, j)[i / BITS] >> i % BITS & 1;
}

static enum gd_status find_rivals(struct work *work)
{
    struct gd__ridges *ridges = work->ridges;
    uint32_t count = work->sources->count;
    work->row = (count + BITS - 1) / BITS;
    uint64_t words = (uint64_t)work->row * count;
    enum gd_status status =
        gd__arena_extend(&ridges->diagram.arena, &ridges->rivals, &ridges->rivals_capacity, words,
                         sizeof *ridges->rivals);
    for (uint32_t i = 0; i < count && !status; i++) {
        const struct gd__view *view = &ridges->scratch.view[i];
        uint64_t *row = rivals_of(work, i);
        for (uint32_t word = 0; word < work->row; word++) row[word] = 0;
        for (uint32_t k = 0; k < count; k++)
            row[k / BITS] |= (uint64_t)!gd__view_is_beyond(view, source_at(work, k)) << k % BITS;
        status = gd__pace_step(&ridges->pace, count / 2);
    }
    return status;
}

/* --- two sources ------------------------------------------------------------------------------ */

/* Returns the amount by which a third source must be nearer to win. */
static double slack_against(const struct work *work, uint32_t third, const uint32_t number[2])
{
    double slack = 0;
    for (int k = 0; k < 2; k++) {
        if (!are_related(work, third, number[k])) continue;
        if (takes_precedence(work, third, number[k])) return -SLACKS * work->slack;
        slack = SLACKS * work->slack;
    }
    return slack;
}

static void cover_by_third(const struct work *work, const struct pair *pair, uint32_t k)
{
    struct gd__focus third = gd__focus_of(source_at(work, k));
    struct gd__turn lost =
        gd__branch_lost_to(&pair->branch, &third, slack_against(work, k, pair->number));
    gd__branch_narrow_to_view(work->field, &work->sources->frame, &pair->branch, source_at(work, k),
                              &lost);
    gd__spans_put(&work->ridges->scratch.sources.covered, &lost, k);
}

/* Covers the spans where one of the sources that compete in both views is nearer. */
static void cover_by_others(const struct work *work, const struct pair *pair)
{
    const uint64_t *first = rivals_of(work, pair->number[0]),
                   *second = rivals_of(work, pair->number[1]);
    struct gd__spans *covered = &work->ridges->scratch.sources.covered;
    uint32_t limit = GD__SPANS_FEW;
    for (uint32_t word = 0; word < work->row; word++) {
        for (uint64_t bits = first[word] & second[word]; bits; bits &= bits - 1) {
            uint32_t k = word * BITS + (uint32_t)__builtin_ctzll(bits);
            if (k != pair->number[0] && k != pair->number[1]) cover_by_third(work, pair, k);
        }
        if (gd__spans_settle(covered, GD_TOL_SPAN, &limit)) break;
    }
}

static enum gd_status add_parts(const struct work *work, const struct pair *pair)
{
    struct gd__spans *spans = &work->ridges->scratch.sources.spans,
                     *covered = &work->ridges->scratch.sources.covered;
    struct gd__turn domain =
        gd__branch_domain(work->field, work->sources, &pair->branch, pair->number, pair->beside);
    if (!domain.count) return GD_OK;
    enum gd_status status = gd__pace_step(&work->ridges->pace, 64);
    if (status) return status;
    gd__spans_cover_outside(&domain, covered, spans);
    cover_by_others(work, pair);
    gd__spans_invert(covered, GD_TOL_SPAN, spans);
    gd__spans_join(spans);
    status = spans->status;
    for (uint32_t k = 0; k < spans->count && !status; k++)
        status = add_part(work, pair, &spans->span[k]);
    return status;
}

static enum gd_status add_between(const struct work *work, uint32_t i, uint32_t j)
{
    const struct gd__source *a = source_at(work, i), *b = source_at(work, j);
    if (are_related(work, i, j)) return GD_OK;
    /* the centre of a branch's polar form is a point source; of two points, the point around which
       the branch bends */
    bool ordered = a->linear == b->linear ? a->sigma >= b->sigma : b->linear;
    struct pair pair = {.number = {ordered ? i : j, ordered ? j : i},
                        .focus = {gd__focus_of(ordered ? a : b), gd__focus_of(ordered ? b : a)}};
    if (!gd__branch_between(&pair.focus[0], &pair.focus[1], work->middle, work->sources->frame.size,
                            &pair.branch) ||
        gd__branch_width(&pair.branch) <= NARROW_SLACKS * work->slack)
        return GD_OK;
    pair.beside = beside_at(work, pair.focus, work->middle);
    return add_parts(work, &pair);
}

/* --- the face --------------------------------------------------------------------------------- */

/* Computes the views, and removes the sources that see nothing. */
static enum gd_status find_views(struct work *work, struct gd__sources *sources)
{
    struct gd__voronoi_scratch *scratch = &work->ridges->scratch;
    enum gd_status status = gd__array_extend(&scratch->view, &scratch->view_capacity,
                                             sources->count, sizeof *scratch->view, NULL);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < sources->count && !status; i++) {
        scratch->view[kept] = gd__source_view(work->field, &sources->frame, &sources->source[i], 0);
        if (scratch->view[kept].count) sources->source[kept++] = sources->source[i];
    }
    if (!status) sources->count = kept;
    return status;
}

/* Gathers the sources of a face that see a part of it; none if the face is not reached. */
static enum gd_status gather(struct gd__ridges *ridges, uint32_t face, struct work *out)
{
    const struct gd_field *field = ridges->diagram.field;
    struct gd__sources *sources = &ridges->scratch.sources;
    double most = gd__face_farthest(field, face);
    sources->count = 0;
    enum gd_status status = most < GD__FAR ? gd__sources_gather(field, face, most, sources) : GD_OK;
    if (status || !sources->count) return status;
    gd__sources_drop_needless(field, sources);
    *out = (struct work){.ridges = ridges,
                         .field = field,
                         .sources = sources,
                         .middle = gd__face_frame_middle(&sources->frame),
                         .slack = gd__envelope_slack(most, sources->frame.size)};
    return find_views(out, sources);
}

enum gd_status gd__ridge_foci(struct gd__ridges *ridges, uint32_t part, struct gd__focus focus[2])
{
    struct work work;
    enum gd_status status = gather(ridges, ridges->diagram.bisector_part[part].face, &work);
    for (int k = 0; k < 2 && !status; k++)
        focus[k] = gd__focus_of(&ridges->scratch.sources.source[ridges->pair[part].source[k]]);
    return status;
}

enum gd_status gd__ridges_of_face(struct gd__ridges *ridges, uint32_t face)
{
    struct work work;
    enum gd_status status = gather(ridges, face, &work);
    uint32_t count = ridges->scratch.sources.count;
    if (!status && count) status = find_rivals(&work);
    for (uint32_t i = 0; i < count && !status; i++) {
        status = gd__pace_step(&ridges->pace, count / 8);
        for (uint32_t j = i + 1; j < count && !status; j++)
            if (are_rivals(&work, i, j)) status = add_between(&work, i, j);
    }
    return status;
}
