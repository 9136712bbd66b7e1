#include "field/arrivals.h"
#include "line/route.h"
#include "query/search.h"

/* Answers one pair of points. The distance is symmetric, so a field of either end gives the answer;
 * a path that is traced from `to` is reversed. */

void gd_pair_answer_free(struct gd_pair_answer *answer)
{
    if (answer) gd_path_free(&answer->path);
}

/* Answers from a field at the point `end`. If `end_is_from`, the traced path already begins at
 * `from`. */
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
    enum gd_status status = gd__search(mesh, request, control, &answer);
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
