/* Paths in a trimmed domain: computes all candidates, selects among them, and converts the selected
 * ones to struct gd_geodesic. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "nurbs/answer.h"
#include "nurbs/taut.h"

enum {
    SPANS_MOST = 1024, /* largest number of spans of the spline along a contact */
    DEGREE = GD_GEODESIC_DEGREE
};

/* The largest distance between a loop and a spline along the loop, as a fraction of the domain's
 * width. */
static const double fit = 1e-10;
/* Two paths are the same if their lengths and middles differ by less than this fraction of the
 * length. */
static const double same_path = 1e-7;
/* A taut path is made from a path on the tessellation. The taut path is rejected if the two lengths
 * differ by more than this fraction. */
static const double mesh_error = 0.1;
/* A taut path that is longer than its seed by more than this fraction may pass a loop on another
 * side. */
static const double detour = 0.005;
/* An unproven path may be the shortest one if its length on the mesh exceeds the smallest length by
 * less than this fraction. */
static const double doubt = 0.02;

/* --- contacts as splines ---------------------------------------------------------------------- */

/* Computes place and derivative of the contact at the fraction `part` of its parameter interval. */
static void contact_part(const struct gd_parametric *surface, const struct gd__contact *contact,
                         double part, double at[2], double first[2])
{
    const struct gd__loops *loops = surface->loops;
    double run = contact->end - contact->begin;
    struct gd__span_jet jet;
    gd__span_jet(&loops->spans[loops->loops[contact->loop].first_span + contact->span],
                 contact->begin + part * run, &jet);
    for (int k = 0; k < 2; k++) {
        at[k] = jet.at[k] + contact->shift[k];
        first[k] = jet.first[k] * run;
    }
}

/* Computes the control points of a spline by Hermite interpolation. Each end of a span is a knot of
 * multiplicity two. */
static void fill_spline(const struct gd_parametric *surface, const struct gd__contact *contact,
                        uint32_t spans, struct gd_geodesic_piece *out)
{
    uint32_t knot = 0;
    for (int i = 0; i <= DEGREE; i++) out->knots[knot++] = 0;
    for (uint32_t i = 0; i <= spans; i++) {
        double at[2], first[2], part = (double)i / spans, third = 1.0 / (3 * spans);
        contact_part(surface, contact, part, at, first);
        for (int k = 0; k < 2; k++) {
            if (i > 0) out->points[2 * i][k] = at[k] - third * first[k];
            if (i < spans) out->points[2 * i + 1][k] = at[k] + third * first[k];
            if (i == 0) out->points[0][k] = at[k];
            if (i == spans) out->points[2 * spans + 1][k] = at[k];
        }
        for (int n = 0; n < 2 && i > 0 && i < spans; n++) out->knots[knot++] = part;
    }
    for (int i = 0; i <= DEGREE; i++) out->knots[knot++] = 1;
}

/* Returns the greatest scaled distance between spline and loop in the middles of the spans. */
static double spline_gap(const struct gd_parametric *surface, const struct gd__contact *contact,
                         uint32_t spans)
{
    double most = 0, third = 1.0 / (3 * spans);
    for (uint32_t i = 0; i < spans; i++) {
        double a[2], da[2], b[2], db[2], m[2], dm[2], gap[2];
        contact_part(surface, contact, (double)i / spans, a, da);
        contact_part(surface, contact, (i + 1.0) / spans, b, db);
        contact_part(surface, contact, (i + 0.5) / spans, m, dm);
        for (int k = 0; k < 2; k++)
            gap[k] = ((a[k] + 3 * (a[k] + third * da[k]) + 3 * (b[k] - third * db[k]) + b[k]) / 8 -
                      m[k]) /
                     surface->loops->width[k];
        most = fmax(most, hypot(gap[0], gap[1]));
    }
    return most;
}

static enum gd_status contact_piece(const struct gd_parametric *surface,
                                    const struct gd__contact *contact, struct gd__pace *pace,
                                    struct gd_geodesic_piece *out)
{
    uint32_t spans = 1;
    while (spans < SPANS_MOST && spline_gap(surface, contact, spans) > fit &&
           gd__pace(pace, GD__STEP))
        spans *= 2;
    if (pace->status) return pace->status;
    struct gd_geodesic_piece piece = {.degree = DEGREE, .count = 2 * spans + 2};
    piece.knots = malloc((piece.count + DEGREE + 1) * sizeof *piece.knots);
    piece.points = malloc(piece.count * sizeof *piece.points);
    if (!piece.knots || !piece.points) {
        free(piece.knots);
        free(piece.points);
        return GD_NO_MEMORY;
    }
    fill_spline(surface, contact, spans, &piece);
    *out = piece;
    return GD_OK;
}

/* --- the answer ------------------------------------------------------------------------------- */

