/* Steps of a solution: test whether the curves meet; find seeds on the mesh; compute coarse
 * candidates from each seed; refine candidates that may be shortest; return the shortest
 * minimum. */
#include "gd/geodesic_like.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/tolerance.h"
#include "nurbs/answer.h"
#include "nurbs/meet.h"
#include "nurbs/seeds.h"
#include "nurbs/tessellation.h"
#include "nurbs/candidate.h"

/* a coarse curve that is longer than the shortest one by this factor is dropped */
static const double hopeless = 1.01;
/* as `hopeless`, if a candidate passes near a pole, where coarse curves are too long */
static const double hopeless_by_pole = 1.08;
/* candidates are the same path if the relative difference of their lengths is below `twins`, and
 * that of their middles below its square root */
static const double twins = 1e-7;
/* as `twins`, for a candidate that converges towards a path through a pole */
static const double beside = 1e-2;
/* the coarse curves' fraction of the progress */
static const double COARSE_SHARE = 0.25;

struct candidates {
    uint32_t count, capacity;
    struct gd__candidate *items;
};

/* Returns true if two candidates are the same path. A path through a pole is never the same as a
 * path beside the pole. */
static bool is_twin(const struct gd__candidate *a, const struct gd__candidate *b)
{
    return a->parts == b->parts && a->tip == b->tip &&
           fabs(a->coarse - b->coarse) <= twins * a->coarse &&
           gd_vec3_distance(a->middle, b->middle) <= sqrt(twins) * a->coarse;
}

static void candidates_free(struct candidates *candidates)
{
    for (uint32_t i = 0; i < candidates->count; i++) gd__candidate_free(&candidates->items[i]);
    free(candidates->items);
}

static enum gd_status add_candidates(const struct gd__task *task,
                                     const struct gd_domain_curve *const ends[2],
                                     const struct gd__path_seed *seed,
                                     struct candidates *candidates)
{
    struct gd__candidate found[GD__CANDIDATES_MOST];
    uint32_t count = 0;
    enum gd_status status = gd__candidates_of_seed(task, ends, seed, found, &count);
    if (status) return status;
    struct gd__candidate *grown =
        realloc(candidates->items, (candidates->count + count) * sizeof *grown);
    if (!grown) {
        for (uint32_t i = 0; i < count; i++) gd__candidate_free(&found[i]);
        return GD_NO_MEMORY;
    }
    candidates->items = grown;
    for (uint32_t i = 0; i < count; i++) {
        struct gd__candidate *candidate = &found[i];
        candidate->coarse = gd__candidate_length(candidate);
        candidate->middle = gd__candidate_middle(task->surface, candidate);
        status = task->pace->status;
        bool known = status;
        for (uint32_t k = 0; k < candidates->count && !known; k++)
            known = is_twin(&candidates->items[k], candidate);
        if (known)
            gd__candidate_free(candidate);
        else
            candidates->items[candidates->count++] = *candidate;
    }
    return GD_OK;
}

static enum gd_status make_candidates(const struct gd__task *task,
                                      const struct gd_domain_curve *const ends[2],
                                      const struct gd__path_seeds *seeds,
                                      struct candidates *candidates)
{
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < seeds->count && !status; i++) {
        task->pace->fraction = COARSE_SHARE * i / seeds->count;
        status = add_candidates(task, ends, &seeds->seed[i], candidates);
    }
    return status;
}

/* Refines a candidate, and updates the length and middle by which it is compared. */
static enum gd_status finish_candidate(const struct gd__task *task, struct gd__candidate *candidate)
{
    enum gd_status status = gd__candidate_finish(task, candidate);
    candidate->coarse = gd__candidate_length(candidate);
    candidate->middle = gd__candidate_middle(task->surface, candidate);
    return task->pace->status ? task->pace->status : status;
}

/* Returns true if a candidate beside a pole is superfluous, because the geodesic `through` passes
 * straight through the pole. */
static bool is_covered(const struct gd__candidate *through, const struct gd__candidate *candidate)
{
    return through->parts > 1 &&
           fabs(through->coarse - candidate->coarse) <= beside * through->coarse &&
           gd_vec3_distance(through->middle, candidate->middle) <= sqrt(beside) * through->coarse;
}

