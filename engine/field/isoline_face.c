#include "base/array.h"
#include "field/isoline_parts.h"

/* The isoline inside one face: finds its arcs and joins them to chains. */

/* work of one source of a face, in steps of the pace */
enum { STEPS_A_SOURCE = 8 };

/* A position in the face where a part of a line must continue. Each departing end is matched with
 * an arriving end. A departing end is the end of an arc, or a crossing where the line enters the
 * face. An arriving end is the start of an arc, or a crossing where the line leaves the face. */
struct gd__end {
    struct gd__local at;
    uint32_t arc;      /* GD_NONE means a crossing */
    uint32_t crossing; /* GD_NONE means an end of an arc */
    bool goes_on;
    uint32_t match; /* the matching end; GD_NONE if not matched yet */
};

struct gd__arc {
    struct gd__circle circle;
    double from, to;
    uint32_t start, stop; /* numbers of the arc's ends */
    bool is_chained;
};

struct gd__order {
    double x;
    uint32_t end;
};

/* Two ends that may match, and their distance squared. */
struct gd__link {
    double apart;
    uint32_t from, to;
};

struct work {
    const struct gd_field *field;
    double level;
    struct gd__pace *pace;
    struct gd__face_scratch *scratch;
    struct gd__isoline_parts *parts;
};

void gd__face_scratch_destroy(struct gd__face_scratch *scratch)
{
    gd__sources_destroy(&scratch->sources);
    free(scratch->arc);
    free(scratch->end);
    free(scratch->order);
    free(scratch->link);
    *scratch = (struct gd__face_scratch){0};
}

/* --- ends ------------------------------------------------------------------------------------- */

static enum gd_status append_end(struct gd__face_scratch *scratch, struct gd__end end)
{
    return gd__array_append(&scratch->end, &scratch->end_count, &scratch->end_capacity, &end,
                            sizeof end);
}

/* Appends the crossings of the face's sides. Walking counter-clockwise around the face, a line
 * enters where the distance rises above the level. */
static enum gd_status append_crossings(const struct work *work, uint32_t face)
{
    const struct gd_mesh *mesh = work->field->mesh;
    enum gd_status status = GD_OK;
    for (int k = 0; k < 3; k++) {
        uint32_t side = mesh->face_side[face][k], edge = side >> 1;
        double length = mesh->side[side].length;
        uint32_t first, end;
        gd__edge_crossings(work->parts, edge, &first, &end);
        for (uint32_t i = first; i < end && !status; i++) {
            const struct gd__crossing *crossing = &work->parts->crossing[i];
            double t = side & 1 ? length - crossing->t : crossing->t;
            status = append_end(
                work->scratch,
                (struct gd__end){.at = gd__face_frame_place(&work->scratch->sources.frame, k, t, 0),
                                 .arc = GD_NONE,
                                 .crossing = i,
                                 .goes_on = crossing->from_below != (side & 1),
                                 .match = GD_NONE});
        }
    }
    return status;
}

/* --- arcs ------------------------------------------------------------------------------------- */

/* Returns true if the distance at a position is the level. Rounding may leave a false arc where
 * wedges do not quite join. */
static bool is_at_level(const struct work *work, struct gd__local at)
{
    const struct gd__sources *sources = &work->scratch->sources;
    struct gd_point point =
        gd__face_frame_point(work->field->mesh, sources->face, &sources->frame, at);
    struct gd__leg_key way;
    gd__field_leg_key(work->field, &point, &way);
    return way.distance >=
           work->level * (1 - GD_TOL_CHECK) - gd__envelope_slack(work->level, sources->frame.size);
}

static enum gd_status append_arc(struct gd__face_scratch *scratch, struct gd__arc arc)
{
    arc.start = scratch->end_count;
    arc.stop = arc.start + 1;
    struct gd__end end = {.arc = scratch->arc_count,
                          .at = gd__circle_place(&arc.circle, arc.from),
                          .crossing = GD_NONE,
                          .match = GD_NONE};
    enum gd_status status = gd__array_append(&scratch->arc, &scratch->arc_count,
                                             &scratch->arc_capacity, &arc, sizeof arc);
    if (!status) status = append_end(scratch, end);
    end.at = gd__circle_place(&arc.circle, arc.to);
    end.goes_on = true;
    return status ? status : append_end(scratch, end);
}

static enum gd_status append_arcs(const struct work *work)
{
    struct gd__face_scratch *scratch = work->scratch;
    struct gd__sources *sources = &scratch->sources;
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < sources->count && !status; i++) {
        struct gd__arc arc = {.circle = gd__circle_of(sources, i, work->level)};
        status = gd__pace_step(work->pace, STEPS_A_SOURCE * sources->count);
        if (!status) status = gd__circle_arcs(sources, i, work->level);
        for (uint32_t k = 0; k < sources->spans.count && !status; k++) {
            arc.from = sources->spans.span[k].from;
            arc.to = sources->spans.span[k].to;
            if (is_at_level(work, gd__circle_place(&arc.circle, 0.5 * (arc.from + arc.to))))
                status = append_arc(scratch, arc);
        }
    }
    return status;
}

