/* A request is solved in these steps. Test whether the curves meet. Find seeds on the mesh, or make
 * the seeds of a class of paths. Compute coarse candidates from each seed. Refine the candidates
 * that may be shortest. Trim candidates that cross the curves. Return the shortest minimum. */
#include "gd/geodesic_like.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "nurbs/answer.h"
#include "nurbs/classes.h"
#include "nurbs/family.h"
#include "nurbs/meet.h"
#include "nurbs/taut.h"
#include "nurbs/tessellation.h"
#include "nurbs/trim.h"

enum {
    /* number of pairs of places (one place on each curve) that the initial paths of a class join */
    CLASS_PLACES = 2,
    TRIMS_MOST = 8 /* largest number of times that a path is trimmed */
};

/* coarse curves that are longer than this factor times the shortest one are dropped */
static const double hopeless = 1.01;
/* replaces `hopeless` if a candidate passes near a pole, where coarse curves are too long */
static const double hopeless_by_pole = 1.08;
/* Two candidates are the same path if their lengths differ by less than this fraction of the
 * length, and if the distances between their points at a quarter and at the middle are below the
 * square root of this fraction, times the length. */
static const double twins = 1e-7;
/* replaces `twins` for a candidate that converges to a path through a pole */
static const double beside = 1e-2;
/* fraction of the progress when all coarse curves are computed */
static const double COARSE_SHARE = 0.25;

struct candidates {
    uint32_t count, capacity;
    struct gd__candidate *items;
};

struct solving {
    const struct gd__task *task;
    const struct gd_domain_curve *ends[2];
    const struct gd_geodesic_request *request;
    struct gd_geodesic_options options;
    struct candidates candidates;
};

/* Returns true if the request selects a class of paths by a curve or by winding numbers. */
static bool is_chosen(const struct gd_geodesic_request *request)
{
    return request->initial || request->turns;
}

/* Returns true if two candidates are the same path. A path through a pole is never the same as a
 * path beside the pole. */
static bool is_twin(const struct gd__candidate *a, const struct gd__candidate *b)
{
    return a->parts == b->parts && a->tip == b->tip &&
           fabs(a->coarse - b->coarse) <= twins * a->coarse &&
           gd_vec3_distance(a->quarter, b->quarter) <= sqrt(twins) * a->coarse &&
           gd_vec3_distance(a->middle, b->middle) <= sqrt(twins) * a->coarse;
}

static void candidates_free(struct candidates *candidates)
{
    for (uint32_t i = 0; i < candidates->count; i++) gd__candidate_free(&candidates->items[i]);
    free(candidates->items);
}

/* Adds the candidates of a seed, except those that are already in the list. */
static enum gd_status add_candidates(struct solving *solving, const struct gd__path_seed *seed,
                                     uint32_t trims)
{
    const struct gd__task *task = solving->task;
    struct candidates *candidates = &solving->candidates;
    struct gd__candidate found[GD__CANDIDATES_MOST];
    uint32_t count = 0;
    enum gd_status status = gd__candidates_of_seed(task, solving->ends, seed, found, &count);
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
        candidate->trims = trims;
        gd__candidate_identify(task->surface, candidate);
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

/* Adds the candidates of the initial paths of a class. */
static enum gd_status add_class(struct solving *solving, const struct gd__class *in)
{
    enum gd_status status = GD_OK;
    for (uint32_t shape = 0; shape < GD__CLASS_SHAPES && !status; shape++) {
        struct gd__path_seed seed;
        status = gd__class_seed(solving->ends, in, shape, &seed);
        if (status) break;
        status = add_candidates(solving, &seed, 0);
        gd__uv_polyline_free(&seed.polyline);
    }
    return status;
}

/* Adds the candidates of all classes up to the limit on winding numbers. */
static enum gd_status add_classes(struct solving *solving, const struct gd__path_seeds *seeds)
{
    const struct gd_parametric *surface = solving->task->surface;
    int32_t most[2];
    for (int k = 0; k < 2; k++) {
        /* if a path's end moves once around a closed curve, the path belongs to the next class */
        bool slides = solving->ends[0]->winding[k] != 0 || solving->ends[1]->winding[k] != 0;
        most[k] = surface->axis[k]->closed && !slides ? (int32_t)solving->options.turn_limit : 0;
    }
    if (!most[0] && !most[1]) return GD_OK;
    uint32_t places = solving->ends[0]->is_point && solving->ends[1]->is_point ? 1 : CLASS_PLACES;
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < places && i < seeds->count; i++)
        for (int32_t m = -most[0]; m <= most[0]; m++)
            for (int32_t n = -most[1]; n <= most[1] && !status; n++)
                status = add_class(
                    solving,
                    &(struct gd__class){{m, n}, {seeds->seed[i].s[0], seeds->seed[i].s[1]}});
    return status;
}

