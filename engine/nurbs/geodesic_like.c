/* The recipe: do the curves meet? ways on the mesh, each brought to a coarse curve, the promising
 * ones to fine ones, the shortest minimum answered. */
#include "gd/geodesic_like.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/tolerance.h"
#include "nurbs/answer.h"
#include "nurbs/meet.h"
#include "nurbs/seeds.h"
#include "nurbs/tessellation.h"
#include "nurbs/way.h"

static const double hopeless =
    1.01; /* a coarse curve longer than the shortest coarse one by more is not the shortest */
/* ... where some pass close by a pole: coarse curves there are too long */
static const double hopeless_by_pole = 1.08;
/* two answers whose lengths agree to this and whose middles to its root are one */
static const double twins = 1e-7;

static const double beside =
    1e-2; /* a way is beside one through a pole if length and middle agree to this and its root */

static const double COARSE_SHARE = 0.25; /* of the time that is told, for all coarse curves */

struct candidates {
    uint32_t count, capacity;
    struct gd__way *way;
};

/* The same way found twice: ways through a pole differ from those beside it. */
static bool is_twin(const struct gd__way *a, const struct gd__way *b)
{
    return a->parts == b->parts && a->tip == b->tip &&
           fabs(a->coarse - b->coarse) <= twins * a->coarse &&
           gd_vec3_distance(a->middle, b->middle) <= sqrt(twins) * a->coarse;
}

static void candidates_free(struct candidates *candidates)
{
    for (uint32_t i = 0; i < candidates->count; i++) gd__way_free(&candidates->way[i]);
    free(candidates->way);
}

static enum gd_status add_candidates(const struct gd__task *task,
                                     const struct gd_domain_curve *const ends[2],
                                     const struct gd__seed *seed, struct candidates *candidates)
{
    struct gd__way found[GD__WAYS_MOST];
    uint32_t count = 0;
    enum gd_status status = gd__ways_of_seed(task, ends, seed, found, &count);
    if (status) return status;
    struct gd__way *grown = realloc(candidates->way, (candidates->count + count) * sizeof *grown);
    if (!grown) {
        for (uint32_t i = 0; i < count; i++) gd__way_free(&found[i]);
        return GD_NO_MEMORY;
    }
    candidates->way = grown;
    for (uint32_t i = 0; i < count; i++) {
        struct gd__way *way = &found[i];
        way->coarse = gd__way_length(way);
        way->middle = gd__way_middle(task->surface, way);
        status = task->watch->status;
        bool known = status;
        for (uint32_t k = 0; k < candidates->count && !known; k++)
            known = is_twin(&candidates->way[k], way);
        if (known)
            gd__way_free(way);
        else
            candidates->way[candidates->count++] = *way;
    }
    return GD_OK;
}

static enum gd_status make_candidates(const struct gd__task *task,
                                      const struct gd_domain_curve *const ends[2],
                                      const struct gd__seeds *seeds, struct candidates *candidates)
{
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < seeds->count && !status; i++) {
        task->watch->fraction = COARSE_SHARE * i / seeds->count;
        status = add_candidates(task, ends, &seeds->seed[i], candidates);
    }
    return status;
}

/* From then on the way is told apart by its final length and middle. */
static enum gd_status finish_way(const struct gd__task *task, struct gd__way *way)
{
    enum gd_status status = gd__way_finish(task, way);
    way->coarse = gd__way_length(way);
    way->middle = gd__way_middle(task->surface, way);
    return task->watch->status ? task->watch->status : status;
}

/* Where a geodesic goes straight through a pole, curves beside the pole only creep towards it. */
static bool is_covered(const struct gd__way *through, const struct gd__way *way)
{
    return through->parts > 1 && fabs(through->coarse - way->coarse) <= beside * through->coarse &&
           gd_vec3_distance(through->middle, way->middle) <= sqrt(beside) * through->coarse;
}

static int through_first(const void *x, const void *y)
{
    const struct gd__way *p = x, *q = y;
    if (p->parts != q->parts) return p->parts > q->parts ? -1 : 1;
    return p->coarse < q->coarse ? -1 : p->coarse > q->coarse;
}

/* Keeps the shorter of two ways that would not become geodesics: better than nothing if nothing
 * else is found, and said to be so. */
static void spare_way(struct gd__way *way, struct gd__way *spare)
{
    for (uint32_t i = 0; i < way->parts; i++)
        way->part[i].converged = way->part[i].report.converged = false;
    bool better = !spare->parts || way->coarse < spare->coarse;
    gd__way_free(better ? spare : way);
    if (better) *spare = *way;
}