/* --- matching --------------------------------------------------------------------------------- */

static int by_place(const void *a, const void *b)
{
    const struct gd__order *x = a, *y = b;
    if (x->x != y->x) return x->x < y->x ? -1 : 1;
    return (x->end > y->end) - (x->end < y->end);
}

static int by_distance(const void *a, const void *b)
{
    const struct gd__link *x = a, *y = b;
    if (x->apart != y->apart) return x->apart < y->apart ? -1 : 1;
    if (x->from != y->from) return x->from < y->from ? -1 : 1;
    return (x->to > y->to) - (x->to < y->to);
}

/* Collects the unmatched ends, sorted by x. Error: GD_NO_MEMORY. */
static enum gd_status sort_ends(struct gd__face_scratch *scratch, uint32_t *count)
{
    enum gd_status status =
        gd__array_extend(&scratch->order, &scratch->order_capacity,
                         scratch->end_count + UINT64_C(1), sizeof *scratch->order, NULL);
    if (status) return status;
    *count = 0;
    for (uint32_t i = 0; i < scratch->end_count; i++)
        if (scratch->end[i].match == GD_NONE)
            scratch->order[(*count)++] = (struct gd__order){scratch->end[i].at.x, i};
    qsort(scratch->order, *count, sizeof *scratch->order, by_place);
    return GD_OK;
}

static enum gd_status append_link(struct gd__face_scratch *scratch, uint32_t a, uint32_t b)
{
    const struct gd__end *from = &scratch->end[a], *to = &scratch->end[b];
    if (from->goes_on == to->goes_on) return GD_OK;
    struct gd__local apart = gd__local_minus(to->at, from->at);
    struct gd__link link = {gd__local_dot(apart, apart), from->goes_on ? a : b,
                            from->goes_on ? b : a};
    return gd__array_append(&scratch->link, &scratch->link_count, &scratch->link_capacity, &link,
                            sizeof link);
}

/* Matches ends at most `reach` apart along x, the nearest first. */
static enum gd_status match_within(struct gd__face_scratch *scratch, double reach)
{
    uint32_t count = 0;
    enum gd_status status = sort_ends(scratch, &count);
    scratch->link_count = 0;
    for (uint32_t i = 0; i < count && !status; i++)
        for (uint32_t k = i + 1;
             k < count && scratch->order[k].x - scratch->order[i].x <= reach && !status; k++)
            status = append_link(scratch, scratch->order[i].end, scratch->order[k].end);
    if (status || !scratch->link_count) return status;
    qsort(scratch->link, scratch->link_count, sizeof *scratch->link, by_distance);
    for (uint32_t i = 0; i < scratch->link_count; i++) {
        struct gd__end *from = &scratch->end[scratch->link[i].from],
                       *to = &scratch->end[scratch->link[i].to];
        if (from->match != GD_NONE || to->match != GD_NONE) continue;
        from->match = scratch->link[i].to;
        to->match = scratch->link[i].from;
    }
    return GD_OK;
}

/* Matches all ends: there are as many departing as arriving ends. */
static enum gd_status match_ends(struct gd__face_scratch *scratch)
{
    enum gd_status status = match_within(scratch, GD_TOL_MEET * scratch->sources.frame.size);
    return status ? status : match_within(scratch, INFINITY);
}

/* --- chains ----------------------------------------------------------------------------------- */

static enum gd_status append_piece(struct gd__isoline_parts *parts,
                                   const struct gd__isoline_piece *piece)
{
    return gd__arena_append(&parts->arena, &parts->piece, &parts->piece_count,
                            &parts->piece_capacity, piece, sizeof *piece);
}

/* Returns the surface point of an end; a crossing is a point of its edge. */
static struct gd_point point_of(const struct work *work, const struct gd__end *end)
{
    const struct gd_mesh *mesh = work->field->mesh;
    const struct gd__sources *sources = &work->scratch->sources;
    if (end->crossing != GD_NONE)
        return gd__crossing_point(mesh, &work->parts->crossing[end->crossing]);
    return gd__face_frame_point(mesh, sources->face, &sources->frame, end->at);
}

/* Returns the angle of a position around a circle's centre. Of the values that differ by multiples
 * of 2 pi, returns the one nearest to `angle`. */
static double angle_near(const struct gd__circle *circle, double angle, struct gd__local at)
{
    return angle + remainder(gd__circle_angle(circle, at) - angle, 2 * M_PI);
}

/* Returns the length along a line from `start` to `stop`; negative if the line leads from `stop` to
 * `start`. */
static double way_along(const struct gd__circle *line, struct gd__local start,
                        struct gd__local stop)
{
    struct gd__local along = gd__circle_along(line);
    double dx = stop.x - start.x, dy = stop.y - start.y;
    return copysign(sqrt(dx * dx + dy * dy), dx * along.x + dy * along.y);
}