static enum gd_status make_candidates(struct solving *solving, const struct gd__path_seeds *seeds)
{
    const struct gd_geodesic_request *request = solving->request;
    if (request->turns)
        return add_class(solving, &(struct gd__class){{request->turns[0], request->turns[1]},
                                                      {seeds->seed[0].s[0], seeds->seed[0].s[1]}});
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < seeds->count && !status; i++) {
        solving->task->pace->fraction = COARSE_SHARE * i / seeds->count;
        status = add_candidates(solving, &seeds->seed[i], 0);
    }
    if (!status && solving->options.all_minima) status = add_classes(solving, seeds);
    return status;
}

/* Refines a candidate, and updates its length and its middle, which comparisons use. */
static enum gd_status finish_candidate(const struct gd__task *task, struct gd__candidate *candidate)
{
    enum gd_status status = gd__candidate_finish(task, candidate);
    gd__candidate_identify(task->surface, candidate);
    return task->pace->status ? task->pace->status : status;
}

/* `through` may be a geodesic that passes through a pole. Returns true if a candidate that passes
 * near the pole is almost equal to `through`, and thus is not needed. */
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

/* Keeps the shorter one of two candidates that did not become geodesics. If no geodesic is found,
 * the kept candidate is the result, and is marked as not converged. A path that bends at a pole is
 * too long by at most twice the length of its shorter part, by the triangle inequality. */
static void spare_candidate(struct gd__candidate *candidate, struct gd__candidate *spare)
{
    struct gd__solution *part = candidate->part;
    for (uint32_t i = 0; i < candidate->parts; i++)
        part[i].converged = part[i].report.converged = false;
    if (candidate->parts == 2)
        part[0].error += 2 * fmin(part[0].report.length, part[1].report.length);
    bool better = !spare->parts || candidate->coarse < spare->coarse;
    gd__candidate_free(better ? spare : candidate);
    if (better) *spare = *candidate;
}

/* Returns true if a refined candidate may be a result, that is, if it is a geodesic of the
 * requested class. A candidate on the other side of a pole has other winding numbers. */
static bool is_result(const struct solving *solving, const struct gd__candidate *candidate)
{
    const int32_t *wanted = solving->request->turns;
    if (!gd__candidate_is_geodesic(solving->task, candidate)) return false;
    if (!wanted || candidate->parts > 1 || !solving->ends[0]->is_point ||
        !solving->ends[1]->is_point)
        return true;
    int32_t turns[2];
    gd__candidate_turns(candidate, solving->ends, turns);
    return turns[0] == wanted[0] && turns[1] == wanted[1];
}

/* Replaces a path that crosses one of the curves by the candidates of its trimmed part. If the
 * request has winding numbers, nothing is trimmed: a trimmed path is in another class. */
static enum gd_status trim_candidate(struct solving *solving, struct gd__candidate *candidate,
                                     bool *trimmed)
{
    struct gd__path_seed seed;
    *trimmed = false;
    if (!solving->options.all_minima && !solving->request->initial) return GD_OK;
    if (candidate->trims == TRIMS_MOST) return GD_OK;
    enum gd_status status = gd__trim(solving->task, solving->ends, candidate, trimmed, &seed);
    if (status || !*trimmed) return status;
    status = add_candidates(solving, &seed, candidate->trims + 1);
    gd__uv_polyline_free(&seed.polyline);
    gd__candidate_free(candidate);
    return status;
}

/* Returns the greatest length of coarse curves that are refined. */
static double longest_worth(const struct solving *solving)
{
    const struct candidates *candidates = &solving->candidates;
    if (solving->options.all_minima || is_chosen(solving->request)) return INFINITY;
    double least = INFINITY, factor = hopeless;
    for (uint32_t i = 0; i < candidates->count; i++) {
        least = fmin(least, candidates->items[i].coarse);
        if (candidates->items[i].by_pole) factor = hopeless_by_pole;
    }
    return factor * least;
}

/* Refines a candidate and stores it. A result is added to the *kept results at the beginning of the
 * list. A result that crosses a curve is replaced by trimmed candidates at the end of the list. A
 * candidate that is not a result goes to `spare`. */
