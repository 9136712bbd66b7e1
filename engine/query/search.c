#include <stdlib.h>

#include "base/share.h"
#include "field/arrivals.h"
#include "gd/query.h"
#include "line/route.h"
#include "query/landmarks.h"
#include "query/taut_path.h"
#include "wavefront/wavefront.h"

/* The search first finds a path in a graph and straightens it. The result is the shortest path on
 * the surface, or slightly longer. Its length is an upper bound of the distance (guide/guide.h,
 * query/taut_path.h). Then the search propagates windows. A window is propagated only if a path
 * through it to the target can be within this bound. This is tested with lower bounds at the ends
 * of the window's edge. Therefore few windows are propagated (Xin and Wang 2009; Qin et al. 2016
 * prune fields, not pairs). */

struct search {
    const struct gd_mesh *mesh;
    struct gd__seed seed;
    struct gd_point target;
    /* true if the seed is the pair's second point; the path is then traced back to this point */
    bool is_turned;
    enum gd_pair_output output;
    struct gd_pair_answer *out;
    double bound;    /* upper bound of the distance in the current run */
    double distance; /* distance found, in the normalised unit */
};

static bool is_found(const struct search *search)
{
    return search->distance <= search->bound * (1 + GD_TOL_CHECK);
}

/* Reads the distance and the path. This sink does not take any of the arrays. */
static enum gd_status search_answer(void *user, struct gd__wavefront *front)
{
    struct search *search = user;
    struct gd_field field = {.seeds = &search->seed, .seed_count = 1};
    gd__field_view(front, GD__FAR, &field);
    enum gd_status status = gd__field_index_seeds(&field);
    if (status) return status;
    search->distance = gd__field_leg(&field, &search->target).distance;
    if (search->output && is_found(search))
        status = gd_field_path(&field, &search->target, &search->out->path);
    if (search->output == GD_PAIR_PATH_AND_CUT && is_found(search) && !status)
        status = gd__field_path_is_cut(&field, &search->out->path, &search->out->is_cut);
    free(field.face_seeds);
    return status;
}

static enum gd_status search_run(struct search *search, struct gd__guide *guide, double bound,
                                 const struct gd_control *control)
{
    double rounding =
        guide->margin + GD_TOL_PLACE * (search->mesh->summary.edge_length.max / search->mesh->unit);
    /* The absolute rounding error is added because, for points that are close together, it can be
     * larger than any fixed part of their distance. */
    search->bound = bound + rounding;
    enum gd_status status = gd__rings_draw(guide, &search->seed.point, search->bound);
    if (status) return status;
    struct gd__propagation propagation = {.seeds = &search->seed,
                                          .seed_count = 1,
                                          .radius = search->bound,
                                          .guide = guide,
                                          .target = &search->target,
                                          .points = search->output ? NULL : &search->target,
                                          .point_count = search->output ? 0 : 1};
    struct gd__sink sink = {.take = search_answer, .user = search};
    return gd__wavefront_run(search->mesh, &propagation, &sink, control);
}

/* Exchanges seed and target, so that the search starts from the other end of the pair. */
static enum gd_status search_turn(struct search *search, struct gd__guide *guide)
{
    enum gd_status status = gd__guide_turn(guide, &search->seed.point);
    struct gd_point seed = search->seed.point;
    search->seed.point = search->target;
    search->target = seed;
    search->is_turned = true;
    return status;
}

/* Also searches from the other end, and keeps the shorter path. On a graded mesh
 * (gd__mesh_is_graded) the search from one end may miss a path due to the rounding of windows.
 * Either result is an existing path. */
static enum gd_status run_turned(struct search *search, struct gd__guide *guide,
                                 const struct gd_control *control)
{
    struct gd_pair_answer first = *search->out;
    double distance = search->distance;
    bool was_turned = search->is_turned;
    enum gd_status status = search_turn(search, guide);
    search->is_turned = !was_turned;
    *search->out = (struct gd_pair_answer){0};
    if (!status) status = search_run(search, guide, distance * (1 + GD_TOL_BOUND), control);
    if (!status && is_found(search) && search->distance < distance) {
        gd_path_free(&first.path);
        return GD_OK;
    }
    gd_path_free(&search->out->path);
    *search->out = first;
    search->distance = distance;
    search->is_turned = was_turned;
    return status == GD_INTERNAL ? GD_OK : status;
}

/* Searches within the length of the taut path. This length is smaller than the safe bound `upper`,
 * but has the rounding errors of many unfolded faces. If no path is found because of them, the
 * search is repeated with `upper`. */
static enum gd_status run_bounded(struct search *search, struct gd__guide *guide, double upper,
                                  const struct gd_control *control)
{
    struct gd__share share = {/* the guide was half of the progress; each run is a quarter */
                              .control = control,
                              .done = 2,
                              .total = 4};
    struct gd_control own = gd__share_control(&share, gd__guide_held(guide));
    double tight = upper;
    enum gd_status status =
        gd__taut_path_length(guide, &search->seed.point, &search->target, &own, &tight);
    if (status && status != GD_INTERNAL) return status;
    status =
        gd__guide_prefers_turn(guide, &search->seed.point) ? search_turn(search, guide) : GD_OK;
    if (!status) status = search_run(search, guide, fmin(upper, tight * (1 + GD_TOL_BOUND)), &own);
    if (!status && !is_found(search)) {
        share.done = 3;
        status = search_run(search, guide, upper, &own);
    }
    /* no path was found, although one exists */
    if (!status && !is_found(search)) status = GD_INTERNAL;
    return !status && gd__mesh_is_graded(search->mesh) ? run_turned(search, guide, &own) : status;
}