static int through_first(const void *x, const void *y)
{
    const struct gd__candidate *p = x, *q = y;
    if (p->parts != q->parts) return p->parts > q->parts ? -1 : 1;
    return p->coarse < q->coarse ? -1 : p->coarse > q->coarse;
}

/* Keeps the shorter of two candidates that did not become geodesics. If no geodesic is found, it
 * becomes the result, marked as not converged. */
static void spare_candidate(struct gd__candidate *candidate, struct gd__candidate *spare)
{
    for (uint32_t i = 0; i < candidate->parts; i++)
        candidate->part[i].converged = candidate->part[i].report.converged = false;
    bool better = !spare->parts || candidate->coarse < spare->coarse;
    gd__candidate_free(better ? spare : candidate);
    if (better) *spare = *candidate;
}

/* Refines the candidates that may be results, and drops the others. */
static enum gd_status geodesic_finish(const struct gd__task *task, bool all,
                                      struct candidates *candidates)
{
    double least = INFINITY;
    for (uint32_t i = 0; i < candidates->count; i++)
        least = fmin(least, candidates->items[i].coarse);
    bool by_pole = false;
    for (uint32_t i = 0; i < candidates->count; i++)
        by_pole = by_pole || candidates->items[i].by_pole;
    qsort(candidates->items, candidates->count, sizeof *candidates->items, through_first);
    uint32_t kept = 0;
    struct gd__candidate spare = {0};
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < candidates->count; i++) {
        struct gd__candidate candidate = candidates->items[i];
        task->pace->fraction = COARSE_SHARE + (1 - COARSE_SHARE) * i / candidates->count;
        bool wanted =
            !status && (all || candidate.coarse <= (by_pole ? hopeless_by_pole : hopeless) * least);
        for (uint32_t k = 0; k < kept && wanted; k++)
            wanted = !is_covered(&candidates->items[k], &candidate);
        if (wanted && !task->control_points) status = finish_candidate(task, &candidate);
        if (wanted && !status && gd__candidate_is_geodesic(task, &candidate))
            candidates->items[kept++] = candidate;
        else if (wanted && !status)
            spare_candidate(&candidate, &spare);
        else
            gd__candidate_free(&candidate);
    }
    if (kept)
        gd__candidate_free(&spare);
    else if (spare.parts)
        candidates->items[kept++] = spare;
    candidates->count = kept;
    return status ? status : task->pace->status;
}

static int by_worth(const void *x, const void *y)
{
    const struct gd__candidate *p = x, *q = y;
    bool good_p = gd__candidate_is_minimum(p), good_q = gd__candidate_is_minimum(q);
    if (good_p != good_q) return good_p ? -1 : 1;
    double a = gd__candidate_length(p), b = gd__candidate_length(q);
    return a < b ? -1 : a > b;
}

/* Sorts candidates, minima first, then by length, and drops duplicates. If no candidate is a
 * minimum, keeps one. */
static void geodesic_choose(bool all, struct candidates *candidates)
{
    qsort(candidates->items, candidates->count, sizeof *candidates->items, by_worth);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < candidates->count; i++) {
        struct gd__candidate candidate = candidates->items[i];
        bool wanted = i == 0 || (all && gd__candidate_is_minimum(&candidate));
        for (uint32_t k = 0; k < kept && wanted; k++)
            wanted = !is_twin(&candidates->items[k], &candidate);
        if (wanted)
            candidates->items[kept++] = candidate;
        else
            gd__candidate_free(&candidate);
    }
    candidates->count = kept;
}

static enum gd_status geodesic_answer(const struct candidates *candidates, struct gd_geodesics *out)
{
    struct gd_geodesics found = {.items = calloc(candidates->count, sizeof *found.items)};
    enum gd_status status = found.items ? GD_OK : GD_NO_MEMORY;
    for (uint32_t i = 0; i < candidates->count && !status; i++) {
        status = gd__answer_make(&candidates->items[i], &found.items[i]);
        if (!status) found.count++;
    }
    if (status)
        gd_geodesics_free(&found);
    else
        *out = found;
    return status;
}