static enum gd_status finish_one(struct solving *solving, struct gd__candidate *candidate,
                                 uint32_t *kept, struct gd__candidate *spare)
{
    const struct gd__task *task = solving->task;
    enum gd_status status = task->control_points ? GD_OK : finish_candidate(task, candidate);
    bool trimmed = false, good = !status && is_result(solving, candidate);
    if (good) status = trim_candidate(solving, candidate, &trimmed);
    if (trimmed) return status;
    if (status)
        gd__candidate_free(candidate);
    else if (good)
        solving->candidates.items[(*kept)++] = *candidate;
    else
        spare_candidate(candidate, spare);
    return status;
}

/* Refines the candidates that may be results, and drops the others. While this runs, results are
 * stored at the beginning of the list, and trimmed candidates are appended to its end. */
static enum gd_status geodesic_finish(struct solving *solving)
{
    struct candidates *candidates = &solving->candidates;
    double most = longest_worth(solving);
    if (candidates->count)
        qsort(candidates->items, candidates->count, sizeof *candidates->items, through_first);
    uint32_t kept = 0;
    struct gd__candidate spare = {0};
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < candidates->count; i++) {
        struct gd__candidate candidate = candidates->items[i];
        solving->task->pace->fraction = COARSE_SHARE + (1 - COARSE_SHARE) * i / candidates->count;
        bool wanted = !status && candidate.coarse <= most;
        for (uint32_t k = 0; k < kept && wanted; k++)
            wanted = !is_covered(&candidates->items[k], &candidate);
        if (wanted)
            status = finish_one(solving, &candidate, &kept, &spare);
        else
            gd__candidate_free(&candidate);
    }
    if (kept)
        gd__candidate_free(&spare);
    else if (spare.parts)
        candidates->items[kept++] = spare;
    candidates->count = kept;
    return status ? status : solving->task->pace->status;
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

/* --- families --------------------------------------------------------------------------------- */

/* Returns the distance between the ends of two candidates, as a fraction of the curves' parameter
 * ranges. */
static double ends_apart(const struct solving *solving, const struct gd__candidate *a,
                         const struct gd__candidate *b)
{
    double sum = 0;
    for (int side = 0; side < 2; side++) {
        const struct gd_domain_curve *end = solving->ends[side];
        double apart = gd__candidate_parameter(a, side) - gd__candidate_parameter(b, side),
               range = end->high - end->low;
        if (end->is_point) continue;
        sum += fabs(end->closed ? apart / range - round(apart / range) : apart / range);
    }
    return sum;
}

/* Joins the family of a candidate with the families of earlier candidates. Of each family,
 * only the member whose ends are nearest to the candidate's ends is compared, because a path
 * between two members is easy to find if they are close. */
static enum gd_status join_families(const struct solving *solving, uint32_t candidate)
{
    struct gd__candidate *items = solving->candidates.items;
    enum gd_status status = GD_OK;
    items[candidate].family = candidate;
    for (uint32_t first = 0; first < candidate && !status; first++) {
        uint32_t nearest = first;
        bool is_one;
        if (items[first].family != first) continue;
        for (uint32_t k = first; k < candidate; k++)
            if (items[k].family == first &&
                ends_apart(solving, &items[k], &items[candidate]) <
                    ends_apart(solving, &items[nearest], &items[candidate]))
                nearest = k;
        const struct gd__candidate *const pair[2] = {&items[nearest], &items[candidate]};
        status = gd__is_one_family(solving->task, solving->ends, pair, &is_one);
        if (status || !is_one) continue;
        uint32_t joined = items[candidate].family, lowest = joined < first ? joined : first;
        for (uint32_t k = 0; k <= candidate; k++)
            if (items[k].family == first || items[k].family == joined) items[k].family = lowest;
    }
    return status;
}

/* Keeps only one candidate of each family. */
static enum gd_status keep_families(const struct solving *solving, struct candidates *candidates)
{
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < candidates->count && !status; i++) status = join_families(solving, i);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < candidates->count && !status; i++) {
        struct gd__candidate *first = &candidates->items[candidates->items[i].family];
        if (candidates->items[i].family != i) first->is_family = true;
    }
    for (uint32_t i = 0; i < candidates->count && !status; i++) {
        struct gd__candidate candidate = candidates->items[i];
        if (candidate.family == i)
            candidates->items[kept++] = candidate;
        else
            gd__candidate_free(&candidate);
    }
    if (!status) candidates->count = kept;
    return status;
}