/* Finishes the candidates that may be wanted, the others are dropped. */
static enum gd_status finish(const struct gd__task *task, bool all, struct candidates *candidates)
{
    double least = INFINITY;
    for (uint32_t i = 0; i < candidates->count; i++) least = fmin(least, candidates->way[i].coarse);
    bool by_pole = false;
    for (uint32_t i = 0; i < candidates->count; i++)
        by_pole = by_pole || candidates->way[i].by_pole;
    qsort(candidates->way, candidates->count, sizeof *candidates->way, through_first);
    uint32_t kept = 0;
    struct gd__way spare = {0};
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < candidates->count; i++) {
        struct gd__way way = candidates->way[i];
        task->watch->fraction = COARSE_SHARE + (1 - COARSE_SHARE) * i / candidates->count;
        bool wanted =
            !status && (all || way.coarse <= (by_pole ? hopeless_by_pole : hopeless) * least);
        for (uint32_t k = 0; k < kept && wanted; k++)
            wanted = !is_covered(&candidates->way[k], &way);
        if (wanted && !task->control_points) status = finish_way(task, &way);
        if (wanted && !status && gd__way_is_geodesic(task, &way))
            candidates->way[kept++] = way;
        else if (wanted && !status)
            spare_way(&way, &spare);
        else
            gd__way_free(&way);
    }
    if (kept)
        gd__way_free(&spare);
    else if (spare.parts)
        candidates->way[kept++] = spare;
    candidates->count = kept;
    return status ? status : task->watch->status;
}

static int by_worth(const void *x, const void *y)
{
    const struct gd__way *p = x, *q = y;
    bool good_p = gd__way_is_minimum(p), good_q = gd__way_is_minimum(q);
    if (good_p != good_q) return good_p ? -1 : 1;
    double a = gd__way_length(p), b = gd__way_length(q);
    return a < b ? -1 : a > b;
}

/* Sorted: minima first, by length; of twins the first. Without a minimum one of the others. */
static void choose(bool all, struct candidates *candidates)
{
    qsort(candidates->way, candidates->count, sizeof *candidates->way, by_worth);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < candidates->count; i++) {
        struct gd__way way = candidates->way[i];
        bool wanted = i == 0 || (all && gd__way_is_minimum(&way));
        for (uint32_t k = 0; k < kept && wanted; k++) wanted = !is_twin(&candidates->way[k], &way);
        if (wanted)
            candidates->way[kept++] = way;
        else
            gd__way_free(&way);
    }
    candidates->count = kept;
}

static enum gd_status answer(const struct candidates *candidates, struct gd_geodesics *out)
{
    struct gd_geodesics found = {.items = calloc(candidates->count, sizeof *found.items)};
    enum gd_status status = found.items ? GD_OK : GD_NO_MEMORY;
    for (uint32_t i = 0; i < candidates->count && !status; i++) {
        status = gd__answer_make(&candidates->way[i], &found.items[i]);
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

static enum gd_status check(const struct gd_tessellation *tessellation,
                            const struct gd_domain_curve *from, const struct gd_domain_curve *to,
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

static enum gd_status solve(const struct gd__task *task,
                            const struct gd_domain_curve *const ends[2], bool all,
                            const struct gd__seeds *seeds, struct gd_geodesics *out,
                            struct gd_detail *detail)
{
    struct candidates candidates = {0};
    enum gd_status status = make_candidates(task, ends, seeds, &candidates);
    if (!status) status = finish(task, all, &candidates);
    if (!status && !candidates.count) status = GD_INTERNAL;
    if (!status) choose(all, &candidates);
    if (!status) status = answer(&candidates, out);
    candidates_free(&candidates);
    return status ? gd_fail(detail, status, "%s", gd_status_sentence(status)) : GD_OK;
}

enum gd_status gd_geodesic_solve(const struct gd_tessellation *tessellation,
                                 const struct gd_geodesic_request *request,
                                 const struct gd_control *control, struct gd_geodesics *out,
                                 struct gd_detail *detail)
{
    const struct gd_domain_curve *from = request->from, *to = request->to;
    struct gd_geodesic_options o =
        request->options ? *request->options : (struct gd_geodesic_options){0};
    enum gd_status status = check(tessellation, from, to, &o, detail);
    if (status) return status;
    bool meet;
    double s[2];
    status = gd__curves_meet(from, to, control, &meet, s);
    if (!status && meet) status = answer_meeting(from, to, s, out);
    if (status) return gd_fail(detail, status, "%s", gd_status_sentence(status));
    if (meet) return GD_OK;
    struct gd__share share = {.control = control, .total = GD__SEEDS_PARTS + 1};
    const struct gd_control own = gd__share_control(&share, 0);
    struct gd__watch watch = {.control = &own};
    struct gd__task task = {.surface = tessellation->surface,
                            .degree = o.degree ? o.degree : GD_GEODESIC_DEGREE,
                            .control_points = o.control_points,
                            .tolerance = o.tolerance > 0 ? o.tolerance : GD_GEODESIC_TOLERANCE,
                            .watch = &watch};
    struct gd__seeds seeds;
    status = gd__seeds_find(tessellation, from, to, o.all_minima, &share, &seeds, detail);
    if (status) return status;
    status = solve(&task, (const struct gd_domain_curve *const[2]){from, to}, o.all_minima, &seeds,
                   out, detail);
    gd__seeds_free(&seeds);
    return status;
}