/* Returns an arc as a piece between two ends, with its angles adjusted to the ends. */
static struct gd__isoline_piece piece_of(const struct work *work, const struct gd__arc *arc,
                                         const struct gd__end *start, const struct gd__end *stop)
{
    const struct gd__circle *circle = &arc->circle;
    struct gd__isoline_piece piece = {.face = work->scratch->sources.face,
                                      .start = point_of(work, start)};
    if (circle->straight) {
        piece.centre = start->at;
        piece.to = way_along(circle, start->at, stop->at);
        return piece;
    }
    piece.centre = circle->centre;
    piece.radius = circle->radius;
    piece.from = circle->zero + angle_near(circle, arc->from, start->at);
    piece.to = circle->zero + angle_near(circle, arc->to, stop->at);
    return piece;
}

/* Joins two crossings that, because of rounding, have no arc between them. The new arc has the
 * source whose distance at both crossings is nearest to the level. */
static enum gd_status bridge_crossings(const struct work *work, const struct gd__end *entry,
                                       const struct gd__end *exit)
{
    const struct gd__sources *sources = &work->scratch->sources;
    double least = INFINITY;
    uint32_t best = 0;
    if (!sources->count || (entry->at.x == exit->at.x && entry->at.y == exit->at.y)) return GD_OK;
    for (uint32_t i = 0; i < sources->count; i++) {
        double misfit = fabs(gd__source_distance(&sources->source[i], entry->at) - work->level) +
                        fabs(gd__source_distance(&sources->source[i], exit->at) - work->level);
        if (misfit >= least) continue;
        least = misfit;
        best = i;
    }
    struct gd__arc arc = {.circle = gd__circle_of(sources, best, work->level)};
    arc.from = arc.to = gd__circle_angle(&arc.circle, entry->at);
    struct gd__isoline_piece piece = piece_of(work, &arc, entry, exit);
    return append_piece(work->parts, &piece);
}

/* Returns true for a loop inside the face that is shorter than the promised precision. Rounding
 * creates such a loop where arcs cross and leave a tiny area uncovered. */
static bool is_rounding(const struct work *work, const struct gd__isoline_chain *chain)
{
    double length = 0;
    if (chain->exit != GD_NONE) return false;
    for (uint32_t i = 0; i < chain->count; i++) {
        const struct gd__isoline_piece *piece = &work->parts->piece[chain->first + i];
        length += (piece->radius > 0 ? piece->radius : 1) * fabs(piece->to - piece->from);
    }
    return length <= GD_TOL_CHECK * work->level;
}

/* Appends the chain of arcs that follows a departing end, up to the crossing where the line leaves
 * the face, or back to the first arc. */
static enum gd_status chain_from(const struct work *work, const struct gd__end *entry)
{
    struct gd__face_scratch *scratch = work->scratch;
    struct gd__isoline_chain chain = {
        .entry = entry->crossing, .exit = GD_NONE, .first = work->parts->piece_count};
    const struct gd__end *start = &scratch->end[entry->match];
    enum gd_status status = GD_OK;
    bool is_first = true;
    while (start->arc != GD_NONE && !scratch->arc[start->arc].is_chained && !status) {
        struct gd__arc *arc = &scratch->arc[start->arc];
        const struct gd__end *next = &scratch->end[scratch->end[arc->stop].match];
        struct gd__isoline_piece piece =
            piece_of(work, arc, is_first && entry->arc == GD_NONE ? entry : start, next);
        status = append_piece(work->parts, &piece);
        arc->is_chained = chain.has_arcs = true;
        is_first = false;
        start = next;
    }
    if (!status && start->arc == GD_NONE) chain.exit = start->crossing;
    if (!status && !chain.has_arcs) status = bridge_crossings(work, entry, start);
    chain.count = work->parts->piece_count - chain.first;
    if (!status && !is_rounding(work, &chain))
        return gd__arena_append(&work->parts->arena, &work->parts->chain, &work->parts->chain_count,
                                &work->parts->chain_capacity, &chain, sizeof chain);
    work->parts->piece_count = chain.first;
    return status;
}

static enum gd_status append_chains(const struct work *work)
{
    struct gd__face_scratch *scratch = work->scratch;
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < scratch->end_count && !status; i++) {
        const struct gd__end *end = &scratch->end[i];
        if (end->crossing != GD_NONE && end->goes_on) status = chain_from(work, end);
    }
    for (uint32_t i = 0; i < scratch->arc_count && !status; i++) {
        const struct gd__arc *arc = &scratch->arc[i];
        if (!arc->is_chained)
            status = chain_from(work, &scratch->end[scratch->end[arc->start].match]);
    }
    return status;
}

enum gd_status gd__isoline_cross_face(const struct gd_field *field, uint32_t face, double level,
                                      struct gd__pace *pace, struct gd__face_scratch *scratch,
                                      struct gd__isoline_parts *parts)
{
    struct work work = {field, level, pace, scratch, parts};
    scratch->arc_count = scratch->end_count = 0;
    enum gd_status status = gd__sources_gather(field, face, level, &scratch->sources);
    if (!status) status = append_crossings(&work, face);
    if (!status) status = append_arcs(&work);
    if (!status) status = match_ends(scratch);
    return status ? status : append_chains(&work);
}