static uint32_t count_pieces(const struct gd__taut *taut)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < taut->gap_count; i++)
        if (!taut->gaps[i].is_empty) count += taut->gaps[i].solution.chain->piece_count;
    return count + taut->contacts.count;
}

/* Adds the pieces of a gap to the path, and the values of its solution to those of the path. */
static enum gd_status add_gap(const struct gd__taut *taut, uint32_t i, struct gd_geodesic *out)
{
    struct gd__candidate candidate = {.parts = 1, .part = {taut->gaps[i].solution}};
    struct gd_geodesic part;
    enum gd_status status = gd__answer_make(&candidate, taut->ends, &part);
    if (status) return status;
    memcpy(out->pieces + out->piece_count, part.pieces, part.piece_count * sizeof *part.pieces);
    out->piece_count += part.piece_count;
    free(part.pieces);
    out->curvature += part.curvature;
    out->speed_defect = fmax(out->speed_defect, part.speed_defect);
    out->residual = fmax(out->residual, part.residual);
    out->iterations += part.iterations;
    out->warnings |= part.warnings;
    if (i == 0) out->from_parameter = part.from_parameter, out->from_angle = part.from_angle;
    if (i == taut->contacts.count)
        out->to_parameter = part.to_parameter, out->to_angle = part.to_angle;
    return GD_OK;
}

/* Computes the winding numbers of the path, from its first and last place. */
static void set_turns(const struct gd__taut *taut, struct gd_geodesic *out)
{
    const struct gd_geodesic_piece *first = &out->pieces[0],
                                   *last = &out->pieces[out->piece_count - 1];
    double from[2], to[2];
    gd_domain_curve_at(taut->ends[0], out->from_parameter, from);
    gd_domain_curve_at(taut->ends[1], out->to_parameter, to);
    for (int k = 0; k < 2; k++) {
        double period = gd__axis_period(taut->task->surface->axis[k]);
        double run = last->points[last->count - 1][k] - to[k] - (first->points[0][k] - from[k]);
        out->turns[k] = period > 0 ? (int32_t)lround(run / period) : 0;
    }
}

enum gd_status gd__taut_answer(const struct gd__taut *taut, struct gd_geodesic *out)
{
    struct gd_geodesic answer = {.from_angle = M_PI_2, .to_angle = M_PI_2};
    const struct gd__task *task = taut->task;
    enum gd_status status = GD_OK;
    answer.pieces = calloc(count_pieces(taut) + (size_t)1, sizeof *answer.pieces);
    if (!answer.pieces) return GD_NO_MEMORY;
    for (uint32_t i = 0; i < taut->gap_count && !status; i++) {
        if (!taut->gaps[i].is_empty) status = add_gap(taut, i, &answer);
        if (status || i == taut->contacts.count) continue;
        const struct gd__contact *contact = &taut->contacts.items[i];
        answer.warnings |= GD_GEODESIC_BOUNDARY_CONTACT;
        if (!gd__contact_is_arc(contact)) continue;
        status =
            contact_piece(task->surface, contact, task->pace, &answer.pieces[answer.piece_count]);
        if (!status) answer.piece_count++;
    }
    if (!status && !answer.piece_count) status = GD_INTERNAL;
    if (status) {
        gd__answer_free(&answer);
        return status;
    }
    answer.length = taut->length;
    answer.error = taut->error;
    answer.residual = fmax(answer.residual, taut->residual);
    answer.is_minimum = taut->is_taut;
    set_turns(taut, &answer);
    *out = answer;
    return GD_OK;
}

/* --- all paths -------------------------------------------------------------------------------- */

/* A path with its middle. Duplicates are recognised by the middle. */
struct found {
    struct gd__taut taut;
    struct gd_vec3 middle;
};

/* Computes the point at half of the path's length, which is measured along the path's samples. */
static struct gd_vec3 middle_of(const struct gd__taut *taut)
{
    const struct gd_parametric *surface = taut->task->surface;
    double left = 0.5 * taut->length;
    for (uint32_t i = 0; i < taut->gap_count; i++) {
        const struct gd__uv_polyline *line = &taut->gaps[i].line;
        struct gd__contact_place place;
        double at[2], error = 0;
        if (!taut->gaps[i].is_empty) {
            double length = line->arc[line->count - 1];
            if (left <= length) {
                gd__uv_polyline_at(line, gd__uv_polyline_position(line, left, 0), at);
                return gd__surface_position(surface, at);
            }
            left -= length;
        }
        if (i == taut->contacts.count) break;
        const struct gd__contact *contact = &taut->contacts.items[i];
        double length = gd__contact_length(surface, contact, taut->task->pace, &error);
        if (left <= length && length > 0) {
            gd__contact_at(surface, contact,
                           contact->begin + left / length * (contact->end - contact->begin),
                           &place);
            return place.x;
        }
        left -= length;
    }
    const struct gd__uv_polyline *last = &taut->gaps[taut->gap_count - 1].line;
    return gd__surface_position(surface, last->at[last->count - 1]);
}

