#include "nurbs/trim.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "nurbs/meet.h"

enum { MEETINGS_MOST = 256 };

/* The part of the path that is kept: positions on its polyline, and parameters on the curves. */
struct cut {
    double position[2], s[2];
};

static enum gd_status add_part(const struct gd__chain *chain, struct gd__uv_polyline *out)
{
    struct gd__uv_polyline part;
    enum gd_status status = gd__uv_polyline_of_chain(chain, &part);
    if (status) return status;
    for (uint32_t i = 0; i < part.count && !status; i++) {
        const double *last = out->count ? out->at[out->count - 1] : NULL;
        if (!last || last[0] != part.at[i][0] || last[1] != part.at[i][1])
            status = gd__uv_polyline_add(out, part.at[i]);
    }
    gd__uv_polyline_free(&part);
    return status;
}

/* Finds the place where the path, as a polyline, meets a curve, and stores it in `cut` for the
 * given side. For side 0 it is the last place on the first curve, for side 1 the first later place
 * on the second curve. The path's own end on the curve does not count. */
static enum gd_status find_meeting(const struct gd_domain_curve *path,
                                   const struct gd_domain_curve *curve,
                                   const struct gd_control *control, int side, struct cut *cut)
{
    struct gd__meeting *found = malloc(MEETINGS_MOST * sizeof *found);
    uint32_t count = 0;
    enum gd_status status =
        found ? gd__curves_meetings(path, curve, control, found, MEETINGS_MOST, &count)
              : GD_NO_MEMORY;
    double end = path->count - 1;
    for (uint32_t i = 0; i < count && !status; i++) {
        double at = found[i].s[0], turns;
        bool is_own = side ? at > end - 0.5 : at < 0.5;
        bool better = side ? at > cut->position[0] && at < cut->position[1] : at > cut->position[0];
        if (is_own || !better) continue;
        cut->position[side] = at;
        cut->s[side] = gd__curve_reduce(curve, found[i].s[1], &turns);
    }
    free(found);
    return status;
}

static enum gd_status keep_between(const struct gd__uv_polyline *polyline, const struct cut *cut,
                                   struct gd__uv_polyline *out)
{
    enum gd_status status = GD_OK;
    for (int side = 0; side < 2 && !status; side++) {
        double at[2];
        uint32_t first = (uint32_t)floor(cut->position[0]) + 1,
                 last = (uint32_t)ceil(cut->position[1]);
        gd__uv_polyline_at(polyline, cut->position[side], at);
        status = gd__uv_polyline_add(out, at);
        for (uint32_t i = first; i < last && !side && !status; i++)
            status = gd__uv_polyline_add(out, polyline->at[i]);
    }
    return status;
}

static enum gd_status trim_between(const struct gd_domain_curve *const ends[2],
                                   const struct gd__uv_polyline *polyline,
                                   const struct gd_control *control, bool *crosses,
                                   struct gd__path_seed *seed)
{
    struct gd_domain_curve *path;
    struct cut cut = {.position = {0, polyline->count - 1}, .s = {seed->s[0], seed->s[1]}};
    enum gd_status status = gd_domain_curve_polyline(
        ends[0]->surface,
        &(struct gd_domain_polyline){(const double(*)[2])polyline->at, polyline->count}, control,
        &path, NULL);
    if (status) return status;
    for (int side = 0; side < 2 && !status; side++)
        if (!ends[side]->is_point) status = find_meeting(path, ends[side], control, side, &cut);
    *crosses = cut.position[0] > 0 || cut.position[1] < polyline->count - 1;
    gd_domain_curve_release(path);
    if (status || !*crosses) return status;
    memcpy(seed->s, cut.s, sizeof cut.s);
    status = keep_between(polyline, &cut, &seed->polyline);
    if (!status) status = gd__path_seed_attach(ends, seed);
    if (!status) seed->length = seed->polyline.arc[seed->polyline.count - 1];
    return status;
}

enum gd_status gd__trim(const struct gd__task *task, const struct gd_domain_curve *const ends[2],
                        const struct gd__candidate *candidate, bool *crosses,
                        struct gd__path_seed *out)
{
    struct gd__uv_polyline polyline = {0};
    struct gd__path_seed seed = {0};
    enum gd_status status = GD_OK;
    *crosses = false;
    if (ends[0]->is_point && ends[1]->is_point) return GD_OK;
    for (int side = 0; side < 2; side++) seed.s[side] = gd__candidate_parameter(candidate, side);
    for (uint32_t i = 0; i < candidate->parts && !status; i++)
        status = add_part(candidate->part[i].chain, &polyline);
    if (!status && polyline.count > 1)
        status = trim_between(ends, &polyline, task->pace->control, crosses, &seed);
    gd__uv_polyline_free(&polyline);
    if (!status && *crosses)
        *out = seed;
    else
        gd__uv_polyline_free(&seed.polyline);
    return status;
}
