#include "field/arrivals.h"
#include "line/route.h"
#include "query/search.h"

/* Point to point. The metric is symmetric, so a field of either end answers; a path is reversed
 * when it was traced from `to`. */

void gd_pair_answer_free(struct gd_pair_answer *answer)
{
    if (answer) gd_path_free(&answer->path);
}

/* `end` is the point that the field is asked at; `reversed`: it is where the answer's path begins
 * already. */
static enum gd_status ask(const struct gd_field *field, const struct gd_point *end,
                          bool end_is_from, enum gd_pair_wish wish, struct gd_pair_answer *out)
{
    struct gd_pair_answer answer = {0};
    enum gd_status status =
        wish ? gd__field_distance_and_path(field, end, &answer.distance, &answer.path)
             : gd_field_distance(field, end, &answer.distance);
    if (!status && answer.path.count && wish == GD_PAIR_PATH_AND_CUT)
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
                                  const struct gd_point *to, enum gd_pair_wish wish,
                                  struct gd_pair_answer *out)
{
    struct gd_point seed;
    if (!gd_field_single_seed(field, &seed)) return GD_INVALID_ARGUMENT;
    if (gd_point_equal(&seed, from)) return ask(field, to, false, wish, out);
    if (gd_point_equal(&seed, to)) return ask(field, from, true, wish, out);
    return GD_INVALID_ARGUMENT;
}

/* Both ends' whole fields, one after the other: for a pair whose search has failed its own
 * check. */
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
        if (!status) status = ask(field, end ? from : to, end, request->wish, out);
        gd_field_release(field);
    }
    return status;
}

enum gd_status gd_pair_solve(const struct gd_mesh *mesh, const struct gd_pair_request *request,
                             const struct gd_control *control, struct gd_pair_answer *out,
                             struct gd_detail *detail)
{
    struct gd_pair_answer answer = {0};
    enum gd_status status = gd__search(mesh, request, control, &answer);
    if (status == GD_INTERNAL) {
        gd_pair_answer_free(&answer);
        answer = (struct gd_pair_answer){0};
        status = solve_by_fields(mesh, request, control, &answer);
    }
    if (status) {
        gd_pair_answer_free(&answer);
        return gd_fail(detail, status, "%s", gd_status_sentence(status));
    }
    *out = answer;
    return GD_OK;
}