static enum gd_status geodesic_answer(const struct solving *solving, struct gd_geodesics *out)
{
    const struct candidates *candidates = &solving->candidates;
    struct gd_geodesics found = {.items = calloc(candidates->count, sizeof *found.items)};
    enum gd_status status = found.items ? GD_OK : GD_NO_MEMORY;
    for (uint32_t i = 0; i < candidates->count && !status; i++) {
        status = gd__answer_make(&candidates->items[i], solving->ends, &found.items[i]);
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

static enum gd_status check_options(const struct gd_geodesic_options *o, struct gd_detail *detail)
{
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
    if (o->turn_limit > GD_GEODESIC_TURN_LIMIT_MOST)
        return gd_fail(detail, GD_INVALID_ARGUMENT, "the limit on turns is at most %d",
                       GD_GEODESIC_TURN_LIMIT_MOST);
    return GD_OK;
}

static enum gd_status check_turns(const struct gd_parametric *surface, const int32_t *turns,
                                  struct gd_detail *detail)
{
    for (int k = 0; k < 2; k++) {
        if (turns[k] < -GD_GEODESIC_TURNS_MOST || turns[k] > GD_GEODESIC_TURNS_MOST)
            return gd_fail(detail, GD_INVALID_ARGUMENT, "a path turns at most %d times",
                           GD_GEODESIC_TURNS_MOST);
        if (turns[k] && !surface->axis[k]->closed)
            return gd_fail(detail, GD_INVALID_ARGUMENT,
                           "the surface is not closed in the direction of %c, so no path turns "
                           "there",
                           "uv"[k]);
    }
    return GD_OK;
}

/* On trimmed surfaces, parts of loops become cubic pieces, and the classes of the paths are those
 * of the shortest paths on the tessellation. */
const char *gd_geodesic_untrimmed_only(const struct gd_geodesic_options *options,
                                       const struct gd_geodesic_members *members,
                                       const char **reason)
{
    const char *classes = "a trimmed surface takes no initial curve and no turns; list all minima "
                          "instead";
    const struct {
        bool is_there;
        const char *name, *reason;
    } all[] = {
        {members->initial, "initial", classes},
        {members->turns, "turns", classes},
        {options->degree && options->degree != GD_GEODESIC_DEGREE, "degree",
         "paths on a trimmed surface are cubic; leave the degree out"},
        {options->control_points, "control_points",
         "paths on a trimmed surface have as many control points as the tolerance needs; leave it "
         "out"},
        {options->all_minima && members->curve, "all_minima",
         "on a trimmed surface all minima are listed between points only"}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        if (!all[i].is_there) continue;
        *reason = all[i].reason;
        return all[i].name;
    }
    return NULL;
}

static enum gd_status check_trimmed(const struct gd_geodesic_request *request,
                                    const struct gd_geodesic_options *o, struct gd_detail *detail)
{
    const char *reason;
    const struct gd_geodesic_members members = {.initial = request->initial != NULL,
                                                .turns = request->turns != NULL,
                                                .curve = !request->from->is_point ||
                                                         !request->to->is_point};
    if (!gd_geodesic_untrimmed_only(o, &members, &reason)) return GD_OK;
    return gd_fail(detail, GD_INVALID_ARGUMENT, "%s", reason);
}

static enum gd_status geodesic_check(const struct gd_tessellation *tessellation,
                                     const struct gd_geodesic_request *request,
                                     const struct gd_geodesic_options *o, struct gd_detail *detail)
{
    const struct gd_parametric *surface = tessellation->surface;
    if (request->from->surface != surface || request->to->surface != surface ||
        (request->initial && request->initial->surface != surface))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "all curves must lie on the tessellation's surface");
    if ((request->initial != NULL) + (request->turns != NULL) + o->all_minima > 1)
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "an initial curve, turns and all minima exclude each other");
    enum gd_status status = check_options(o, detail);
    if (!status && surface->loops) status = check_trimmed(request, o, detail);
    return status || !request->turns ? status : check_turns(surface, request->turns, detail);
}

static enum gd_status geodesic_solve(struct solving *solving, const struct gd__path_seeds *seeds,
                                     struct gd_geodesics *out, struct gd_detail *detail)
{
    enum gd_status status = make_candidates(solving, seeds);
    if (!status) status = geodesic_finish(solving);
    if (!status && !solving->candidates.count) status = GD_INTERNAL;
    if (!status) geodesic_choose(solving->options.all_minima, &solving->candidates);
    if (!status) status = keep_families(solving, &solving->candidates);
    if (!status) status = geodesic_answer(solving, out);
    candidates_free(&solving->candidates);
    return status ? gd_fail_status(detail, status) : GD_OK;
}