static enum gd_status search_in(struct gd_workspace *work, struct search *search,
                                const struct gd_landmarks *landmarks,
                                const struct gd_control *control)
{
    struct gd__guide *guide = &work->guide;
    double upper;
    gd__landmarks_offer(landmarks, search->mesh, guide);
    enum gd_status status =
        gd__guide_aim(guide, search->mesh, &search->seed.point, &search->target, control, &upper);
    if (!status) status = run_bounded(search, guide, upper, control);
    if (!status) search->out->distance = search->distance * search->mesh->unit;
    if (!status && !search->is_turned)
        gd__points_reverse(search->out->path.points, search->out->path.count);
    gd__guide_clean(guide);
    return status;
}

static enum gd_status search_pair(const struct gd_mesh *mesh, const struct gd_pair_request *request,
                                  const struct gd_control *control, struct gd_pair_answer *out)
{
    const struct gd_point *from = request->from, *to = request->to;
    if (gd_point_component(mesh, from) != gd_point_component(mesh, to)) {
        out->distance = INFINITY;
        return GD_OK;
    }
    struct search search = {.mesh = mesh,
                            .seed = {.point = *from},
                            .target = *to,
                            .output = request->output,
                            .out = out};
    struct gd_control own = control ? *control : (struct gd_control){0};
    if (!own.workspace) own.workspace = gd_workspace_create();
    if (!own.workspace) return GD_NO_MEMORY;
    enum gd_status status = search_in(own.workspace, &search, request->landmarks, &own);
    if (!control || !control->workspace) gd_workspace_destroy(own.workspace);
    return status;
}

/* --- one pair --------------------------------------------------------------------------------- */

/* The distance is symmetric, so a field of either end gives the answer; a path that is traced from
 * `to` is reversed. */

void gd_pair_answer_free(struct gd_pair_answer *answer)
{
    if (answer) gd_path_free(&answer->path);
}

/* Computes the answer from a field, traced from the point `end`. If `end_is_from`, the traced path
 * already begins at `from`. */
static enum gd_status pair_from_field(const struct gd_field *field, const struct gd_point *end,
                                      bool end_is_from, enum gd_pair_output output,
                                      struct gd_pair_answer *out)
{
    struct gd_pair_answer answer = {0};
    enum gd_status status =
        output ? gd__field_distance_and_path(field, end, &answer.distance, &answer.path)
               : gd_field_distance(field, end, &answer.distance);
    if (!status && answer.path.count && output == GD_PAIR_PATH_AND_CUT)
        status = gd__field_path_is_cut(field, &answer.path, &answer.is_cut);
    if (status) {
        gd_pair_answer_free(&answer);
        return status;
    }
    if (!end_is_from) gd__points_reverse(answer.path.points, answer.path.count);
    *out = answer;
    return GD_OK;
}

enum gd_status gd_pair_from_field(const struct gd_field *field, const struct gd_point *from,
                                  const struct gd_point *to, enum gd_pair_output output,
                                  struct gd_pair_answer *out)
{
    struct gd_point seed;
    if (!gd_field_single_seed(field, &seed)) return GD_INVALID_ARGUMENT;
    if (gd_point_equal(&seed, from)) return pair_from_field(field, to, false, output, out);
    if (gd_point_equal(&seed, to)) return pair_from_field(field, from, true, output, out);
    return GD_INVALID_ARGUMENT;
}

/* Builds the fields of both ends, one after the other, for a pair whose search failed its check. */
static enum gd_status solve_by_fields(const struct gd_mesh *mesh,
                                      const struct gd_pair_request *request,
                                      const struct gd_control *control, struct gd_pair_answer *out)
{
    const struct gd_point *from = request->from, *to = request->to;
    enum gd_status status = GD_INTERNAL;
    for (int end = 0; end < 2 && status == GD_INTERNAL; end++) {
        struct gd_seed seed = {.point = end ? *to : *from};
        struct gd_field *field = NULL;
        status = gd_field_build(mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1},
                                control, &field, NULL);
        if (!status) status = pair_from_field(field, end ? from : to, end, request->output, out);
        gd_field_release(field);
    }
    return status;
}

enum gd_status gd_pair_solve(const struct gd_mesh *mesh, const struct gd_pair_request *request,
                             const struct gd_control *control, struct gd_pair_answer *out,
                             struct gd_detail *detail)
{
    struct gd_pair_answer answer = {0};
    enum gd_status status = search_pair(mesh, request, control, &answer);
    if (status == GD_INTERNAL) {
        gd_pair_answer_free(&answer);
        answer = (struct gd_pair_answer){0};
        status = solve_by_fields(mesh, request, control, &answer);
    }
    if (status) {
        gd_pair_answer_free(&answer);
        return gd_fail_status(detail, status);
    }
    *out = answer;
    return GD_OK;
}