static int by_taut_length(const void *x, const void *y)
{
    const struct found *p = x, *q = y;
    return p->taut.length < q->taut.length ? -1 : p->taut.length > q->taut.length;
}

/* Returns true if the taut path is proven and is a result of its seed: it has about the length of
 * the seed. If it is longer, it also passes each hole on the side of the seed. */
static bool is_result(const struct gd__taut *taut, const struct gd__path_seed *seed)
{
    return taut->is_taut && fabs(taut->length - seed->length) <= mesh_error * seed->length &&
           (taut->length <= seed->length || gd__passing_agrees(taut));
}

/* Computes the taut path of one seed (a path on the tessellation). *out must be zeroed. Sets
 * *is_kept if *out is a result. Contacts that the path does not need may lead it to another side of
 * a loop. So if the first path is no result, or longer than the seed by more than `detour`, solves
 * again without contacts, and keeps the shorter result. */
static enum gd_status solve_seed(const struct gd__task *task,
                                 const struct gd_domain_curve *const ends[2],
                                 const struct gd__path_seed *seed, struct gd__taut *out,
                                 bool *is_kept)
{
    *is_kept = false;
    for (int i = 0; i < 2; i++) {
        struct gd__taut taut;
        enum gd_status status = gd__taut_solve(task, ends, seed, i == 1, &taut);
        if (status == GD_INTERNAL) continue;
        if (status) {
            gd__taut_free(out);
            return status;
        }
        bool is_better = is_result(&taut, seed) && (!*is_kept || taut.length < out->length);
        gd__taut_free(is_better ? out : &taut);
        if (is_better) *out = taut;
        *is_kept = *is_kept || is_better;
        if (*is_kept && out->length <= (1 + detour) * seed->length) break;
    }
    return GD_OK;
}

/* Adds the path of one seed, if it is a result and new. If the seed has no result, lowers *doubtful
 * to the length of the seed. */
static enum gd_status find_path(const struct gd__task *task,
                                const struct gd_domain_curve *const ends[2],
                                const struct gd__path_seed *seed, struct found *found,
                                uint32_t *count, double *doubtful)
{
    struct found *path = &found[*count];
    bool is_kept;
    enum gd_status status = solve_seed(task, ends, seed, &path->taut, &is_kept);
    if (status) return status;
    if (!is_kept) *doubtful = fmin(*doubtful, seed->length);
    if (is_kept) path->middle = middle_of(&path->taut);
    for (uint32_t i = 0; i < *count && is_kept; i++)
        is_kept =
            fabs(found[i].taut.length - path->taut.length) > same_path * path->taut.length ||
            gd_vec3_distance(found[i].middle, path->middle) > sqrt(same_path) * path->taut.length;
    if (is_kept)
        (*count)++;
    else
        gd__taut_free(&path->taut);
    return task->pace->status;
}

static enum gd_status answer_paths(const struct found *found, uint32_t count, bool all,
                                   struct gd_geodesics *out)
{
    struct gd_geodesics answer = {.items = calloc(count, sizeof *answer.items)};
    enum gd_status status = answer.items ? GD_OK : GD_NO_MEMORY;
    for (uint32_t i = 0; i < (all ? count : 1) && !status; i++) {
        status = gd__taut_answer(&found[i].taut, &answer.items[i]);
        if (!status) answer.count++;
    }
    if (status)
        gd_geodesics_free(&answer);
    else
        *out = answer;
    return status;
}

enum gd_status gd__taut_paths(const struct gd__task *task,
                              const struct gd_domain_curve *const ends[2],
                              const struct gd__path_seeds *seeds, bool all,
                              struct gd_geodesics *out)
{
    struct found *found = calloc(seeds->count + (size_t)1, sizeof *found);
    enum gd_status status = found ? GD_OK : GD_NO_MEMORY;
    double doubtful = INFINITY;
    uint32_t count = 0;
    for (uint32_t i = 0; i < seeds->count && !status; i++) {
        task->pace->fraction = (double)i / seeds->count;
        status = find_path(task, ends, &seeds->seed[i], found, &count, &doubtful);
    }
    if (!status && count) qsort(found, count, sizeof *found, by_taut_length);
    /* an unproven path may be shorter than all proven paths */
    if (!status && (!count || doubtful < (1 + doubt) * found[0].taut.length)) status = GD_INTERNAL;
    if (!status) status = answer_paths(found, count, all, out);
    for (uint32_t i = 0; i < count; i++) gd__taut_free(&found[i].taut);
    free(found);
    return status;
}