/* Checks that a curve of the request stays in the trimmed domain. */
static enum gd_status check_inside(const struct gd_domain_curve *curve,
                                   const struct gd_control *control, struct gd_detail *detail)
{
    double uv[2];
    bool inside;
    enum gd_status status = gd_domain_curve_inside(curve, control, &inside, uv);
    if (status) return gd_fail_status(detail, status);
    return inside ? GD_OK
                  : gd_fail(detail, GD_INVALID_ARGUMENT,
                            "a curve leaves the trimmed domain at (%.6g, %.6g)", uv[0], uv[1]);
}

/* Computes the shortest path in a trimmed domain. */
static enum gd_status solve_taut(struct solving *solving, const struct gd__path_seeds *seeds,
                                 struct gd_geodesics *out, struct gd_detail *detail)
{
    enum gd_status status =
        gd__taut_paths(solving->task, solving->ends, seeds, solving->options.all_minima, out);
    if (status == GD_INTERNAL)
        return gd_fail(
            detail, status,
            "no path in the trimmed domain passed its checks: it is not proven shortest");
    return status ? gd_fail_status(detail, status) : GD_OK;
}

/* Finds the seeds of a request. If the request gives winding numbers of a path between two points,
 * no search is needed, because the ends are the points. */
static enum gd_status find_seeds(const struct solving *solving,
                                 const struct gd_tessellation *tessellation,
                                 struct gd__share *share, struct gd__path_seeds *out,
                                 struct gd_detail *detail)
{
    const struct gd_geodesic_request *request = solving->request;
    bool are_points = request->from->is_point && request->to->is_point;
    if (!request->initial && !(request->turns && are_points))
        return gd__path_seeds_find(tessellation, request->from, request->to,
                                   solving->options.all_minima, share, out, detail);
    *out = (struct gd__path_seeds){.count = 1, .seed = calloc(1, sizeof *out->seed)};
    share->done += GD__SEEDS_PARTS;
    if (!out->seed) return gd_fail_status(detail, GD_NO_MEMORY);
    if (!request->initial) return GD_OK;
    enum gd_status status = gd__initial_seed(solving->ends, request->initial, solving->task->pace,
                                             &out->seed[0], detail);
    if (status) gd__path_seeds_free(out);
    return status;
}

/* If the curves of the request meet, sets *meet to true and computes the result. Does nothing if
 * the request selects a class of paths, because a path of that class may have a length above 0 even
 * from a point to itself. */
static enum gd_status solve_meeting(const struct gd_geodesic_request *request,
                                    const struct gd_control *control, bool *meet,
                                    struct gd_geodesics *out)
{
    struct gd__meeting meeting;
    uint32_t count = 0;
    *meet = false;
    if (request->initial || (request->turns && (request->turns[0] || request->turns[1])))
        return GD_OK;
    enum gd_status status =
        gd__curves_meetings(request->from, request->to, control, &meeting, 1, &count);
    if (status || !count) return status;
    *meet = true;
    return answer_meeting(request->from, request->to, meeting.s, out);
}

enum gd_status gd_geodesic_solve(const struct gd_tessellation *tessellation,
                                 const struct gd_geodesic_request *request,
                                 const struct gd_control *control, struct gd_geodesics *out,
                                 struct gd_detail *detail)
{
    struct gd_geodesic_options o =
        request->options ? *request->options : (struct gd_geodesic_options){0};
    enum gd_status status = geodesic_check(tessellation, request, &o, detail);
    if (status) return status;
    bool meet;
    status = check_inside(request->from, control, detail);
    if (!status) status = check_inside(request->to, control, detail);
    if (status) return status;
    status = solve_meeting(request, control, &meet, out);
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
    struct solving solving = {
        .task = &task, .ends = {request->from, request->to}, .request = request, .options = o};
    struct gd__path_seeds seeds;
    status = find_seeds(&solving, tessellation, &share, &seeds, detail);
    if (status) return status;
    status = tessellation->surface->loops ? solve_taut(&solving, &seeds, out, detail)
                                          : geodesic_solve(&solving, &seeds, out, detail);
    gd__path_seeds_free(&seeds);
    return status;
}