static enum gd_status answer_meeting(const struct gd_domain_curve *from,
                                     const struct gd_domain_curve *to, const double s[2],
                                     struct gd_geodesics *out)
{
    struct gd_geodesic *item = calloc(1, sizeof *item);
    if (!item) return GD_NO_MEMORY;
    double turns;
    item->from_parameter = from->is_point ? 0 : gd__curve_reduce(from, s[0], &turns);
    item->to_parameter = to->is_point ? 0 : gd__curve_reduce(to, s[1], &turns);
    item->from_angle = item->to_angle = M_PI_2;
    item->is_minimum = true;
    gd_domain_curve_at(from, s[0], item->meeting);
    *out = (struct gd_geodesics){1, item};
    return GD_OK;
}

static enum gd_status geodesic_check(const struct gd_tessellation *tessellation,
                                     const struct gd_domain_curve *from,
                                     const struct gd_domain_curve *to,
                                     const struct gd_geodesic_options *o, struct gd_detail *detail)
{
    if (from->surface != tessellation->surface || to->surface != tessellation->surface)
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "both curves must lie on the tessellation's surface");
    if (o->degree && (o->degree < GD_GEODESIC_DEGREE_LEAST || o->degree > GD_GEODESIC_DEGREE_MOST))
        return gd_fail(detail, GD_INVALID_ARGUMENT, "the degree is between %d and %d",
                       GD_GEODESIC_DEGREE_LEAST, GD_GEODESIC_DEGREE_MOST);
    uint32_t degree = o->degree ? o->degree : GD_GEODESIC_DEGREE;
    if (o->control_points &&
        (o->control_points <= degree || o->control_points > GD_GEODESIC_CONTROL_POINTS_MOST))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "degree %u needs between %u and %d control points", degree, degree + 1,
                       GD_GEODESIC_CONTROL_POINTS_MOST);
    if (o->tolerance != 0 && !(o->tolerance >= GD_GEODESIC_TOLERANCE_LEAST && o->tolerance <= 1))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the tolerance is a part of the length between %g and 1",
                       GD_GEODESIC_TOLERANCE_LEAST);
    return GD_OK;
}

static enum gd_status geodesic_solve(const struct gd__task *task,
                                     const struct gd_domain_curve *const ends[2], bool all,
                                     const struct gd__path_seeds *seeds, struct gd_geodesics *out,
                                     struct gd_detail *detail)
{
    struct candidates candidates = {0};
    enum gd_status status = make_candidates(task, ends, seeds, &candidates);
    if (!status) status = geodesic_finish(task, all, &candidates);
    if (!status && !candidates.count) status = GD_INTERNAL;
    if (!status) geodesic_choose(all, &candidates);
    if (!status) status = geodesic_answer(&candidates, out);
    candidates_free(&candidates);
    return status ? gd_fail_status(detail, status) : GD_OK;
}

enum gd_status gd_geodesic_solve(const struct gd_tessellation *tessellation,
                                 const struct gd_geodesic_request *request,
                                 const struct gd_control *control, struct gd_geodesics *out,
                                 struct gd_detail *detail)
{
    const struct gd_domain_curve *from = request->from, *to = request->to;
    struct gd_geodesic_options o =
        request->options ? *request->options : (struct gd_geodesic_options){0};
    enum gd_status status = geodesic_check(tessellation, from, to, &o, detail);
    if (status) return status;
    bool meet;
    double s[2];
    status = gd__curves_meet(from, to, control, &meet, s);
    if (!status && meet) status = answer_meeting(from, to, s, out);
    if (status) return gd_fail_status(detail, status);
    if (meet) return GD_OK;
    struct gd__share share = {.control = control, .total = GD__SEEDS_PARTS + 1};
    const struct gd_control own = gd__share_control(&share, 0);
    struct gd__pace pace = {.control = &own};
    struct gd__task task = {.surface = tessellation->surface,
                            .degree = o.degree ? o.degree : GD_GEODESIC_DEGREE,
                            .control_points = o.control_points,
                            .tolerance = o.tolerance > 0 ? o.tolerance : GD_GEODESIC_TOLERANCE,
                            .pace = &pace};
    struct gd__path_seeds seeds;
    status = gd__path_seeds_find(tessellation, from, to, o.all_minima, &share, &seeds, detail);
    if (status) return status;
    status = geodesic_solve(&task, (const struct gd_domain_curve *const[2]){from, to}, o.all_minima,
                            &seeds, out, detail);
    gd__path_seeds_free(&seeds);
    return status;
}
