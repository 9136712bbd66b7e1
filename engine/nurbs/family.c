#include "nurbs/family.h"

#include <math.h>

#include "base/tolerance.h"

enum { STEPS = 64, PARTS = 8 };

/* If the middles of a path and of a member of a family are nearer to each other than this fraction
 * of the path's length, the path is this member itself. Such a path does not prove that there are
 * paths between the members. */
static const double apart = 1e-4;
/* A path between two paths may end this far from the point midway between their ends, as a fraction
 * of the distance between these ends. */
static const double still = 0.1;
/* Polylines between members of a family are longer than the members by less than this fraction. */
static const double bulge = 0.02;

static bool is_as_long(const struct gd__task *task, double a, double b)
{
    return fabs(a - b) <= fmax(GD_TOL_FAMILY, 2 * task->tolerance) * a;
}

static void place_after(const struct gd__uv_polyline *polyline, double part, double at[2])
{
    double run = part * polyline->arc[polyline->count - 1];
    gd__uv_polyline_at(polyline, gd__uv_polyline_position(polyline, run, 0), at);
}

/* Sets the parameters of the seed's ends by interpolation between those of the two paths, at the
 * fraction `part`. */
static void put_ends_between(const struct gd_domain_curve *const ends[2],
                             const struct gd__candidate *const pair[2], double part,
                             struct gd__path_seed *seed)
{
    for (int side = 0; side < 2; side++) {
        double a = gd__candidate_parameter(pair[0], side),
               b = gd__candidate_parameter(pair[1], side),
               period = ends[side]->high - ends[side]->low;
        if (ends[side]->closed) b -= round((b - a) / period) * period;
        seed->s[side] = a + part * (b - a);
    }
}

/* Computes the polyline between two paths at the fraction `part`. */
static enum gd_status seed_between(const struct gd_domain_curve *const ends[2],
                                   const struct gd__candidate *const pair[2], double part,
                                   struct gd__path_seed *seed)
{
    struct gd__uv_polyline line[2] = {{0}};
    double shift[2];
    enum gd_status status = GD_OK;
    for (int i = 0; i < 2 && !status; i++)
        status = gd__uv_polyline_of_chain(pair[i]->part[0].chain, &line[i]);
    for (int k = 0; k < 2 && !status; k++) {
        double period = gd__axis_period(ends[0]->surface->axis[k]);
        shift[k] = period > 0 ? round((line[0].at[0][k] - line[1].at[0][k]) / period) * period : 0;
    }
    for (int i = 0; i <= STEPS && !status; i++) {
        double a[2], b[2], at[2];
        place_after(&line[0], (double)i / STEPS, a);
        place_after(&line[1], (double)i / STEPS, b);
        for (int k = 0; k < 2; k++) at[k] = a[k] + part * (b[k] + shift[k] - a[k]);
        status = gd__uv_polyline_add(&seed->polyline, at);
    }
    gd__uv_polyline_free(&line[0]);
    gd__uv_polyline_free(&line[1]);
    if (status) return status;
    put_ends_between(ends, pair, part, seed);
    status = gd__path_seed_attach(ends, seed);
    if (!status) seed->length = seed->polyline.arc[seed->polyline.count - 1];
    return status;
}

/* Returns true if Newton's method hardly moved the ends of a path along their curves. The ends move
 * far if the two paths belong to different families and no equally long paths lie between the two.
 * An example is a family on each side of a corner. */
static bool has_stayed(const struct gd_domain_curve *const ends[2],
                       const struct gd__candidate *const pair[2], const struct gd__path_seed *seed,
                       const struct gd__candidate *candidate)
{
    for (int side = 0; side < 2; side++) {
        if (ends[side]->is_point) continue;
        double period = ends[side]->high - ends[side]->low,
               moved = gd__candidate_parameter(candidate, side) - seed->s[side],
               width = 2 * fabs(seed->s[side] - gd__candidate_parameter(pair[0], side));
        if (ends[side]->closed) moved -= round(moved / period) * period;
        if (fabs(moved) > still * width + GD_TOL_ONE_PLACE * period) return false;
    }
    return true;
}

static bool is_between(const struct gd__task *task, const struct gd__candidate *const pair[2],
                       const struct gd__candidate *candidate)
{
    double far = apart * candidate->coarse;
    return gd__candidate_is_minimum(candidate) &&
           is_as_long(task, pair[0]->coarse, candidate->coarse) &&
           gd_vec3_distance(candidate->middle, pair[0]->middle) > far &&
           gd_vec3_distance(candidate->middle, pair[1]->middle) > far;
}

/* Computes polylines between the two paths. Sets *is_level to true if none of them is much longer
 * than the paths. A polyline is much longer, for example, at a corner between two families. */
static enum gd_status find_level(const struct gd_domain_curve *const ends[2],
                                 const struct gd__candidate *const pair[2], bool *is_level)
{
    enum gd_status status = GD_OK;
    *is_level = true;
    for (int i = 1; i < PARTS && *is_level && !status; i++) {
        struct gd__path_seed seed = {0};
        status = seed_between(ends, pair, (double)i / PARTS, &seed);
        *is_level = seed.length <= (1 + bulge) * pair[0]->coarse;
        gd__uv_polyline_free(&seed.polyline);
    }
    return status;
}

/* Computes the path halfway between two paths. Sets *is_one if it belongs to their family. */
static enum gd_status solve_between(const struct gd__task *task,
                                    const struct gd_domain_curve *const ends[2],
                                    const struct gd__candidate *const pair[2], bool *is_one)
{
    struct gd__path_seed seed = {0};
    struct gd__candidate found[GD__CANDIDATES_MOST];
    uint32_t count = 0;
    enum gd_status status = seed_between(ends, pair, 0.5, &seed);
    if (!status) status = gd__candidates_of_seed(task, ends, &seed, found, &count);
    for (uint32_t i = 0; i < count; i++) {
        if (!status && !*is_one && !task->control_points)
            status = gd__candidate_finish(task, &found[i]);
        if (!status) gd__candidate_identify(task->surface, &found[i]);
        *is_one = *is_one || (!status && is_between(task, pair, &found[i]) &&
                              has_stayed(ends, pair, &seed, &found[i]));
        gd__candidate_free(&found[i]);
    }
    gd__uv_polyline_free(&seed.polyline);
    return status ? status : task->pace->status;
}

enum gd_status gd__is_one_family(const struct gd__task *task,
                                 const struct gd_domain_curve *const ends[2],
                                 const struct gd__candidate *const pair[2], bool *is_one)
{
    bool is_level;
    *is_one = false;
    if (pair[0]->parts != 1 || pair[1]->parts != 1 ||
        !is_as_long(task, pair[0]->coarse, pair[1]->coarse))
        return GD_OK;
    enum gd_status status = find_level(ends, pair, &is_level);
    return status || !is_level ? status : solve_between(task, ends, pair, is_one);
}
